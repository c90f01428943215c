// Detector and refiner together: the detector's window follows the width that the refiner finds.
#pragma once

#include <cstddef>
#include <span>

#include "firmware/scan/peak_refiner.hpp"
#include "firmware/scan/peaks.hpp"

namespace lf::scan {

// After a picture's peaks were refined: the next picture is searched by the width that is known now. Returns whether this one should be searched again, since nothing was known of the
// width and another window suits it better: at most once after each `begin_anew`.
template <class Detector, class Refiner>
bool follow_width(Detector& detector, const Refiner& refiner) {
  const bool first = detector.followed_px() == 0;
  const float width_px = refiner.begun() ? width_in_picture_px(refiner.optics()) : 0;
  detector.follow(width_px);
  return first && width_px > 0 && Detector::rows_as_one_for(width_px) != detector.rows_as_one();
}

// The stripe in `image` less `background`. Writes at most the detector's peaks a line to `peaks`, as detector and refiner do one after the other, and returns their number.
template <class Detector, class Refiner, class View>
std::size_t find_stripe(Detector& detector, Refiner& refiner, const View& image, const View& background, std::span<Peak> peaks) {
  std::size_t count = refiner.refine(image, background, peaks.first(detector.detect(image, background, peaks)));
  if (follow_width(detector, refiner)) count = refiner.refine(image, background, peaks.first(detector.detect(image, background, peaks)));
  return count;
}

}  // namespace lf::scan
