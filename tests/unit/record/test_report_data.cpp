// What the page's scripts read: the record's own numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "host_sim/record/report_parts.hpp"
#include "tests/unit/record/demo_run.hpp"

namespace lf::record {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;

Json json_of(const ReportData& data) { return Json::parse(page_data(data)); }

// Equal, to the six digits that the page keeps; null is what is not finite.
void expect_equal(const Json& shown, const std::vector<double>& recorded) {
  ASSERT_EQ(shown.size(), recorded.size());
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    if (!std::isfinite(recorded[i])) {
      EXPECT_TRUE(shown[i].is_null()) << i;
    } else {
      ASSERT_TRUE(shown[i].is_number()) << i;
      EXPECT_NEAR(shown[i].get<double>(), recorded[i], 5.1e-6 * std::abs(recorded[i]) + 1e-12) << i;
    }
  }
}

TEST(ReportData, HasEverySampleOfEverySeries) {
  const ReportData data = test::demo_run();
  const Json json = json_of(data);
  ASSERT_EQ(json["charts"].size(), data.charts.size());
  for (std::size_t c = 0; c < data.charts.size(); ++c) {
    const Json& chart = json["charts"][c];
    EXPECT_EQ(chart["title"], data.charts[c].title);
    EXPECT_EQ(chart["unit"], data.charts[c].unit);
    ASSERT_EQ(chart["series"].size(), data.charts[c].series.size());
    for (std::size_t s = 0; s < data.charts[c].series.size(); ++s) {
      const ReportSeries& recorded = data.charts[c].series[s];
      if (recorded.t_s.size() > most_samples) continue;
      const Json& series = chart["series"][s];
      EXPECT_EQ(series["name"], recorded.name);
      expect_equal(series["limits"], {recorded.limits.low, recorded.limits.high});
      expect_equal(series["v"], recorded.value);
      expect_equal(json["times"][series["t"].get<std::size_t>()], recorded.t_s);
    }
  }
}

TEST(ReportData, KeepsSeriesOverTheSameTimesOnOneListOfThem) {
  ReportData data;
  const std::vector<double> fast{0, 0.04, 0.08}, slow{0, 0.08};
  data.charts = {{"A", "m", {{"a", fast, {1, 2, 3}}, {"b", slow, {4, 5}}}}, {"B", "m", {{"c", fast, {6, 7, 8}}}}};
  const Json json = json_of(data);
  EXPECT_EQ(json["times"], Json::parse("[[0,0.04,0.08],[0,0.08]]"));
  EXPECT_EQ(json["charts"][0]["series"][0]["t"], 0);
  EXPECT_EQ(json["charts"][0]["series"][1]["t"], 1);
  EXPECT_EQ(json["charts"][1]["series"][0]["t"], 0);
  EXPECT_EQ(json["from"], 0);
  EXPECT_EQ(json["to"], 0.08);
}

TEST(ReportData, KeepsSpikesAndGapsOfALongRunInBoundedSpace) {
  ReportData data;
  constexpr std::size_t count = 250'000, spike = 123'456, dip = 40'001;
  ReportSeries series{"torque", {}, {}, false};
  for (std::size_t i = 0; i < count; ++i) {
    series.t_s.push_back(static_cast<double>(i) * 0.004);
    series.value.push_back(i == spike ? 1000 : i == dip ? -500 : i > 200'000 && i < 210'000 ? unknown : 1);
  }
  data.charts = {{"Torque", "N m", {series}}};
  const Json json = json_of(data);
  const Json& times = json["times"][0];
  const Json& values = json["charts"][0]["series"][0]["v"];
  ASSERT_EQ(times.size(), most_samples);
  ASSERT_EQ(values.size(), most_samples);
  const double piece_s = 0.004 * 2 * count / most_samples;
  const auto place_of = [&](double value) {
    return static_cast<std::size_t>(std::find(values.begin(), values.end(), value) - values.begin());
  };
  ASSERT_LT(place_of(1000), values.size());
  ASSERT_LT(place_of(-500), values.size());
  EXPECT_NEAR(times[place_of(1000)].get<double>(), spike * 0.004, piece_s);
  EXPECT_NEAR(times[place_of(-500)].get<double>(), dip * 0.004, piece_s);
  EXPECT_EQ(times.front(), 0);
  EXPECT_NEAR(times.back().get<double>(), (count - 1) * 0.004, 1e-6);
  for (std::size_t i = 1; i < times.size(); ++i) ASSERT_LT(times[i - 1].get<double>(), times[i].get<double>());
  const auto gaps = std::count_if(values.begin(), values.end(), [](const Json& value) { return value.is_null(); });
  EXPECT_NEAR(static_cast<double>(gaps), 1e4 / count * most_samples, 4);
}

TEST(ReportData, HasPhasesAndFaultsWithTheirTimes) {
  ReportData data;
  data.result.phases = {{"boot", 0.004, 1.5, "done"}, {"scan", 1.5, 21.25, "failed"}, {"never", unknown, unknown, ""}};
  data.result.faults = {{12.5, 12.75, 3, "scan", "image lost", "image lost", "count"},
                        {13.25, 13.25, 1, "scan", "emcy", "EMCY 0x2310", ""}};
  const Json json = json_of(data);
  EXPECT_EQ(json["phases"], Json::parse(R"([{"name":"boot","from":0.004,"to":1.5},{"name":"scan","from":1.5,"to":21.25}])"));
  EXPECT_EQ(json["faults"], Json::parse(R"([{"t":12.5,"last":12.75,"times":3,"text":"image lost","reaction":"count"},
                                            {"t":13.25,"last":13.25,"times":1,"text":"EMCY 0x2310","reaction":""}])"));
  EXPECT_EQ(json["from"], 0.004);
  EXPECT_EQ(json["to"], 21.25);
}

TEST(ReportData, CannotEndItsElement) {
  ReportData data;
  data.charts = {{"</script><script>alert(1)</script>", "<!--", {{"\xff</script>", {0}, {1}}}}};
  EXPECT_THAT(page_data(data), Not(HasSubstr("<")));
  EXPECT_EQ(json_of(data)["charts"][0]["title"], data.charts[0].title);
}

TEST(ReportData, HasTheRobotsPartsAndHowTheyMoved) {
  const ReportData data = test::demo_run();
  const Json motion = json_of(data)["motion"];
  ASSERT_EQ(motion["parts"].size(), data.motion.parts.size());
  for (std::size_t i = 0; i < data.motion.parts.size(); ++i) {
    const ReportPart& part = data.motion.parts[i];
    const Json& shown = motion["parts"][i];
    EXPECT_EQ(shown["parent"], part.parent);
    EXPECT_EQ(shown["by"], part.coordinate);
    EXPECT_EQ(shown["slides"], part.slides);
    ASSERT_EQ(shown["at"].size(), 12u);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column)
        EXPECT_NEAR(shown["at"][static_cast<std::size_t>(4 * row + column)].get<double>(), part.parent_from_part.matrix()(row, column),
                    1e-8);
    }
    ASSERT_EQ(shown["solids"].size(), part.shapes.size());
  }
  ASSERT_EQ(motion["coordinates"].size(), data.motion.coordinates.size());
  for (std::size_t i = 0; i < data.motion.coordinates.size(); ++i)
    expect_equal(motion["coordinates"][i]["v"], data.motion.coordinates[i].value);
  EXPECT_EQ(json_of(ReportData{})["motion"], nullptr);
}

TEST(ReportData, LeavesOutShapesThatAreNotSeen) {
  ReportData data;
  data.motion.t_s = {0};
  data.motion.parts.resize(1);
  data.motion.parts[0].shapes.resize(2);
  data.motion.parts[0].shapes[1].visible = false;
  EXPECT_EQ(json_of(data)["motion"]["parts"][0]["solids"].size(), 1u);
}

// Volume by the divergence theorem: positive only when the triangles wind counter-clockwise seen from outside, and whole only when nothing is open.
double volume_of(const Solid& solid) {
  double volume = 0;
  for (const auto& [a, b, c] : solid.triangles) volume += solid.vertices_m[a].dot(solid.vertices_m[b].cross(solid.vertices_m[c])) / 6;
  return volume;
}

TEST(Solid, HasTheShapesVolumeWhereverItStands) {
  scene::Shape shape;
  shape.body_from_shape.translation() = Vec3(0.3, -0.2, 0.1);
  shape.body_from_shape.linear() = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  shape.kind = scene::ShapeKind::box;
  shape.size_m = Vec3(0.2, 0.3, 0.4);
  EXPECT_NEAR(volume_of(solid_of(shape)), 0.024, 1e-12);
  shape.kind = scene::ShapeKind::cylinder;
  EXPECT_NEAR(volume_of(solid_of(shape, 400)), pi * 0.04 * 0.4, 1e-5);
  shape.kind = scene::ShapeKind::sphere;
  EXPECT_NEAR(volume_of(solid_of(shape, 400)), 4.0 / 3 * pi * 0.008, 1e-5);
  shape.kind = scene::ShapeKind::capsule;
  EXPECT_NEAR(volume_of(solid_of(shape, 400)), pi * 0.04 * 0.4 + 4.0 / 3 * pi * 0.008, 2e-5);
}

TEST(Solid, OfAMeshIsTheMeshAndOfAHugeOneItsBox) {
  scene::Shape shape;
  shape.kind = scene::ShapeKind::mesh;
  shape.vertices_m = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  shape.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  EXPECT_NEAR(volume_of(solid_of(shape)), 1.0 / 6, 1e-12);
  shape.triangles.resize(100'000, {0, 2, 1});
  EXPECT_NEAR(volume_of(solid_of(shape)), 1, 1e-12);
}

}  // namespace
}  // namespace lf::record
