// Inside and outside, against closed forms.
#include "shared/mesh/winding.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/mesh/solids.hpp"

namespace lf::mesh {
namespace {

TEST(Winding, IsOneInsideAndNoneOutsideOfABox) {
  constexpr std::uint64_t seed = 3;
  const Mesh box = test::box(Vec3(1, 2, 3));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-1, 4);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p(place(random), place(random), place(random));
    const bool inside = (p.array() > 0).all() && (p.array() < Eigen::Array3d(1, 2, 3)).all();
    EXPECT_NEAR(winding_number(box.vertices_m, box.triangles, p), inside ? 1 : 0, 1e-9) << "seed " << seed << ", point " << p.transpose();
  }
}

TEST(Winding, KnowsAHoleAndASurfaceThatIsInsideOut) {
  const Mesh torus = test::torus(1, 0.3, 60);
  EXPECT_NEAR(winding_number(torus.vertices_m, torus.triangles, Vec3::Zero()), 0, 1e-9);
  EXPECT_NEAR(winding_number(torus.vertices_m, torus.triangles, Vec3(0, 1, 0.1)), 1, 1e-9);
  const Mesh turned = test::inside_out(test::tetrahedron());
  EXPECT_NEAR(winding_number(turned.vertices_m, turned.triangles, Vec3::Constant(0.1)), -1, 1e-9);
  EXPECT_EQ(winding_number({}, {}, Vec3::Zero()), 0);
}

}  // namespace
}  // namespace lf::mesh
