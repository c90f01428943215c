// Two whole sweeps, which an emulated microcontroller takes more than a minute for: hosted only.
#include <gtest/gtest.h>

#include "firmware/scan_pipeline.hpp"
#include "tests/unit/scan/docked_scene.hpp"
#include "tests/unit/scan/scan_bench.hpp"

namespace lf {
namespace {

using test::nominal_sweep;
using test::ScanBench;

// As many points of four times as many frames: a fourth of the columns, and the same plane.
TEST(ScanColumns, AreFewerOfEachStripeWhereItIsToldSo) {
  ScanBench all(PanelLayout{}.nominal_base_from_panel()), fourth(PanelLayout{}.nominal_base_from_panel(), 4);
  const auto points = [](ScanBench& bench, PanelRequest& request) {
    (void)bench.sweep(nominal_sweep());
    bench.command(ScanCommand::Kind::analyse);
    EXPECT_TRUE(bench.pipeline().take_request(request));
    return static_cast<double>(bench.pipeline().cloud().size());
  };
  PanelRequest whole, thin;
  EXPECT_NEAR(points(fourth, thin) / points(all, whole), 0.25, 0.01);
  EXPECT_LT(thin.fit.plane.normal.cross(whole.fit.plane.normal).norm(), rad_from_deg(0.01));
}

}  // namespace
}  // namespace lf
