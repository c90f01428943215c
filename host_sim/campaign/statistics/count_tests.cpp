#include "host_sim/campaign/statistics/count_tests.hpp"

#include <algorithm>
#include <cmath>

namespace lf::campaign {
namespace {

double log_choose(std::size_t n, std::size_t k) {
  const auto log_factorial = [](std::size_t m) { return std::lgamma(static_cast<double>(m) + 1); };
  return log_factorial(n) - log_factorial(k) - log_factorial(n - k);
}

}  // namespace

double fisher(std::size_t hits_a, std::size_t of_a, std::size_t hits_b, std::size_t of_b) {
  const std::size_t hits = hits_a + hits_b, all = of_a + of_b;
  const double log_all = log_choose(all, hits);
  const auto probability = [&](std::size_t a) { return std::exp(log_choose(of_a, a) + log_choose(of_b, hits - a) - log_all); };
  // Tables that are as probable as this one differ from it by rounding.
  constexpr double as_probable = 1 + 1e-7;
  const double most = probability(hits_a) * as_probable;
  double p = 0;
  for (std::size_t a = hits > of_b ? hits - of_b : 0; a <= std::min(hits, of_a); ++a) {
    if (const double each = probability(a); each <= most) p += each;
  }
  return std::min(1.0, p);
}

double mcnemar(std::size_t gained, std::size_t lost) {
  return std::min(1.0, 2 * mcnemar_rise(std::min(gained, lost), std::max(gained, lost)));
}

double fisher_rise(std::size_t hits_a, std::size_t of_a, std::size_t hits_b, std::size_t of_b) {
  const std::size_t hits = hits_a + hits_b;
  const double log_all = log_choose(of_a + of_b, hits);
  double p = 0;
  for (std::size_t b = hits_b; b <= std::min(hits, of_b); ++b) {
    if (hits - b <= of_a) p += std::exp(log_choose(of_a, hits - b) + log_choose(of_b, b) - log_all);
  }
  return std::min(1.0, p);
}

double mcnemar_rise(std::size_t gained, std::size_t lost) {
  const std::size_t n = gained + lost;
  double tail = 0;
  for (std::size_t k = 0; k <= gained; ++k) tail += std::exp(log_choose(n, k) - static_cast<double>(n) * std::log(2.0));
  return std::min(1.0, tail);
}

}  // namespace lf::campaign
