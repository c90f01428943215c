// How wide the stripe and the lens' blur are and how hazy the water, as the pictures themselves tell: what makes the fitted columns likeliest.
//
// Plain columns tell the stripe's width and its skew in the picture. Columns at the paint's edges tell how much of the width is the lens', and how much haze lies on dark paint.
// Each picture moves the estimate by a step of Newton's on the squares that the fits of some of its columns leave, against what the pictures before have told.
#pragma once

#include "firmware/scan/stripe_fit.hpp"

namespace lf::scan {

class OpticsEstimate {
 public:
  explicit OpticsEstimate(const StripeOptics& first);

  const StripeOptics& optics() const { return optics_; }
  // Standard deviation of the skew that the columns' noise leaves. Before a picture has told of it: that of the skews that there are.
  float skew_doubt() const;

  // Columns that were fitted with `optics()`. Those that fit badly are left out: another stripe, a silhouette.
  void add(const StripeWindows& windows, const PixelNoise& noise, const StripeFits& fits);

  // Moves the estimate by what was added since the last call. Returns the largest change: of the widths relative, of scatter and skew as they are. 0 where nothing was added.
  float update();

  // Ends a picture. However often the estimate was updated by it, it has told of the skew once.
  void end_picture();

 private:
  // Of a width's logarithm, of the scatter or of the skew.
  struct Newton {
    float slope = 0, curvature = 0;  // of the squares that are left, of the columns added since the last update
    float known = 0;                 // curvature that earlier pictures have left
    float least = 0;                 // that `known` keeps, whatever is forgotten

    // The squares that are left a probe below the estimate, at it and above it.
    void add(float below, float here, float above, float probe);
    // Moves nothing, and forgets nothing, where nothing was added.
    float step(float longest, float remembered);
    void drop() { slope = curvature = 0; }
  };

  void add_shape(const StripeWindows& about, const PixelNoise& noise, LaneMask among);
  void add_lens(const StripeWindows& about, const PixelNoise& noise, LaneMask among);

  StripeOptics optics_;
  Newton stripe_, lens_, scatter_, skew_;
  float told_ = 0, newest_ = 0;          // curvature of the skew: by all pictures, and by the newest update
  std::int32_t fitted_ = 0, plain_ = 0;  // columns since the last update that add_shape took, and those of them that tell of the skew
};

}  // namespace lf::scan
