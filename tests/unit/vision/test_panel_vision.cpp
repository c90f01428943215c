#include <gtest/gtest.h>

#include <cfenv>
#include <chrono>
#include <thread>

#include "hal/vision/panel_vision.hpp"
#include "tests/unit/vision/panel_cloud.hpp"
#include "tests/unit/vision/rendered_marker.hpp"

namespace lf::vision {
namespace {

// A docked panel: its cloud, and what the camera of the layout sees of its marker.
struct Docked {
  test::PanelCloudScene cloud_scene;
  test::RenderedMarker still;
  std::vector<CloudPoint> cloud;
  PanelVisionConfig config;
  PanelRequest request;
  Pose camera_from_tag = Pose::Identity();
};

// The camera of the published layout: (0.015, -0.245, 0.060), axis (0.678, 0.257, 0.688), no roll.
Pose base_from_camera() {
  Pose pose = Pose::Identity();
  const Vec3 z = Vec3(0.678, 0.257, 0.688).normalized();
  const Vec3 x = Vec3(0, 0, 1).cross(z).normalized();
  pose.linear() << x, z.cross(x), z;
  pose.translation() = Vec3(0.015, -0.245, 0.060);
  return pose;
}

const Docked& docked() {
  static const Docked shared = [] {
    Docked d;
    d.config.camera.base_from_camera = base_from_camera();
    const PanelLayout::Marker& marker = d.config.panel.markers[0];
    d.config.markers = MarkerCalibrations(MarkerCalibration{marker.id, marker.size_m, marker.panel_from_tag()});
    d.cloud = test::panel_cloud(d.cloud_scene);
    test::MarkerScene scene;
    scene.camera_from_tag = base_from_camera().inverse() * d.cloud_scene.base_from_panel * marker.panel_from_tag();
    scene.noise_grey = 2;
    d.still = test::render_marker(scene);
    d.camera_from_tag = scene.camera_from_tag;
    d.request.id = 3;
    d.request.fit = test::true_fit(d.cloud_scene);
    d.request.has_still = true;
    d.request.still_time = Time::from_s(20);
    return d;
  }();
  return shared;
}

PanelJob job_of(const Docked& d) { return PanelJob::copy(d.request, d.still.view(), d.cloud); }

bool same(const PanelResult& a, const PanelResult& b) {
  bool equal =
      a.id == b.id && a.clusters.size() == b.clusters.size() && a.confidence == b.confidence && a.markers.size() == b.markers.size();
  for (std::size_t i = 0; equal && i < a.markers.size(); ++i) {
    equal = a.markers[i].corners_px == b.markers[i].corners_px &&
            a.markers[i].camera_from_tag.matrix() == b.markers[i].camera_from_tag.matrix();
  }
  for (std::size_t i = 0; equal && i < a.clusters.size(); ++i) {
    equal = a.clusters[i].centroid_m == b.clusters[i].centroid_m && a.clusters[i].axis == b.clusters[i].axis;
  }
  return equal;
}

TEST(AnalysePanel, FindsMarkerHandleAndButtonsOfADockedPanel) {
  const Docked& d = docked();
  const PanelResult result = analyse_panel(d.request, d.still.view(), d.cloud, d.config);
  EXPECT_EQ(result.id, 3u);
  EXPECT_EQ(result.measured, d.request.still_time);
  ASSERT_EQ(result.markers.size(), 1u);
  EXPECT_EQ(result.markers[0].id, 7);
  EXPECT_LT((result.markers[0].camera_from_tag.translation() - d.camera_from_tag.translation()).norm(), 0.002);
  EXPECT_GT(result.markers[0].camera_from_tag.linear().col(2).dot(d.camera_from_tag.linear().col(2)), 0.9997);  // 1.4 degrees
  EXPECT_EQ(result.clusters.size(), 4u);
  EXPECT_GT(result.confidence, 0.6f);
  EXPECT_LE(result.confidence, 1.0f);
}

TEST(AnalysePanel, HasNoConfidenceWithoutFitMarkerOrProudPoints) {
  const Docked& d = docked();
  PanelRequest request = d.request;
  request.fit.valid = false;
  EXPECT_EQ(analyse_panel(request, d.still.view(), d.cloud, d.config).confidence, 0);
  EXPECT_EQ(analyse_panel(d.request, ImageView{}, d.cloud, d.config).confidence, 0);
  EXPECT_EQ(analyse_panel(d.request, d.still.view(), {}, d.config).confidence, 0);
  PanelVisionConfig other = d.config;
  other.markers[0].id = 8;
  EXPECT_TRUE(analyse_panel(d.request, d.still.view(), d.cloud, other).markers.empty());
  request = d.request;
  request.fit.plane.normal.x() = std::nan("");
  EXPECT_TRUE(analyse_panel(request, d.still.view(), d.cloud, d.config).clusters.empty());
}

TEST(AnalysePanel, LooksAtTheCloudAloneWhereNoStillWasTaken) {
  const Docked& d = docked();
  PanelRequest request = d.request;
  request.has_still = false;
  const PanelResult result = analyse_panel(request, ImageView{}, d.cloud, d.config);
  EXPECT_TRUE(result.markers.empty());
  EXPECT_GT(result.confidence, 0.6f);
}

TEST(AnalysePanel, TurnsAnExceptionIntoConfidenceZero) {
  const Docked& d = docked();
  PanelVisionConfig broken = d.config;
  broken.detector.family = "no such family";
  bool failed = false;
  const PanelResult result = analyse_panel(d.request, d.still.view(), d.cloud, broken, &failed);
  EXPECT_TRUE(failed);
  EXPECT_EQ(result.confidence, 0);
  EXPECT_EQ(result.id, d.request.id);
}

TEST(AnalysePanel, WorksWithFloatingPointTrapsSet) {
  const Docked& d = docked();
  const int before = fegetexcept();
  feclearexcept(FE_ALL_EXCEPT);
  if (feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW) == -1) GTEST_SKIP() << "this processor has no traps";  // most of ARM's
  const PanelResult result = analyse_panel(d.request, d.still.view(), d.cloud, d.config);
  const int during = fegetexcept();
  fedisableexcept(FE_ALL_EXCEPT);
  feenableexcept(before);
  EXPECT_GT(result.confidence, 0);
  EXPECT_EQ(during, FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);  // and leaves them set
}

TEST(PanelVisionWorker, AnswersAsTheAnalysisItselfTimeAfterTime) {
  const Docked& d = docked();
  const PanelResult direct = analyse_panel(d.request, d.still.view(), d.cloud, d.config);
  PanelVisionWorker worker(d.config);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(worker.submit(job_of(d)));
    PanelResult result;
    ASSERT_TRUE(worker.wait(result));
    EXPECT_TRUE(same(result, direct));
  }
  EXPECT_EQ(worker.stats().answered, 3u);
  EXPECT_EQ(worker.stats().failed, 0u);
}

TEST(PanelVisionWorker, RefusesAJobUntilTheLastAnswerWasFetched) {
  const Docked& d = docked();
  PanelVisionWorker worker(d.config);
  ASSERT_TRUE(worker.submit(job_of(d)));
  EXPECT_FALSE(worker.submit(job_of(d)));
  PanelResult result;
  while (!worker.poll(result)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_FALSE(worker.busy());
  EXPECT_FALSE(worker.poll(result));
  ASSERT_TRUE(worker.submit(job_of(d)));
  ASSERT_TRUE(worker.wait(result));
  EXPECT_EQ(worker.stats().accepted, 2u);
  EXPECT_EQ(worker.stats().refused, 1u);
}

TEST(PanelVisionWorker, CountsAFailureAndAnswersAllTheSame) {
  const Docked& d = docked();
  PanelVisionConfig broken = d.config;
  broken.detector.family = "no such family";
  PanelVisionWorker worker(broken);
  ASSERT_TRUE(worker.submit(job_of(d)));
  PanelResult result;
  ASSERT_TRUE(worker.wait(result));
  EXPECT_EQ(result.confidence, 0);
  EXPECT_EQ(worker.stats().failed, 1u);
}

TEST(PanelVisionWorker, DoesNotWaitForAJobThatWasNeverGiven) {
  PanelVisionWorker worker(docked().config);
  PanelResult result;
  EXPECT_FALSE(worker.wait(result));
  EXPECT_FALSE(worker.poll(result));
}

TEST(PanelVisionWorker, CanBeDestroyedWhileItWorks) {
  const Docked& d = docked();
  for (int i = 0; i < 4; ++i) {
    PanelVisionWorker worker(d.config);
    EXPECT_TRUE(worker.submit(job_of(d)));
  }
}

TEST(PanelVisionWorker, TakesAStillThatIsMissingOrBroken) {
  const Docked& d = docked();
  PanelVisionWorker worker(d.config);
  ASSERT_TRUE(worker.submit(PanelJob::copy(d.request, ImageView{}, d.cloud)));
  PanelResult result;
  ASSERT_TRUE(worker.wait(result));
  EXPECT_EQ(result.confidence, 0);
  PanelJob lying = job_of(d);
  lying.width = 4000;
  ASSERT_TRUE(worker.submit(lying));
  ASSERT_TRUE(worker.wait(result));
  EXPECT_TRUE(result.markers.empty());
}

}  // namespace
}  // namespace lf::vision
