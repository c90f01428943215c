#include "hal/sim/exposure_under_way.hpp"

namespace lf::hal {

void ExposureUnderWay::pass(Time begin, Time end, bool laser, bool lamps, const scene::BodyPoses& poses) {
  shutter_.pass(begin, end, laser, lamps);
  if (posed_ || end + (end - begin) / 2 < shutter_.middle()) return;
  poses_ = poses;
  posed_ = true;
}

optics::Shot ExposureUnderWay::shot() const {
  optics::Shot shot;
  shot.frame_number = sequence_;
  shot.poses = poses_;
  shot.laser = shutter_.laser_share();
  shot.lamps = shutter_.lamp_share();
  shot.exposure = ordered_.duration;
  shot.time_s = shutter_.middle().s();
  return shot;
}

}  // namespace lf::hal
