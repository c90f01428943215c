// Which pixels see one plane: against planes whose depth is a closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "host_sim/optics/pixel_store.hpp"

namespace lf::optics {
namespace {

constexpr int height = 40;

// A column that sees, in each row v, a plane of inverse depth `at_0 + v * slope`, 1/m; from row 20 on it is nearer by `step_m` and of `shape`.
PixelStore column(float at_0, float slope, float step_m, std::int32_t shape, float normal_z = 0) {
  PixelStore pixels;
  pixels.resize(8, height, 1);
  for (int v = 0; v < height; ++v) {
    const std::size_t at = pixels.index(0, v);
    pixels.depth_m[at] = 1 / (at_0 + static_cast<float>(v) * slope) - (v < 20 ? 0 : step_m);
    pixels.normal_x[at] = v < 20 ? -1.f : -std::sqrt(1 - normal_z * normal_z);
    pixels.normal_y[at] = 0;
    pixels.normal_z[at] = v < 20 ? 0 : normal_z;
    pixels.shape[at] = v < 20 ? 0 : shape;
  }
  return pixels;
}

bool on_one_plane(const PixelStore& pixels, int v, int w) {
  return pixels.on_one_plane(pixels.index(0, v), pixels.index(0, w)) && pixels.on_one_plane(pixels.index(0, w), pixels.index(0, v));
}

TEST(PixelStore, OnePlaneIsOfOneShapeOrOfTwo) {
  for (const float slope : {0.f, 0.004f, -0.004f}) {
    EXPECT_TRUE(on_one_plane(column(1.4f, slope, 0, 0), 10, 30)) << slope;
    EXPECT_TRUE(on_one_plane(column(1.4f, slope, 0, 1), 10, 30)) << slope;
    EXPECT_TRUE(on_one_plane(column(1.4f, slope, 0.006f, 1), 0, 19)) << "beside a step, slope " << slope;
    EXPECT_TRUE(on_one_plane(column(1.4f, slope, 0.006f, 1), 20, height - 1)) << "to the last row, slope " << slope;
  }
}

TEST(PixelStore, AStepACreaseAndOpenWaterAreNotOnePlane) {
  EXPECT_FALSE(on_one_plane(column(1.4f, 0.004f, 0.006f, 0), 10, 30)) << "a bezel of 6 mm";
  EXPECT_FALSE(on_one_plane(column(1.4f, 0.004f, 0, 0, 0.5f), 10, 30)) << "30 degrees";
  EXPECT_FALSE(on_one_plane(column(1.4f, 0.004f, 0, -1), 10, 30));
}

// Eight samples of one face under one lamp; each change of one of them is an edge, or a stripe's.
TEST(PixelStore, ASampleIsEvenOnOneFaceInOneLight) {
  Sample even;
  even.hit.shape = LaneMask{} + 3;
  even.hit.parameter = all_lanes(0.7f);
  even.hit.normal = Lanes3(Vec3(-1, 0, 0));
  even.reached = even.lit = LaneMask{} + (1 << 16);
  ASSERT_TRUE(even.is_even());
  constexpr int lane = 5;
  const auto changed = [&](const auto& change) {
    Sample sample = even;
    change(sample);
    return sample.is_even();
  };
  EXPECT_FALSE(changed([](Sample& s) { s.hit.shape[lane] = 4; })) << "another shape";
  EXPECT_FALSE(changed([](Sample& s) { s.hit.shape[lane] = -1; })) << "open water";
  EXPECT_FALSE(changed([](Sample& s) { s.hit.parameter[lane] = 0.75f; })) << "a step";
  EXPECT_TRUE(changed([](Sample& s) { s.hit.parameter[lane] = 0.703f; })) << "a plane at a slant";
  EXPECT_FALSE(changed([](Sample& s) { s.hit.normal.x[lane] = -0.9f, s.hit.normal.z[lane] = 0.436f; })) << "a crease";
  EXPECT_FALSE(changed([](Sample& s) { s.lit[lane] = 0; })) << "a shadow";
  EXPECT_FALSE(changed([](Sample& s) { s.reached |= 1; })) << "a stripe on all of them";
}

}  // namespace
}  // namespace lf::optics
