#include "tests/unit/scan/stripe_image.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace lf::test {

StripeImage make_stripe_image(const StripeModel& m) {
  std::mt19937_64 random(m.seed);
  std::normal_distribution<double> noise(0, m.noise);
  std::uniform_real_distribution<double> shift(-0.5, 0.5);
  StripeImage image{m.width, m.height, {}, {}, {}};
  image.on.resize(static_cast<std::size_t>(m.width) * m.height);
  image.off.resize(image.on.size());
  image.centre_px.resize(m.width);
  for (int u = 0; u < m.width; ++u) image.centre_px[u] = m.height * (0.2 + 0.6 * u / m.width) + shift(random);
  const auto sensor = [&](double grey) { return static_cast<std::uint8_t>(std::clamp(std::round(grey + noise(random)), 0.0, 255.0)); };
  for (int v = 0; v < m.height; ++v) {
    for (int u = 0; u < m.width; ++u) {
      const double d = v - image.centre_px[u], q = m.sigma_px * std::sqrt(2.0);
      const double scene = 30 + m.texture * std::sin(0.7 * v) * std::cos(0.3 * u);
      double stripe = m.sigma_px * std::sqrt(M_PI / 2) * (std::erf((d + 0.5) / q) - std::erf((d - 0.5) / q));
      stripe += m.skirt * std::exp(-0.5 * std::pow((d - 6) / 12, 2));
      stripe += m.step * 0.5 * (1 - std::erf(d / q)) * std::exp(std::min(d, 0.0) / 40);
      image.on[static_cast<std::size_t>(v) * m.width + u] = sensor(scene + m.amplitude * stripe);
      image.off[static_cast<std::size_t>(v) * m.width + u] = sensor(scene);
    }
  }
  return image;
}

}  // namespace lf::test
