#include "host_sim/app/peak_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lf::app {
namespace {

double share(std::uint64_t part, std::uint64_t all) {
  return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : std::numeric_limits<double>::quiet_NaN();
}

const TruePiece* brightest_looked_for(const std::vector<TruePiece>& pieces) {
  const TruePiece* brightest = nullptr;
  for (const TruePiece& piece : pieces) {
    if (!piece.on_another && !piece.part && (brightest == nullptr || piece.grey > brightest->grey)) brightest = &piece;
  }
  return brightest;
}

}  // namespace

double PeakScore::Squares::rms() const {
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : std::numeric_limits<double>::quiet_NaN();
}

const TruePiece* PeakScore::nearest(const std::vector<TruePiece>& pieces, double v) {
  const TruePiece* nearest = nullptr;
  double another_px = match_px;
  for (const TruePiece& piece : pieces) {
    const double apart_px = std::abs(v - double(piece.v));
    if (apart_px > match_px) continue;
    if (piece.on_another) {
      another_px = std::min(another_px, apart_px);
      continue;
    }
    // A part has no centre to err from: it takes no peak from a whole piece.
    const bool better = nearest == nullptr || (piece.part != nearest->part ? nearest->part : apart_px <= std::abs(v - double(nearest->v)));
    if (better) nearest = &piece;
  }
  // Nor does it excuse a peak on something that is not looked for.
  const bool is_of_another = nearest != nullptr && nearest->part && another_px < std::abs(v - double(nearest->v));
  return is_of_another ? nullptr : nearest;
}

bool PeakScore::of_a_piece_beside(const StripeTruth& truth, std::size_t column, double v) const {
  float own_grey = 0;
  for (const TruePiece& piece : truth.columns[column]) {
    if (!piece.part) return false;
    own_grey = std::max(own_grey, piece.grey);
  }
  const auto from = static_cast<std::int64_t>(column) - beside_px, to = static_cast<std::int64_t>(column) + beside_px;
  for (std::int64_t u = std::max<std::int64_t>(from, 0); u <= std::min<std::int64_t>(to, std::ssize(truth.columns) - 1); ++u) {
    const TruePiece* beside = nearest(truth.columns[static_cast<std::size_t>(u)], v);
    if (beside == nullptr) continue;
    const auto away = static_cast<std::size_t>(std::abs(u - static_cast<std::int64_t>(column)));
    if (own_grey == 0 || (!beside->part && light_beside[away] * beside->grey > own_grey)) return true;
  }
  return false;
}

void PeakScore::count_matched(const TruePiece& piece, double error_px) {
  matched_.add(error_px * error_px);
  if (!piece.on_smooth) return;
  smooth_.add(error_px * error_px);
  const double height = double(piece.grey);
  if (!(piece.sigma_px > 0) || height < clear_sigmas * std::sqrt(noise_.difference_variance(double(piece.background)))) return;
  if (piece.near_mark) {
    marks_.add(error_px * error_px);
    return;
  }
  clear_.add(error_px * error_px);
  bound_.add(noise_.centre_variance_px2(piece));
}

void PeakScore::add(const StripeTruth& truth, std::span<const Eigen::Vector2f> peaks) {
  const std::size_t width = truth.columns.size();
  std::vector<const TruePiece*> brightest(width);
  std::transform(truth.columns.begin(), truth.columns.end(), brightest.begin(), brightest_looked_for);
  std::vector<bool> brightest_found(width), other_found(width);
  for (const Eigen::Vector2f& peak : peaks) {
    const auto column = static_cast<std::size_t>(std::lround(peak.x()));
    if (column >= width) continue;
    ++peaks_;
    const double v = double(peak.y());
    const TruePiece* piece = nearest(truth.columns[column], v);
    if (piece == nullptr) {
      if (!of_a_piece_beside(truth, column, v)) ++false_;
      continue;
    }
    if (piece->part) continue;
    (std::abs(v - double(brightest[column]->v)) <= match_px ? brightest_found : other_found)[column] = true;
    count_matched(*piece, v - double(piece->v));
  }
  for (std::size_t u = 0; u < width; ++u) {
    if (brightest[u] == nullptr || !(brightest[u]->grey >= visible_grey)) continue;
    ++visible_;
    found_ += brightest_found[u] ? 1 : 0;
    elsewhere_ += !brightest_found[u] && other_found[u] ? 1 : 0;
  }
}

double PeakScore::rms_px() const { return matched_.rms(); }

double PeakScore::smooth_rms_px() const { return smooth_.rms(); }

double PeakScore::clear_rms_px() const { return clear_.rms(); }

double PeakScore::clear_bound_px() const { return bound_.rms(); }

double PeakScore::marks_rms_px() const { return marks_.rms(); }

double PeakScore::recall() const { return share(found_, visible_); }

double PeakScore::false_share() const { return share(false_, peaks_); }

double PeakScore::elsewhere_share() const { return share(elsewhere_, visible_); }

}  // namespace lf::app
