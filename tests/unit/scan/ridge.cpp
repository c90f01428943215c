#include "tests/unit/scan/ridge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace lf::test {
namespace {

// The paper asks for a place inside the pixel. The Taylor series overshoots by a few hundredths half a pixel away, so that a line midway between two pixels would be in neither.
constexpr double inside_px = 0.6;

struct Plane {
  int width = 0, height = 0;
  std::vector<double> values;
  double& at(int u, int v) { return values[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)]; }
  double at(int u, int v) const { return const_cast<Plane*>(this)->at(u, v); }
};

// Integrals over pixels of a Gaussian's derivative of order 0, 1 or 2, as the paper's section 3.1 has it.
std::vector<double> taps_of(double sigma, int order) {
  const auto bell = [&](double x) { return std::exp(-0.5 * x * x / (sigma * sigma)) / (sigma * std::sqrt(2 * std::numbers::pi)); };
  const auto primitive = [&](double x) {
    if (order == 0) return 0.5 * std::erf(x / (sigma * std::sqrt(2.0)));
    return order == 1 ? bell(x) : -x / (sigma * sigma) * bell(x);
  };
  const int reach = static_cast<int>(std::ceil(4.5 * sigma));
  std::vector<double> taps;
  for (int i = -reach; i <= reach; ++i) taps.push_back(primitive(i + 0.5) - primitive(i - 0.5));
  return taps;
}

// A convolution: the tap of place i meets the pixel at -i. Beyond its borders the picture goes on as it ends.

Plane along_columns(const Plane& in, const std::vector<double>& taps) {
  const int reach = static_cast<int>(taps.size()) / 2;
  Plane out{in.width, in.height, std::vector<double>(in.values.size())};
  for (int v = 0; v < in.height; ++v) {
    for (int i = -reach; i <= reach; ++i) {
      const double tap = taps[static_cast<std::size_t>(i + reach)];
      const int row = std::clamp(v - i, 0, in.height - 1);
      for (int u = 0; u < in.width; ++u) out.at(u, v) += tap * in.at(u, row);
    }
  }
  return out;
}

Plane along_rows(const Plane& in, const std::vector<double>& taps) {
  const int reach = static_cast<int>(taps.size()) / 2;
  Plane out{in.width, in.height, std::vector<double>(in.values.size())};
  std::vector<double> row(static_cast<std::size_t>(in.width + 2 * reach));
  for (int v = 0; v < in.height; ++v) {
    for (int u = -reach; u < in.width + reach; ++u) row[static_cast<std::size_t>(u + reach)] = in.at(std::clamp(u, 0, in.width - 1), v);
    for (int i = -reach; i <= reach; ++i) {
      const double tap = taps[static_cast<std::size_t>(i + reach)];
      const double* from = row.data() + reach - i;
      for (int u = 0; u < in.width; ++u) out.at(u, v) += tap * from[u];
    }
  }
  return out;
}

struct Derivatives {
  Plane x, y, xx, xy, yy;
};

Derivatives derivatives_of(const Plane& picture, double sigma) {
  const std::vector<double> g0 = taps_of(sigma, 0), g1 = taps_of(sigma, 1), g2 = taps_of(sigma, 2);
  const Plane y0 = along_columns(picture, g0), y1 = along_columns(picture, g1), y2 = along_columns(picture, g2);
  return {along_rows(y0, g1), along_rows(y1, g0), along_rows(y0, g2), along_rows(y1, g1), along_rows(y2, g0)};
}

struct Normal {
  double x = 0, y = 1, second_derivative = 0;
};

// The Hessian's eigenvector of the eigenvalue that is largest in size.
Normal normal_of(double xx, double xy, double yy) {
  const double mean = 0.5 * (xx + yy), half = 0.5 * std::hypot(xx - yy, 2 * xy);
  const double eigenvalue = mean < 0 ? mean - half : mean + half;
  // Of two rows of (H - eigenvalue) the longer one, turned by 90 degrees.
  const double ax = xx - eigenvalue, by = yy - eigenvalue;
  double x = -xy, y = ax;
  if (std::abs(by) > std::abs(ax)) x = by, y = -xy;
  const double length = std::hypot(x, y);
  return length > 0 ? Normal{x / length, y / length, eigenvalue} : Normal{0, 1, eigenvalue};
}

}  // namespace

double ridge_sigma_px(double stripe_sigma_px) {
  const double half_width = std::sqrt(3.0) * stripe_sigma_px;
  return half_width / std::sqrt(3.0);
}

std::vector<double> ridge_rows(const FormedImage& image, double sigma_px) {
  Plane picture{image.width, image.height, {}};
  for (std::size_t i = 0; i < image.on.size(); ++i) picture.values.push_back(image.on[i] - image.off[i]);
  const Derivatives r = derivatives_of(picture, sigma_px);
  std::vector<double> rows(static_cast<std::size_t>(image.width), std::numeric_limits<double>::quiet_NaN());
  for (int u = 0; u < image.width; ++u) {
    double strongest = 0;
    for (int v = 0; v < image.height; ++v) {
      const Normal n = normal_of(r.xx.at(u, v), r.xy.at(u, v), r.yy.at(u, v));
      if (-n.second_derivative <= strongest) continue;  // of a bright line it is negative
      const double t = -(r.x.at(u, v) * n.x + r.y.at(u, v) * n.y) / n.second_derivative;
      // A line along the columns has no row here.
      if (std::abs(t * n.x) > inside_px || std::abs(t * n.y) > inside_px || std::abs(n.y) < 0.1) continue;
      strongest = -n.second_derivative;
      rows[static_cast<std::size_t>(u)] = v + t / n.y;  // from (t n.x, t n.y) along (-n.y, n.x) to the column's middle
    }
  }
  return rows;
}

}  // namespace lf::test
