#include "tests/unit/scan/peak_table/real_tables.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "tests/unit/scan/peak_table/peak_methods.hpp"
#include "tests/unit/scan/real_stripes.hpp"

namespace lf::test {
namespace {

using AllRows = std::array<Rows, method_names.size()>;

// The others are told the width and the exposure that the fit has found: nobody knows the true ones.
AllRows rows_of(const Picture& on, const Picture& off) {
  Shot shot{{on.width, on.height, {on.pixels.begin(), on.pixels.end()}, {off.pixels.begin(), off.pixels.end()}, {}, {}},
            !off.pixels.empty(),
            255};
  DetectorAndFit ours(255);
  const Rows fitted = ours.rows(shot);
  const std::array<Rows, 4> others = rows_of_others(shot, ours.width_px(), ours.gain());
  return {fitted, others[0], others[1], others[2], others[3]};
}

Points points_of(const Rows& rows) {
  Points points;
  for (std::size_t u = 0; u < rows.size(); ++u) {
    if (!std::isnan(rows[u])) points.emplace_back(static_cast<double>(u), rows[u]);
  }
  return points;
}

struct Count {
  int right = 0, wrong = 0, elsewhere = 0;

  void add(double u, double v, const Columns& truth) {
    const auto row = truth.find(static_cast<std::int32_t>(u));
    if (row == truth.end()) {
      ++elsewhere;
    } else {
      ++(std::abs(v - row->second) <= 1.5 ? right : wrong);
    }
  }
};

}  // namespace

void print_real_pairs() {
  std::array<Count, method_names.size()> counts;
  std::array<double, method_names.size()> scatter_px{};
  for (const auto& [number, truth] : read_reference()) {
    const Pair pair = read_pair(number);
    const AllRows rows = rows_of(pair.on, pair.off);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Points straight;
      for (const auto& [u, v] : points_of(rows[i])) {
        counts[i].add(u, v, truth);
        if (number == 4 && u >= 60 && u <= 317) straight.emplace_back(u, v);
      }
      if (number == 4) scatter_px[i] = scatter_about_polynomial(straight, 3);
    }
  }
  std::printf("\n### Real pairs: 2595 columns with a line, 605 without (tests/data/laser_on_off_pairs)\n\n");
  std::printf("| method | right | wrong | elsewhere | scatter of pair 4, px |\n|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < counts.size(); ++i)
    std::printf("| %s | %d | %d | %d | %.3f |\n", method_names[i], counts[i].right, counts[i].wrong, counts[i].elsewhere, scatter_px[i]);
}

void print_real_weld() {
  const AllRows rows = rows_of(red_of("weld_stripe_speckle/weld2.png"), {});
  std::printf(
      "\n### Real speckle, one picture (tests/data/weld_stripe_speckle): rms about the piece's line, px, and columns within 14 px of "
      "it\n\n| method |");
  for (const Piece& piece : pieces) std::printf(" %s (%d) |", piece.name, piece.last - piece.first + 1);
  std::printf(" in the gap (74) |\n|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Points points = points_of(rows[i]);
    std::printf("| %s |", method_names[i]);
    for (const Piece& piece : pieces) {
      const Points near = on_piece(points, piece);
      std::printf(" %.3f, %zu |", scatter_about_polynomial(near, 1), near.size());
    }
    int in_gap = 0;
    for (const auto& [u, v] : points) in_gap += u >= 741 && u <= 814;
    std::printf(" %d |\n", in_gap);
  }
}

}  // namespace lf::test
