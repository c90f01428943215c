// Specks that drift in the water before a camera: marine snow, sand.
//
// Each cell of 5 cm of a grid that moves with the water has its own specks, drawn from the cell's number. Their sizes follow the power law of the sea, a number per
// size of d^-3 (Jackson et al., Deep-Sea Res. 44, 1997). A speck is a grey disc of albedo 0.1 to 0.5, lit by lasers, lamps and daylight, seen as a Gaussian of its
// own size and the lens's defocus at its distance. A speck is a few grey levels bright, a large one in the sheet as bright as the stripe.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/optics/pixel_store.hpp"
#include "host_sim/optics/shader.hpp"
#include "host_sim/optics/worker_pool.hpp"

namespace lf::optics {

class Particles {
 public:
  static constexpr double least_m = 0.0005;  // diameter
  static constexpr double most_m = 0.008;
  static constexpr double cell_m = 0.05;
  static constexpr double near_m = 0.10, far_m = 1.0;  // from the camera, along its axis

  // Those that `camera`, which outlives this, can see.
  Particles(const Camera& camera, const WaterConfig& water, std::uint64_t seed);

  // Adds their light to the grey of `pixels`, whose surfaces hide what is behind them. `time_s`: how long the water has drifted. What adds less than a
  // tenth of a grey level to any pixel is left out.
  void stamp(double time_s, const Shader& shader, PixelStore& pixels, WorkerPool& pool) const;

  // One of them, in the base frame.
  struct Speck {
    Vec3 place_m = Vec3::Zero();
    double diameter_m = 0;
    double albedo = 0;
  };
  std::vector<Speck> at(double time_s) const;

  // Those that stand in a sheet's beam, or beside it by less than their size; of the cells that the camera sees. Base frame.
  std::vector<SheetLight::Speck> in_sheet(double time_s, const SheetLight& sheet, WorkerPool& pool) const;

 private:
  using Cell = std::array<std::int32_t, 3>;
  // A speck's image.
  struct Spot {
    Vec2 centre_px = Vec2::Zero();
    float sigma_px = 0;
    std::array<float, 3> grey{};  // all of it, by channel
    int reach_px() const;
    int first_row() const;
    int last_row() const;
  };
  // Eight specks side by side, in the camera frame, and what they look like.
  struct PlacesInView {
    Lanes3 place_m;
    Lanes diameter_m{}, albedo{};
  };
  struct Looks {
    Lanes sigma_px{};
    GreyLanes grey{};
    LaneMask seen{};  // bright enough
  };
  // A spot's shares along one axis, not yet of unit sum.
  struct Bell {
    std::vector<float> share;
    float sum = 0;
  };
  void draw_specks(const Cell& cell, const Vec3& drift, std::vector<Speck>& specks) const;
  // Those of `cells` before the camera; place_m in its frame.
  std::vector<Speck> in_view(std::span<const Cell> cells, double time_s) const;
  std::vector<Spot> spots(std::span<const Cell> cells, double time_s, const Shader& shader, const PixelStore& pixels) const;
  Looks looks(const PlacesInView& specks, const RgbLanes& irradiance, const Shader& shader) const;
  std::optional<Vec2> image_of(const Vec3& place_m, const PixelStore& pixels) const;  // in the camera frame
  // Of whole pixels, `reach` of them to either side of `middle`.
  static Bell bell(int middle, double centre, float sigma_px, int reach);
  static void show(const Spot& spot, int first_row, int end_row, PixelStore& pixels);

  const Camera& camera_;
  Pose camera_from_base_;
  double tan_u_, tan_v_;              // of the view's edges, and some
  double per_cell_, none_in_a_cell_;  // specks of it on average, and how likely it has none
  Vec3 current_m_s_;
  std::uint64_t seed_;
  std::vector<Cell> cells_;  // that reach into the view, whatever part of a cell's size the grid has drifted
};

}  // namespace lf::optics
