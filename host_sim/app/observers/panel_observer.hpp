// What the core made of the panel, with what was true then.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "firmware/mission/mission.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/observers/run_files.hpp"

namespace lf::app {

// At the core's first look that succeeded.
struct Located {
  PanelResult panel;
  Pose base_from_panel = Pose::Identity();  // as found
  struct Handle {
    std::size_t valve = 0;
    double found_rad = 0, true_rad = 0;
  };
  std::vector<Handle> handles;  // those that it looked for
  scene::BodyPoses poses;       // while it looked
  std::vector<CloudPoint> cloud;
};

// Keeps cloud.pcd, too: the newest cloud until the panel was found.
class PanelObserver : public hal::SimObserver {
 public:
  explicit PanelObserver(RunFiles& files) : files_(files) {}

  void on_step(Time, const world::World& world) override { world_ = &world; }
  void on_telemetry(const Telemetry& telemetry) override;
  void on_panel_request(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) override;
  void on_panel_result(const PanelResult& result) override { answered_ = result; }
  // After each turn of the control thread: where the panel was found.
  void after_control(const mission::Mission& mission);

  const std::optional<Located>& located() const { return located_; }
  // Of all looks the worst: how far off the panel is, over what the core keeps clear for it. Not a number where there was none.
  double worst_over_doubt() const { return worst_over_doubt_; }

 private:
  void judge_doubt(const mission::PanelMap& map);

  RunFiles& files_;
  const world::World* world_ = nullptr;
  std::vector<CloudPoint> asked_cloud_;
  scene::BodyPoses asked_poses_;
  std::vector<double> asked_valves_rad_;
  PanelResult answered_;
  std::optional<Located> located_;
  bool map_taken_ = false;
  Pose newest_map_ = Pose::Identity();
  double worst_over_doubt_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace lf::app
