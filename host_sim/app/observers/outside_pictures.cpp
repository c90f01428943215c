#include "host_sim/app/observers/outside_pictures.hpp"

#include <algorithm>
#include <utility>

#include "host_sim/optics/outside_view.hpp"

namespace lf::app {

// When each step shows best: the stripe halfway down the panel, the bar halfway round, the finger on the button.
const std::vector<OutsidePictures::Moment>& OutsidePictures::moments() {
  static const std::vector<Moment> all{
      {mission::Step::scan, Duration::from_ms(6000), true, "outside_scan", "The scan, seen from outside"},
      {mission::Step::turn, Duration::from_ms(2000), false, "outside_turn", "Turning the valve, seen from outside"},
      {mission::Step::press, Duration::from_ms(3500), false, "outside_press", "Pressing a button, seen from outside"},
  };
  return all;
}

void OutsidePictures::on_event(const Event& event) {
  if (event.kind != Event::Kind::step) return;
  step_ = event.step;
  step_since_ = event.t;
}

void OutsidePictures::on_step(Time now, const world::World& world) {
  for (const Moment& moment : moments()) {
    if (moment.step != step_ || now - step_since_ < moment.after) continue;
    const bool known = std::any_of(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.moment == &moment; });
    if (!known) kept_.push_back({&moment, world.base_from_body()});
  }
}

std::vector<OutsidePictures::Picture> OutsidePictures::draw(const optics::OpticsConfig& mission, int threads) const {
  std::vector<Picture> pictures;
  if (kept_.empty()) return pictures;
  const Vec3 panel_m = kept_.front().poses[scene::own_bodies(mission.scene).panel()].translation();
  optics::OpticsConfig config = optics::outside_view(mission, optics::OutsideView::of_panel(panel_m));
  config.threads = threads;
  optics::Optics camera(config);
  optics::Frame frame;
  for (const Kept& kept : kept_) {
    optics::Shot shot;
    shot.poses = kept.poses;
    shot.laser = kept.moment->laser ? 1 : 0;
    shot.lamps = 1;
    camera.render(shot, frame);
    Picture picture{kept.moment->name, kept.moment->title, record::RgbImage(frame.width, frame.height)};
    picture.image.pixels = frame.pixels;
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace lf::app
