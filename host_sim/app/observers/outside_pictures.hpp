// The robot at work seen from outside, for people: poses are kept while the mission runs and drawn when it is over, so a run's speed is its own.
#pragma once

#include <string>
#include <vector>

#include "firmware/telemetry.hpp"
#include "host_sim/optics/optics.hpp"
#include "host_sim/record/png.hpp"
#include "host_sim/world/world.hpp"

namespace lf::app {

class OutsidePictures {
 public:
  struct Picture {
    std::string name;  // of the file, without folder
    std::string title;
    record::RgbImage image;
  };

  void on_event(const Event& event);
  void on_step(Time now, const world::World& world);

  // One picture each of the scan, the turn and the first press, as far as the mission came.
  std::vector<Picture> draw(const optics::OpticsConfig& mission, int threads) const;

 private:
  struct Moment {
    mission::Step step;
    Duration after;  // the step's begin
    bool laser;
    const char* name;
    const char* title;
  };
  struct Kept {
    const Moment* moment = nullptr;
    scene::BodyPoses poses;
  };
  static const std::vector<Moment>& moments();

  mission::Step step_ = mission::Step::idle;
  Time step_since_;
  std::vector<Kept> kept_;
};

}  // namespace lf::app
