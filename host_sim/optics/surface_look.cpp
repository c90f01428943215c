#include "host_sim/optics/surface_look.hpp"

#include <cmath>

#include "shared/input_error.hpp"

namespace lf::optics {
namespace {

constexpr int tile = 128;                 // cells of the grain, then it repeats; a power of two
constexpr float fine_per_m = 1 / 0.004f;  // cells of 4 mm: 2 px on the panel
constexpr float coarse_per_m = 1 / 0.023f;

std::uint32_t hash(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352dU;
  x = (x ^ (x >> 15)) * 0x846ca68bU;
  return x ^ (x >> 16);
}

// Value noise in -1 .. 1 at (a, b) in cells, bilinear between random corners.
Lanes value_noise(const std::vector<float>& corners, Lanes a, Lanes b) {
  const Lanes floor_a = floor(a), floor_b = floor(b);
  const Lanes fa = a - floor_a, fb = b - floor_b;
  const LaneMask column = __builtin_convertvector(floor_a, LaneMask) & (tile - 1), next_column = (column + 1) & (tile - 1);
  const LaneMask row = (__builtin_convertvector(floor_b, LaneMask) & (tile - 1)) * tile;
  const LaneMask next_row = (row + tile) & (tile * tile - 1);
  const auto at = [&](LaneMask cell) {
    Lanes value;
    for (int i = 0; i < lane_count; ++i) value[i] = corners[static_cast<std::size_t>(cell[i])];
    return value;
  };
  const Lanes low = at(row + column) * (1.f - fa) + at(row + next_column) * fa;
  const Lanes high = at(next_row + column) * (1.f - fa) + at(next_row + next_column) * fa;
  return low * (1.f - fb) + high * fb;
}

}  // namespace

SurfaceLook::SurfaceLook(const scene::Scene& scene, float grain) : grain_(grain) {
  for (std::size_t body = 0; body < scene.size(); ++body) {
    for (const scene::Shape& shape : scene[body].shapes) {
      Look look;
      look.albedo = shape.albedo;
      look.body = body;
      look.body_from_shape = shape.body_from_shape;
      look.top_m = 0.5 * shape.size_m.z();
      for (const float albedo : shape.albedo) {
        if (!(albedo >= 0 && albedo <= 1)) throw InputError("scene: " + scene[body].name + ": an albedo must lie in 0..1");
      }
      if (shape.marker_id >= 0) {
        if (shape.kind != scene::ShapeKind::box) throw InputError("scene: " + scene[body].name + ": a marker needs a box");
        look.marker.emplace(shape.marker_id, shape.marker_size_m);
      }
      looks_.push_back(look);
    }
  }
  noise_.resize(static_cast<std::size_t>(tile) * tile);
  for (std::uint32_t i = 0; i < noise_.size(); ++i) noise_[i] = static_cast<float>(hash(i + 1)) / 2147483648.f - 1.f;
  rotations_.resize(scene.size());
  positions_.resize(scene.size());
  set_poses(scene::poses_at_origin(scene));
}

void SurfaceLook::set_poses(const scene::BodyPoses& base_from_body) {
  for (std::size_t body = 0; body < base_from_body.size(); ++body) {
    rotations_[body] = Rotation(base_from_body[body].linear());
    positions_[body] = Lanes3(base_from_body[body].translation());
  }
  for (Look& look : looks_) {
    if (look.marker) look.shape_from_base = (base_from_body[look.body] * look.body_from_shape).inverse();
  }
}

Lanes SurfaceLook::grain(const SurfacePacket& surface, LaneMask shape, float footprint) const {
  Lanes3 local;
  visit_values(shape, [&](std::int32_t of, LaneMask lanes) {
    const std::size_t body = of < 0 ? 0 : looks_[static_cast<std::size_t>(of)].body;
    local = select(lanes, rotations_[body].transposed_times(surface.point - positions_[body]), local);
  });
  // An oblique map to two dimensions: no face of a box is degenerate, no seam runs through a surface.
  const Lanes a = local.x + 0.7f * local.z, b = local.y + 0.6f * local.z;
  const Lanes pixel_m = footprint * sqrt(dot(surface.point_dv, surface.point_dv));
  const Lanes fine = clamp(2.f - 1.5f * pixel_m * fine_per_m, 0.f, 1.f);  // finer than the pixel it would alias
  return 1.f +
         grain_ * (value_noise(noise_, a * coarse_per_m, b * coarse_per_m) + fine * value_noise(noise_, a * fine_per_m, b * fine_per_m));
}

std::optional<float> SurfaceLook::white_share(const SurfacePacket& surface, int lane, const Look& look, float footprint) const {
  const auto at = [lane](const Lanes3& v) { return Vec3(v.x[lane], v.y[lane], v.z[lane]); };
  const Pose& shape_from_base = look.shape_from_base;
  const Vec3 p = shape_from_base * at(surface.point);
  if (std::abs(p.z() - look.top_m) > 1e-4) return std::nullopt;
  const Vec3 du = shape_from_base.linear() * at(surface.point_du) * footprint,
             dv = shape_from_base.linear() * at(surface.point_dv) * footprint;
  return look.marker->white_share(p.head<2>(), du.head<2>(), dv.head<2>());
}

LaneMask SurfaceLook::marks_edges(const SurfacePacket& surface, LaneMask shape, LaneMask wanted) const {
  LaneMask edges{};
  for (int i = 0; i < lane_count; ++i) {
    if (wanted[i] == 0 || shape[i] < 0) continue;
    const Look& look = looks_[static_cast<std::size_t>(shape[i])];
    if (!look.marker) continue;
    const std::optional<float> white = white_share(surface, i, look, 1.f);
    edges[i] = white && *white > 0.01f && *white < 0.99f ? -1 : 0;
  }
  return edges;
}

RgbLanes SurfaceLook::albedo(const SurfacePacket& surface, LaneMask shape, float footprint) const {
  RgbLanes albedo{};
  visit_values(shape, [&](std::int32_t of, LaneMask lanes) {
    if (of < 0) return;
    for (std::size_t band = 0; band < 3; ++band) {
      albedo[band] = select(lanes, all_lanes(looks_[static_cast<std::size_t>(of)].albedo[band]), albedo[band]);
    }
  });
  if (grain_ > 0) {
    const Lanes factor = grain(surface, shape, footprint);
    for (Lanes& band : albedo) band *= factor;
  }
  for (int i = 0; i < lane_count; ++i) {
    if (shape[i] < 0) continue;
    const Look& look = looks_[static_cast<std::size_t>(shape[i])];
    if (!look.marker) continue;
    constexpr float paper = 0.80f, ink = 0.04f;  // printed plastic
    const std::optional<float> white = white_share(surface, i, look, footprint);
    for (std::size_t band = 0; white && band < 3; ++band) albedo[band][i] = ink + (paper - ink) * *white;
  }
  return albedo;
}

}  // namespace lf::optics
