#include "tests/unit/scan/stripe_estimators.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace lf::test {
namespace {

// The place within `reach` of `start` where `response` is largest: to a tenth of a row, then by a parabola.
double largest(double start, double reach, const std::function<double(double)>& response) {
  constexpr double step = 0.1;
  double best = start, highest = response(start);
  for (double v = start - reach; v <= start + reach; v += step) {
    if (const double r = response(v); r > highest) highest = r, best = v;
  }
  const double before = response(best - step), after = response(best + step), curvature = before - 2 * highest + after;
  return curvature < 0 ? best + step * std::clamp(0.5 * (before - after) / curvature, -1.0, 1.0) : best;
}

}  // namespace

double centre_of_mass(const FormedImage& image, int u, int middle, int half) {
  double weight = 0, moment = 0;
  for (int v = std::max(0, middle - half); v <= std::min(image.height - 1, middle + half); ++v) {
    weight += image.stripe(u, v);
    moment += image.stripe(u, v) * (v - middle);
  }
  return middle + moment / weight;
}

int log_row(const FormedImage& image, int u, double sigma_px) {
  const int reach = static_cast<int>(std::ceil(5 * sigma_px));
  std::vector<double> taps;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    const double z = i / sigma_px;
    taps.push_back((1 - z * z) * std::exp(-0.5 * z * z));
    sum += taps.back();
  }
  for (double& tap : taps) tap -= sum / static_cast<double>(taps.size());
  int best = reach;
  double highest = -1e300;
  for (int v = reach; v < image.height - reach; ++v) {
    double response = 0;
    for (int i = -reach; i <= reach; ++i) response += taps[static_cast<std::size_t>(i + reach)] * image.stripe(u, v + i);
    if (response > highest) highest = response, best = v;
  }
  return best;
}

double log_centre(const FormedImage& image, int u, double start, double sigma_px) {
  return largest(start, 1.5 * sigma_px, [&](double centre) {
    double sum = 0;
    for (int v = static_cast<int>(centre - 5 * sigma_px); v <= static_cast<int>(centre + 5 * sigma_px) + 1; ++v) {
      if (v < 0 || v >= image.height) continue;
      const double z = (v - centre) / sigma_px;
      sum += image.stripe(u, v) * (1 - z * z) * std::exp(-0.5 * z * z);
    }
    return sum;
  });
}

double product_centre(const FormedImage& image, int u, double start, double sigma_px) {
  const int middle = static_cast<int>(std::lround(start)), half = static_cast<int>(std::ceil(2.5 * sigma_px + 2));
  return largest(start, 2 * sigma_px, [&](double centre) {
    double with_itself = 0, with_data = 0;
    for (int v = std::max(0, middle - half); v <= std::min(image.height - 1, middle + half); ++v) {
      const double off = std::max(1.0, image.at(image.off, u, v)), stripe = image.stripe(u, v);
      const double model = off * std::exp(-0.5 * std::pow((v - centre) / sigma_px, 2));
      const double lit = std::max(0.0, stripe);
      const double variance = 2 * 1.5 * 1.5 + (2 * off + lit) / 40 + 1.0 / 6 + lit * lit / (off * off) * (1.5 * 1.5 + off / 40 + 1.0 / 12);
      with_itself += model * model / variance;
      with_data += model * stripe / variance;
    }
    return with_data > 0 ? with_data * with_data / with_itself : 0;
  });
}

}  // namespace lf::test
