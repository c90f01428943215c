#include "host_sim/optics/formation/particles.hpp"

#include <algorithm>
#include <cmath>

#include "shared/random.hpp"

namespace lf::optics {
namespace {

constexpr double one_of_2_64 = 0x1p-64;
constexpr int most_in_a_cell = 60;
constexpr std::size_t cells_a_block = 256;
constexpr float aperture_m = 0.00077f, focus_m = 0.75f;  // f 2.17 mm at F/2.8
constexpr float disc_sigma = 1 / 2.4f;                   // of a Gaussian as wide as a disc, over its diameter
constexpr float least_sigma_px = 0.35f;
constexpr double widest = 1.2;  // of a corner's ray, distorted or behind a port, over the pinhole's
constexpr double image_margin_m = 0.03;
constexpr float least_grey = 0.1f;
constexpr float daylight_share = 0.55f;  // of the downwelling light that falls on a speck, from all sides

// Draws of one stream.
class Draws {
 public:
  explicit Draws(std::uint64_t state) : state_(state) {}
  double operator()() {
    state_ = splitmix64(state_);
    return (static_cast<double>(state_) + 0.5) * one_of_2_64;
  }

 private:
  std::uint64_t state_;
};

// Of Poisson's distribution, by its inverse. `none`: exp(-mean).
int count_of(double mean, double none, double draw) {
  double share = none, sum = share;
  int count = 0;
  while (draw > sum && count < most_in_a_cell) share *= mean / ++count, sum += share;
  return count;
}

}  // namespace

Particles::Particles(const Camera& camera, const WaterConfig& water, std::uint64_t seed)
    : camera_(camera),
      camera_from_base_(camera.config.base_from_camera.inverse()),
      tan_u_(widest * std::max(camera.config.intrinsics.cx + 1, camera.config.intrinsics.width - camera.config.intrinsics.cx) /
             camera.config.intrinsics.fx),
      tan_v_(widest * std::max(camera.config.intrinsics.cy + 1, camera.config.intrinsics.height - camera.config.intrinsics.cy) /
             camera.config.intrinsics.fy),
      per_cell_(water.particles_per_l * 1e3 * cell_m * cell_m * cell_m),
      none_in_a_cell_(std::exp(-per_cell_)),
      current_m_s_(water.current_m_s),
      seed_(seed) {
  if (per_cell_ <= 0) return;
  const Pose& base_from_camera = camera.config.base_from_camera;
  const CameraIntrinsics& k = camera.config.intrinsics;
  // The corners' rays in air are wider than those in water: the view's bound is safe behind a port, too.
  Vec3 low = Vec3::Constant(1e9), high = Vec3::Constant(-1e9);
  for (const double z : {near_m, far_m}) {
    for (const double u : {-1.0, k.width + 0.0}) {
      for (const double v : {-1.0, k.height + 0.0}) {
        const Vec3 corner = base_from_camera * Vec3((u - k.cx) / k.fx * z * widest, (v - k.cy) / k.fy * z * widest, z);
        low = low.cwiseMin(corner), high = high.cwiseMax(corner);
      }
    }
  }
  const double reach_m = cell_m * 1.8;  // a cell's diagonal, and a margin
  const Eigen::Vector3i first = (low / cell_m).array().floor().cast<int>() - 1, last = (high / cell_m).array().floor().cast<int>();
  for (std::int32_t x = first.x(); x <= last.x(); ++x) {
    for (std::int32_t y = first.y(); y <= last.y(); ++y) {
      for (std::int32_t z = first.z(); z <= last.z(); ++z) {
        // With its drift of up to a cell it lies about one cell's corner.
        const Vec3 p = camera_from_base_ * (cell_m * Vec3(x + 1, y + 1, z + 1));
        if (p.z() < near_m - reach_m || p.z() > far_m + reach_m) continue;
        if (std::abs(p.x()) > tan_u_ * std::max(p.z(), 0.0) + reach_m * (1 + tan_u_)) continue;
        if (std::abs(p.y()) > tan_v_ * std::max(p.z(), 0.0) + reach_m * (1 + tan_v_)) continue;
        cells_.push_back({x, y, z});
      }
    }
  }
}

void Particles::draw_specks(const Cell& cell, const Vec3& drift, std::vector<Speck>& specks) const {
  const Vec3 whole = drift.array().floor();
  std::uint64_t key = seed_;
  for (int axis = 0; axis < 3; ++axis)
    key = splitmix64(key + static_cast<std::uint64_t>(cell[static_cast<std::size_t>(axis)] - static_cast<std::int64_t>(whole[axis])));
  Draws draw(key);
  const int count = count_of(per_cell_, none_in_a_cell_, draw());
  for (int i = 0; i < count; ++i) {
    Speck speck;
    for (int axis = 0; axis < 3; ++axis)
      speck.place_m[axis] = cell_m * (cell[static_cast<std::size_t>(axis)] + drift[axis] - whole[axis] + draw());
    speck.diameter_m = std::min(least_m / std::sqrt(draw()), most_m);
    speck.albedo = 0.1 + 0.4 * draw();
    specks.push_back(speck);
  }
}

std::vector<Particles::Speck> Particles::at(double time_s) const {
  std::vector<Speck> specks;
  for (const Cell& cell : cells_) draw_specks(cell, current_m_s_ * (time_s / cell_m), specks);
  return specks;
}

std::vector<SheetLight::Speck> Particles::in_sheet(double time_s, const SheetLight& sheet, WorkerPool& pool) const {
  if (!sheet.is_line()) return {};
  constexpr double half_diagonal_m = 0.87 * cell_m;
  const Vec3 drift = current_m_s_ * (time_s / cell_m);
  const Vec3 middle = cell_m * (drift.array() - drift.array().floor() + 0.5).matrix();
  const std::size_t blocks = (cells_.size() + cells_a_block - 1) / cells_a_block;
  std::vector<std::vector<SheetLight::Speck>> found(blocks);
  pool.run(static_cast<int>(blocks), [&](int block) {
    const std::size_t first = static_cast<std::size_t>(block) * cells_a_block;
    std::vector<Speck> specks;
    for (const Cell& cell : std::span(cells_).subspan(first, std::min(cells_a_block, cells_.size() - first))) {
      if (sheet.reaches(middle + cell_m * Vec3(cell[0], cell[1], cell[2]), half_diagonal_m + most_m)) draw_specks(cell, drift, specks);
    }
    for (const Speck& speck : specks) {
      if (sheet.reaches(speck.place_m, speck.diameter_m))
        found[static_cast<std::size_t>(block)].push_back({speck.place_m, speck.diameter_m});
    }
  });
  std::vector<SheetLight::Speck> met;
  for (const auto& of_block : found) met.insert(met.end(), of_block.begin(), of_block.end());
  return met;
}

std::vector<Particles::Speck> Particles::in_view(std::span<const Cell> cells, double time_s) const {
  std::vector<Speck> specks;
  for (const Cell& cell : cells) draw_specks(cell, current_m_s_ * (time_s / cell_m), specks);
  std::size_t kept = 0;
  for (Speck& speck : specks) {
    const Vec3 p = camera_from_base_ * speck.place_m;
    if (p.z() < near_m || p.z() > far_m || std::abs(p.x()) > tan_u_ * p.z() + image_margin_m ||
        std::abs(p.y()) > tan_v_ * p.z() + image_margin_m)
      continue;
    speck.place_m = p;
    specks[kept++] = speck;
  }
  specks.resize(kept);
  return specks;
}

int Particles::Spot::reach_px() const { return static_cast<int>(std::ceil(3.5f * sigma_px)); }
int Particles::Spot::first_row() const { return static_cast<int>(std::lround(centre_px.y())) - reach_px(); }
int Particles::Spot::last_row() const { return static_cast<int>(std::lround(centre_px.y())) + reach_px(); }

// Radiance times pixels is irradiance * albedo / pi * area * (f / z)^2.
Particles::Looks Particles::looks(const PlacesInView& specks, const RgbLanes& irradiance, const Shader& shader) const {
  const auto fy = static_cast<float>(camera_.config.intrinsics.fy);
  const Lanes px_per_m = fy / specks.place_m.z;
  const Lanes image_px = specks.diameter_m * px_per_m;
  const Lanes defocus_px = aperture_m * fy * abs(1.f / specks.place_m.z - 1 / focus_m);
  Looks looks;
  looks.sigma_px = max(sqrt(image_px * image_px + defocus_px * defocus_px) * disc_sigma, all_lanes(least_sigma_px));
  const Lanes size = 0.25f * specks.albedo * image_px * image_px, range = norm(specks.place_m);
  RgbLanes radiance;
  for (std::size_t band = 0; band < 3; ++band) radiance[band] = irradiance[band] * size * shader.water().transmission(band, range);
  looks.grey = camera_.grey(radiance);
  const Lanes brightest = max(looks.grey[0], max(looks.grey[1], looks.grey[2]));
  looks.seen = brightest >= least_grey * static_cast<float>(2 * pi) * looks.sigma_px * looks.sigma_px;
  return looks;
}

// Where a speck's image lies; nothing where that is outside the picture or behind a surface.
std::optional<Vec2> Particles::image_of(const Vec3& place_m, const PixelStore& pixels) const {
  const std::optional<Vec2> image = camera_.rays.project(place_m);
  if (!image) return std::nullopt;
  const int u = std::clamp(static_cast<int>(std::lround(image->x())), 0, pixels.width - 1);
  const int v = std::clamp(static_cast<int>(std::lround(image->y())), 0, pixels.height - 1);
  const double depth_m = static_cast<double>(pixels.depth_m[pixels.index(u, v)]) + static_cast<double>(camera_.rays.origin_depth_m());
  return place_m.z() < depth_m ? image : std::nullopt;
}

std::vector<Particles::Spot> Particles::spots(std::span<const Cell> cells, double time_s, const Shader& shader,
                                              const PixelStore& pixels) const {
  const std::vector<Speck> specks = in_view(cells, time_s);
  std::vector<Spot> spots;
  for (std::size_t first = 0; first < specks.size(); first += lane_count) {
    const std::size_t count = std::min<std::size_t>(lane_count, specks.size() - first);
    PlacesInView places;
    for (int lane = 0; lane < lane_count; ++lane) {
      const Speck& speck = specks[first + std::min(static_cast<std::size_t>(lane), count - 1)];
      places.place_m.x[lane] = static_cast<float>(speck.place_m.x()), places.place_m.y[lane] = static_cast<float>(speck.place_m.y()),
      places.place_m.z[lane] = static_cast<float>(speck.place_m.z()), places.diameter_m[lane] = static_cast<float>(speck.diameter_m);
      places.albedo[lane] = static_cast<float>(speck.albedo);
    }
    const Lanes3 place = camera_.place.position + camera_.place.rotation * places.place_m;
    const Looks looks_of = looks(places, shader.at(place, daylight_share), shader);
    for (std::size_t lane = 0; lane < count; ++lane) {
      if (looks_of.seen[lane] == 0) continue;
      const std::optional<Vec2> image = image_of(specks[first + lane].place_m, pixels);
      if (!image) continue;
      Spot& spot = spots.emplace_back();
      spot.centre_px = *image;
      spot.sigma_px = looks_of.sigma_px[lane];
      for (std::size_t c = 0; c < 3; ++c) spot.grey[c] = looks_of.grey[c][lane];
    }
  }
  return spots;
}

Particles::Bell Particles::bell(int middle, double centre, float sigma_px, int reach) {
  constexpr Lanes count_up{0, 1, 2, 3, 4, 5, 6, 7};
  Bell bell;
  const float first = static_cast<float>(middle - centre) - static_cast<float>(reach), per_sigma = 1 / sigma_px;
  const auto size = 2 * static_cast<std::size_t>(reach) + 1;
  bell.share.resize((size + lane_count - 1) / lane_count * lane_count);
  for (std::size_t i = 0; i < size; i += lane_count) {
    const Lanes off = (first + static_cast<float>(i) + count_up) * per_sigma;
    store_lanes(bell.share.data() + i, exp(-0.5f * off * off));
  }
  bell.share.resize(size);
  for (const float share : bell.share) bell.sum += share;
  return bell;
}

// Its light is spread over the pixels about its centre, of which those from `first_row` to before `end_row` get theirs.
void Particles::show(const Spot& spot, int first_row, int end_row, PixelStore& pixels) {
  const int reach = spot.reach_px();
  const auto centre_u = static_cast<int>(std::lround(spot.centre_px.x())), centre_v = static_cast<int>(std::lround(spot.centre_px.y()));
  const Bell across = bell(centre_u, spot.centre_px.x(), spot.sigma_px, reach),
             down = bell(centre_v, spot.centre_px.y(), spot.sigma_px, reach);
  const int first_u = std::max(centre_u - reach, 0), end_u = std::min(centre_u + reach + 1, pixels.width);
  for (int v = std::max(centre_v - reach, first_row); v < std::min(centre_v + reach + 1, end_row); ++v) {
    const float row = down.share[static_cast<std::size_t>(std::int64_t{v} - centre_v + reach)] / (down.sum * across.sum);
    for (std::size_t c = 0; c < pixels.channels; ++c) {
      float* onto = pixels.grey.data() + c * pixels.plane + pixels.index(0, v);
      const float light = row * spot.grey[c];
      for (int u = first_u; u < end_u; ++u) onto[u] += light * across.share[static_cast<std::size_t>(std::int64_t{u} - centre_u + reach)];
    }
  }
}

// Blocks of cells, then bands of rows: each pixel gets its light in the order of the cells, whatever the number of threads.
void Particles::stamp(double time_s, const Shader& shader, PixelStore& pixels, WorkerPool& pool) const {
  if (cells_.empty()) return;
  constexpr int rows_a_band = 32;
  const std::size_t blocks = (cells_.size() + cells_a_block - 1) / cells_a_block;
  std::vector<std::vector<Spot>> found(blocks);
  pool.run(static_cast<int>(blocks), [&](int block) {
    const std::size_t first = static_cast<std::size_t>(block) * cells_a_block;
    const std::span<const Cell> cells = std::span(cells_).subspan(first, std::min(cells_a_block, cells_.size() - first));
    found[static_cast<std::size_t>(block)] = spots(cells, time_s, shader, pixels);
  });
  pool.run((pixels.height + rows_a_band - 1) / rows_a_band, [&](int band) {
    const int first = band * rows_a_band, end = std::min(first + rows_a_band, pixels.height);
    for (const std::vector<Spot>& spots_of_block : found) {
      for (const Spot& spot : spots_of_block) {
        if (spot.last_row() >= first && spot.first_row() < end) show(spot, first, end, pixels);
      }
    }
  });
}

}  // namespace lf::optics
