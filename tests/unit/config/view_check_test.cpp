#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "hal/config/machine.hpp"

namespace lf::config {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> problems_of(const Machine& machine) {
  std::vector<std::string> problems;
  (void)make_core(machine, problems);
  return problems;
}

TEST(ViewCheck, WhatIsOutOfViewNamesTheLensAndWhereItStands) {
  Machine machine;
  machine.camera.focal_px = 5000;
  const std::vector<std::string> problems = problems_of(machine);
  EXPECT_THAT(problems, Contains(HasSubstr("the marker is out of the camera's view, at pixel -324, 574: see 'camera.position_m', "
                                           "'camera.down_deg', 'camera.right_deg', 'camera.focal_px', 'camera.distortion' and "
                                           "'panel.marker_centre_m'. 'panel.ahead_m' is 0.44, 'panel.right_m' 0, 'panel.down_m' 0.592")));
  EXPECT_THAT(problems, Contains(HasSubstr("'camera.distortion', 'panel.plate_min_m' and 'panel.plate_max_m'. 'panel.ahead_m'")));
}

// A calibration overrules the focal length and the distortion of the machine's file: these would not help.
TEST(ViewCheck, ACalibrationIsNamedInPlaceOfTheKeysThatItOverrules) {
  const std::string file = std::filesystem::path(testing::TempDir()) / "narrow_lens.yaml";
  std::ofstream(file) << "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
                         "  data: [5000, 0., 319.5, 0., 5000, 239.5, 0., 0., 1.]\ndistortion_model: plumb_bob\n"
                         "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0., 0., 0., 0., 0.]\n";
  Machine machine;
  machine.camera_calibration = file;
  const std::vector<std::string> problems = problems_of(machine);
  EXPECT_THAT(problems, Contains(HasSubstr("'camera.right_deg', the calibration " + file + " and 'panel.marker_centre_m'. ")));
  EXPECT_THAT(problems, Not(Contains(HasSubstr("'camera.focal_px'"))));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace lf::config
