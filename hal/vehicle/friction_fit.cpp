#include "hal/vehicle/friction_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lf::hal {
namespace {

constexpr int unknowns = 5;  // the load's parabola, Coulomb, viscous
constexpr int rounds = 6;
constexpr int least_in_a_part = 3;
constexpr std::size_t least_parts = 8;  // of each pass

using Row = Eigen::Matrix<double, unknowns, 1>;

double load_at(const Row& x, double place) { return x[0] + place * (x[1] + place * x[2]); }

}  // namespace

void FrictionFit::add(std::size_t pass, double place, double speed, double torque) {
  if (pass >= passes || !(place >= 0 && place < 1) || !std::isfinite(speed) || !std::isfinite(torque)) return;
  Part& part = sums_[pass][static_cast<std::size_t>(place * parts)];
  ++part.count;
  part.place += place;
  part.speed += speed;
  part.torque += torque;
}

FoundFriction FrictionFit::solve(double efficiency, double back_efficiency) const {
  for (const auto& pass : sums_) {
    const auto full = std::count_if(pass.begin(), pass.end(), [](const Part& part) { return part.count >= least_in_a_part; });
    if (static_cast<std::size_t>(full) < least_parts) return {};
  }
  Row x = Row::Zero();
  double square = 0;
  int rows = 0;
  for (int round = 0; round < rounds; ++round) {
    Eigen::Matrix<double, unknowns, unknowns> normal = Eigen::Matrix<double, unknowns, unknowns>::Zero();
    Row right = Row::Zero();
    const auto each = [&](const auto& use) {
      for (const auto& pass : sums_) {
        for (const Part& part : pass) {
          if (part.count < least_in_a_part) continue;
          const double place = part.place / part.count, speed = part.speed / part.count, torque = part.torque / part.count;
          const double way = speed >= 0 ? 1 : -1;
          const double gain = round == 0 ? 1 : way * load_at(x, place) > 0 ? 1 / efficiency : std::max(0.0, back_efficiency);
          const Row row(Row{{gain, gain * place, gain * place * place, way, speed}});
          use(row, torque);
        }
      }
    };
    each([&](const Row& row, double torque) {
      normal += row * row.transpose();
      right += row * torque;
    });
    const Row next = normal.ldlt().solve(right);
    square = 0;
    rows = 0;
    each([&](const Row& row, double torque) {
      square += std::pow(torque - row.dot(next), 2);
      ++rows;
    });
    x = next;
  }
  FoundFriction found{true, x[3], x[4], std::sqrt(square / std::max(1, rows - unknowns))};
  found.valid = std::isfinite(found.coulomb) && std::isfinite(found.viscous) && found.coulomb >= 0 && found.viscous >= 0;
  return found;
}

}  // namespace lf::hal
