// Peaks that the core found against the stripe as it was rendered.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host_sim/app/stripe_truth.hpp"

namespace lf::app {

class PeakScore {
 public:
  // A column counts as seen when the stripe stands at least so high over the background; less is under three times the worst noise of 3 grey levels.
  static constexpr float visible_grey = 10.0f;
  // Farther off than this from each piece of the stripe a peak is another thing.
  static constexpr double match_px = 2.0;
  // A lens lays a piece's light into the columns beside it. A peak there is of that piece, where its own column has no stripe, or only a flank that is fainter than
  // that light.
  static constexpr std::int32_t beside_px = 2;
  // Of a stripe's light, so many columns beyond its end: of a lens of 0.9 px, with the pixel's aperture.
  static constexpr std::array<float, beside_px + 1> light_beside{1, 0.3f, 0.05f};
  // The bound is compared with peaks that stand so many standard deviations of the difference's noise over it.
  static constexpr double clear_sigmas = 5.0;

  PeakScore() = default;
  explicit PeakScore(const PictureNoise& noise) : noise_(noise) {}

  // `peaks`: their u and v, px.
  void add(const StripeTruth& truth, std::span<const Eigen::Vector2f> peaks);
  double rms_px() const;  // of peaks on a piece of their column; NaN without any
  // Of matched peaks on smooth surfaces. NaN without any, or without depth in the truth.
  double smooth_rms_px() const;
  // Of those of them that stand clear of the noise, away from marks: their rms, and what the run's optics and noise allow (PictureNoise). NaN without any.
  double clear_rms_px() const;
  double clear_bound_px() const;
  // Of those that stand clear of the noise, near marks: no bound is known there.
  double marks_rms_px() const;
  double recall() const;           // columns whose brightest piece was found, over the visible ones; NaN without any
  double false_share() const;      // peaks on no piece of the stripe, over all peaks; NaN without any
  double elsewhere_share() const;  // visible columns of which another piece was found and the brightest was not; NaN without any
  std::uint64_t visible() const { return visible_; }
  std::uint64_t found() const { return found_; }  // of these, those whose brightest piece was found
  std::uint64_t false_peaks() const { return false_; }

 private:
  struct Squares {
    std::uint64_t count = 0;
    double sum = 0;
    void add(double square) { ++count, sum += square; }
    double rms() const;
  };
  static const TruePiece* nearest(const std::vector<TruePiece>& pieces, double v);
  bool of_a_piece_beside(const StripeTruth& truth, std::size_t column, double v) const;
  void count_matched(const TruePiece& piece, double error_px);

  PictureNoise noise_;
  std::uint64_t visible_ = 0, found_ = 0, elsewhere_ = 0, peaks_ = 0, false_ = 0;
  Squares matched_, smooth_, clear_, bound_, marks_;
};

}  // namespace lf::app
