#include "host_sim/app/outside_picture.hpp"

#include "host_sim/optics/outside_view.hpp"
#include "host_sim/record/file_sink.hpp"
#include "host_sim/record/png.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/world/world.hpp"

namespace lf::app {

void draw_outside(const scenario::Scenario& scenario, const scenario::Scenario& machine, const std::string& picture) {
  scenario::Sample sample = scenario::draw(scenario, 1);
  sample.docking_shift_m = sample.docking_turn_rad = Vec3::Zero();
  const scenario::Nominal nominal = scenario::make_nominal(machine, sample.lamps_lit);
  const hal::SimConfig sim = scenario::make_truth(scenario, sample, nominal, 1);
  const world::World world(sim.world);
  optics::Shot shot;
  shot.poses = world.base_from_body();
  const Vec3 panel_m = sim.world.base_from_panel.translation();
  optics::Optics camera(optics::outside_view(sim.optics, optics::OutsideView::of_panel(panel_m)));
  shot.lamps = 1;
  shot.laser = 0;
  optics::Frame frame;
  camera.render(shot, frame);
  record::RgbImage image(frame.width, frame.height);
  image.pixels = frame.pixels;
  const std::vector<std::uint8_t> png = record::encode_png(image);
  record::write_file_atomically(picture, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace lf::app
