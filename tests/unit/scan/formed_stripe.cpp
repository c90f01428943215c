#include "tests/unit/scan/formed_stripe.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace lf::test {
namespace {

constexpr int samples = 4;  // a pixel, each way

// Light that has scattered once, as the camera sees it: isotropic Gaussians and their shares, from Petzold's mean phase function for particles in the
// single-scattering kernel of Wells (1977). Pixels of 2.77 mrad. The core adds to the direct light; the rest of the shares is turned back.
struct Scattered {
  double sigma_px, share;
};
constexpr double core_share = 0.136;
constexpr std::array<Scattered, 4> mixture{{{2, 0.199}, {8, 0.248}, {32, 0.275}, {128, 0.118}}};

struct Plane {
  int width = 0, height = 0;
  std::vector<double> values;

  Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  double& at(int u, int v) { return values[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)]; }
  double at(int u, int v) const { return const_cast<Plane*>(this)->at(u, v); }
};

// A Gaussian's integrals over cells of 1, out to four sigmas; they add up to 1.
std::vector<double> kernel(double sigma) {
  const int reach = std::max(1, static_cast<int>(std::ceil(4 * sigma)));
  std::vector<double> taps;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    taps.push_back(std::erf((i + 0.5) / sigma / std::sqrt(2.0)) - std::erf((i - 0.5) / sigma / std::sqrt(2.0)));
    sum += taps.back();
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

// Beyond its borders the picture goes on as it ends.
Plane blurred(const Plane& in, double sigma) {
  const std::vector<double> taps = kernel(sigma);
  const int reach = static_cast<int>(taps.size()) / 2;
  Plane down(in.width, in.height), out(in.width, in.height);
  for (int v = 0; v < in.height; ++v) {
    for (int i = -reach; i <= reach; ++i) {
      const int from = std::clamp(v + i, 0, in.height - 1);
      const double tap = taps[static_cast<std::size_t>(i + reach)];
      const double* above = in.values.data() + static_cast<std::ptrdiff_t>(from) * in.width;
      double* row = &down.at(0, v);
      for (int u = 0; u < in.width; ++u) row[u] += tap * above[u];
    }
  }
  std::vector<double> line(static_cast<std::size_t>(in.width + 2 * reach));
  for (int v = 0; v < in.height; ++v) {
    for (int i = 0; i < in.width + 2 * reach; ++i) line[static_cast<std::size_t>(i)] = down.at(std::clamp(i - reach, 0, in.width - 1), v);
    double* row = &out.at(0, v);
    for (std::size_t i = 0; i < taps.size(); ++i) {
      const double tap = taps[i];
      const double* from = line.data() + i;
      for (int u = 0; u < in.width; ++u) row[u] += tap * from[u];
    }
  }
  return out;
}

Plane summed_by_pixels(const Plane& fine) {
  Plane out(fine.width / samples, fine.height / samples);
  for (int v = 0; v < fine.height; ++v) {
    for (int u = 0; u < fine.width; ++u) out.at(u / samples, v / samples) += fine.at(u, v) / (samples * samples);
  }
  return out;
}

bool is_light(const Bars& bars, double u, double v) {
  const double behind = (u * std::sin(bars.angle_rad) + v * std::cos(bars.angle_rad) - bars.phase_px) / bars.width_px;
  if (bars.single_edge) return behind < 0;
  return std::fmod(std::abs(std::floor(behind)), 2.0) != 0.0;
}

double paint(const Bars& bars, double u, double v) { return bars.contrast == 1 || is_light(bars, u, v) ? 1 : 1 / bars.contrast; }

// The mean of nine points of a sample of a quarter of a pixel.
double paint_of_sample(const Bars& bars, double u, double v) {
  if (bars.contrast == 1) return 1;
  double sum = 0;
  for (const double du : {-1.0, 0.0, 1.0}) {
    for (const double dv : {-1.0, 0.0, 1.0}) sum += paint(bars, u + du / (3 * samples), v + dv / (3 * samples));
  }
  return sum / 9;
}

// Across the sheet, over the peak in clear water. The mixture seen from the emitter is the same, and one-dimensional.
double beam(const FormedStripe& s, double across_px) {
  const auto bell = [&](double sigma) { return s.beam_sigma_px / sigma * std::exp(-0.5 * across_px * across_px / (sigma * sigma)); };
  double light = (1 + core_share * s.scatter_to_panel) * bell(s.beam_sigma_px);
  for (const Scattered& part : mixture) light += s.scatter_to_panel * part.share * bell(std::hypot(s.beam_sigma_px, part.sigma_px));
  return light;
}

double row_of(const FormedStripe& s, double u) { return s.middle_px + s.slope * u; }

// What leaves the surface, to what meets the sensor.
Plane seen(const Plane& radiance, const FormedStripe& s) {
  const Plane direct = summed_by_pixels(blurred(radiance, samples * s.lens_sigma_px));
  if (s.scatter_to_camera == 0) return direct;
  const Plane pixels = summed_by_pixels(radiance);
  Plane all = direct;
  for (double& value : all.values) value *= 1 + core_share * s.scatter_to_camera;
  for (const Scattered& part : mixture) {
    const Plane skirt = blurred(pixels, std::hypot(part.sigma_px, s.lens_sigma_px));
    for (std::size_t i = 0; i < all.values.size(); ++i) all.values[i] += s.scatter_to_camera * part.share * skirt.values[i];
  }
  return all;
}

double distance_to_edge(const Bars& bars, double u, double v) {
  if (bars.contrast == 1) return 1e9;
  constexpr double step = 0.05, farthest = 40;
  const bool here = is_light(bars, u, v);
  for (double d = step; d < farthest; d += step) {
    if (is_light(bars, u, v + d) != here || is_light(bars, u, v - d) != here) return d;
  }
  return 1e9;
}

}  // namespace

FormedImage form(const FormedStripe& s) {
  Plane laser(s.width * samples, s.height * samples), day(laser.width, laser.height);
  for (int v = 0; v < laser.height; ++v) {
    for (int u = 0; u < laser.width; ++u) {
      const double x = (u + 0.5) / samples - 0.5, y = (v + 0.5) / samples - 0.5;
      const double albedo = paint_of_sample(s.bars, x, y);
      laser.at(u, v) = albedo * s.peak_grey * beam(s, y - row_of(s, x));
      day.at(u, v) = albedo * s.ambient_grey;
    }
  }
  const Plane stripe = seen(laser, s), still = seen(day, s);

  std::mt19937_64 random(s.seed);
  std::normal_distribution<double> normal;
  const double grains = s.speckle > 0 ? 1 / (s.speckle * s.speckle) : 1;
  std::gamma_distribution<double> grain(grains, 1 / grains);
  const double full_scale = std::exp2(s.bits) - 1;
  const auto sensor = [&](double grey) {
    if (!s.noise) return grey;
    const double electrons = grey * s.electrons_per_grey;
    const double counted = (electrons + std::sqrt(std::max(0.0, electrons)) * normal(random)) / s.electrons_per_grey;
    return std::clamp(std::round(counted + s.read_noise_grey * normal(random)), 0.0, full_scale);
  };
  FormedImage image{s.width, s.height, {}, {}, {}, {}};
  for (std::size_t i = 0; i < stripe.values.size(); ++i) {
    const double speckled = stripe.values[i] * (s.noise && s.speckle > 0 ? grain(random) : 1);
    image.on.push_back(sensor(speckled + still.values[i]));
    image.off.push_back(sensor(still.values[i]));
  }
  for (int u = 0; u < s.width; ++u) {
    image.centre_px.push_back(row_of(s, u));
    image.to_edge_px.push_back(distance_to_edge(s.bars, u, row_of(s, u)));
  }
  return image;
}

double width_px(const FormedStripe& s) {
  return std::sqrt(s.beam_sigma_px * s.beam_sigma_px + s.lens_sigma_px * s.lens_sigma_px + 1.0 / 12);
}

double bound_px(const FormedStripe& s, bool with_off) {
  const double sigma = width_px(s), peak = s.peak_grey * s.beam_sigma_px / sigma, pictures = with_off ? 2 : 1;
  double information = 0;
  for (int v = -40; v <= 40; ++v) {
    const double light = peak * std::exp(-0.5 * v * v / (sigma * sigma)), slope = light * v / (sigma * sigma);
    const double read = s.read_noise_grey * s.read_noise_grey + 1.0 / 12;
    information += slope * slope / (pictures * read + (light + pictures * s.ambient_grey) / s.electrons_per_grey);
  }
  return std::sqrt(s.speckle * s.speckle * sigma / (4 * std::sqrt(std::numbers::pi)) + 1 / information);
}

void over_edges(FormedStripe stripe, int step_deg, const VisitEdges& visit) {
  constexpr int border = 12;  // columns, where the picture's end is in the blur
  for (int angle = 0; angle <= 90; angle += step_deg) {
    for (int seed = 1; seed <= 2; ++seed) {
      stripe.bars.angle_rad = angle * std::numbers::pi / 180;
      stripe.bars.phase_px = 3.3 * seed;
      stripe.seed = static_cast<std::uint64_t>(100 * seed + angle);
      const FormedImage image = form(stripe);
      std::vector<int> columns;
      for (int u = border; u < image.width - border; ++u) {
        if (image.to_edge_px[static_cast<std::size_t>(u)] <= 2.5 * width_px(stripe)) columns.push_back(u);
      }
      visit(stripe, image, columns);
    }
  }
}

}  // namespace lf::test
