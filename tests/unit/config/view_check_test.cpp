#include "hal/config/view_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "hal/config/machine.hpp"

namespace lf::config {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> problems_of(const Machine& machine) {
  std::vector<std::string> problems;
  (void)make_core(machine, problems);
  return problems;
}

CameraCalibration usual_camera() { return make_core(Machine()).controller.camera; }

TEST(ViewCheck, WhatIsOutOfViewNamesTheLensAndWhereItStands) {
  Machine machine;
  machine.camera.focal_px = 5000;
  const std::vector<std::string> problems = problems_of(machine);
  EXPECT_THAT(problems, Contains(HasSubstr("the marker is out of the camera's view, at pixel -324, 574: see 'camera.position_m', "
                                           "'camera.down_deg', 'camera.right_deg', 'camera.focal_px', 'camera.distortion' and "
                                           "'panel.marker_centre_m'. 'panel.ahead_m' is 0.44, 'panel.right_m' 0, 'panel.down_m' 0.592")));
  EXPECT_THAT(problems, Contains(HasSubstr("'camera.distortion', 'panel.plate_min_m' and 'panel.plate_max_m'. 'panel.ahead_m'")));
  EXPECT_THAT(problems,
              Contains(AllOf(HasSubstr("the panel's lower left corner"), HasSubstr("'camera.distortion' and 'panel.plate_min_m'. "))));
  EXPECT_THAT(problems,
              Contains(AllOf(HasSubstr("the panel's upper right corner"), HasSubstr("'camera.distortion' and 'panel.plate_max_m'. "))));
}

// Barrel distortion pulls the panel's corners into the picture. The pixels beyond the fold have no ray: the run ended with a sentence that named no key.
TEST(ViewCheck, ALensThatFoldsItsPictureOverIsRefused) {
  for (const double k1 : {-0.2, -0.1}) {
    Machine machine;
    machine.camera.distortion = {k1, 0, 0, 0, 0};
    // r (1 + k1 r^2) has its largest value at r^2 = -1 / (3 k1): a corner that is farther out is imaged by no ray.
    const double farthest = std::sqrt(-1 / (3 * k1)) * 2 / 3, corner = std::hypot(328, 248) / machine.camera.focal_px;
    const auto folds = Contains(HasSubstr("some of its pixels have no ray of their own. Check 'camera.focal_px', 'camera.distortion'"));
    if (corner > farthest)
      EXPECT_THAT(problems_of(machine), folds) << k1;
    else
      EXPECT_THAT(problems_of(machine), Not(folds)) << k1;
  }
}

// r (1 + k1 r^2 + k2 r^4) falls from r = 0.51 on and rises again: the border has rays of the outer branch, and the ring between has three a pixel.
TEST(ViewCheck, ALensThatFoldsOverInsideOfThePictureIsRefused) {
  Machine machine;
  machine.camera.distortion = {-2, 1.67, 0, 0, 0};
  EXPECT_THAT(problems_of(machine), Contains(HasSubstr("this lens folds its picture over")));
}

// The radius grows all the way, and slower and slower: in between Newton's method finds no ray for some pixels, and the renderer has none.
TEST(ViewCheck, ALensThatNearlyFoldsInsideOfThePictureIsRefused) {
  for (const double k2 : {1.81, 1.83}) {
    Machine machine;
    machine.camera.distortion = {-2, k2, 0, 0, 0};
    EXPECT_THAT(problems_of(machine), Contains(HasSubstr("some of its pixels have no ray"))) << k2;
  }
}

// r (1 - 0.1 r^2) turns back at 61 degrees: what stands farther aside comes into the picture again, where the camera does not see it.
TEST(ViewCheck, WhatLiesBeyondAFoldIsNotSeen) {
  Machine machine;
  machine.camera.distortion = {-0.1, 0, 0, 0, 0};
  machine.camera.right_deg = -60;
  machine.camera.down_deg = 10;
  const std::vector<std::string> problems = problems_of(machine);
  EXPECT_THAT(problems, Not(Contains(HasSubstr("some of its pixels have no ray"))));
  EXPECT_THAT(problems, Contains(HasSubstr("the marker lies farther aside than this lens images")));
}

// A look needs one marker; a valve that nobody turns may stand where it likes.
TEST(ViewCheck, OfAFilesPanelOneMarkerAndTheValvesThatATaskTurnsHaveToBeSeen) {
  Machine machine;
  machine.survey = {"panel.yaml", {{"V1", "V2"}, {}, {"7", "9"}}, {ValveNature{}, ValveNature{}}};
  machine.panel.buttons.clear();
  ASSERT_TRUE(machine.panel.valves.push_back({.at_m{1.5, 0}}));
  PanelLayout::Marker aside;
  aside.id = 9;
  aside.centre_m = Vec2(1.5, 0.2);
  ASSERT_TRUE(machine.panel.markers.push_back(aside));
  const auto told = [&](const char* valve) {
    machine.tasks = {Task{Task::Kind::turn_valve, 10, valve}};
    return view_problems(machine, usual_camera());
  };
  EXPECT_THAT(told("V1"), testing::IsEmpty());
  EXPECT_THAT(told("V2"), testing::ElementsAre(AllOf(HasSubstr("valve V2 "), HasSubstr(" and 'valves.V2.height_m'. 'panel.ahead_m'"))));
  machine.panel.markers[0].centre_m = Vec2(-1.5, 0.2);
  EXPECT_THAT(told("V1"), testing::ElementsAre(AllOf(HasSubstr("marker 7 "), HasSubstr(" and 'markers.7.at_m'. 'panel.ahead_m'"))));
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
