#include "tests/unit/scan/peak_table/peak_methods.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "firmware/scan/peak_refiner.hpp"
#include "firmware/scan/peaks.hpp"
#include "firmware/scan/stripe_finder.hpp"
#include "tests/unit/scan/ridge.hpp"
#include "tests/unit/scan/stripe_estimators.hpp"

namespace lf::test {
namespace {

constexpr double log_sigma_px = 2.83;  // the detector's own filter

Rows no_rows(int width) { return Rows(static_cast<std::size_t>(width), std::numeric_limits<double>::quiet_NaN()); }

template <class Pixel>
std::vector<Pixel> pixels(const std::vector<double>& plane, int full_scale) {
  std::vector<Pixel> out;
  out.reserve(plane.size());
  for (const double grey : plane) out.push_back(static_cast<Pixel>(std::clamp(std::round(grey), 0.0, static_cast<double>(full_scale))));
  return out;
}

// The picture in grey levels of 0 to 255, its off plane as if it had been exposed as the on plane.
FormedImage in_grey(const Shot& shot, double gain) {
  FormedImage image = shot.image;
  const double to_grey = 255.0 / shot.full_scale;
  for (double& grey : image.on) grey = std::min<double>(grey, shot.full_scale) * to_grey;
  for (double& grey : image.off) grey = std::min<double>(grey, shot.full_scale) * to_grey * gain;
  if (shot.has_off) return image;
  image.off.assign(image.on.size(), 0);
  for (int u = 0; u < image.width; ++u) {
    std::vector<double> column;
    column.reserve(static_cast<std::size_t>(image.height));
    for (int v = 0; v < image.height; ++v) column.push_back(image.at(image.on, u, v));
    std::nth_element(column.begin(), column.begin() + image.height / 2, column.end());
    const double median = column[static_cast<std::size_t>(image.height / 2)];
    for (int v = 0; v < image.height; ++v)
      image.off[static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(u)] = median;
  }
  return image;
}

template <class Pixel>
struct Chain {
  scan::BasicPeakDetector<Pixel, 4096> detector;
  scan::BasicPeakRefiner<Pixel, 4096, 4096> refiner;

  Chain(const scan::PeakConfig& peaks, const scan::RefinerConfig& fit) : detector(peaks), refiner(fit) {}

  Rows rows(const Shot& shot) {
    const FormedImage& image = shot.image;
    const std::vector<Pixel> on = pixels<Pixel>(image.on, shot.full_scale), off = pixels<Pixel>(image.off, shot.full_scale);
    const scan::PixelView<Pixel> picture(on.data(), image.width, image.height, image.width);
    const scan::PixelView<Pixel> background =
        shot.has_off ? scan::PixelView<Pixel>(off.data(), image.width, image.height, image.width) : scan::PixelView<Pixel>();
    std::vector<scan::Peak> peaks(static_cast<std::size_t>(image.width));
    peaks.resize(scan::find_stripe(detector, refiner, picture, background, peaks));
    Rows rows = no_rows(image.width);
    for (const scan::Peak& peak : peaks) rows[static_cast<std::size_t>(std::lround(peak.u_px))] = double(peak.v_px);
    return rows;
  }
};

}  // namespace

struct DetectorAndFit::Parts {
  std::unique_ptr<Chain<std::uint8_t>> shallow;  // one of the two
  std::unique_ptr<Chain<std::uint16_t>> deep;
};

DetectorAndFit::DetectorAndFit(int full_scale) : parts_(std::make_unique<Parts>()) {
  scan::PeakConfig peaks;
  peaks.full_scale = full_scale;
  peaks.min_contrast *= static_cast<float>(full_scale) / 255.0f;
  scan::RefinerConfig fit;
  fit.full_scale = full_scale;
  fit.largest_misfit = std::numeric_limits<float>::infinity();
  if (full_scale <= 255) {
    parts_->shallow = std::make_unique<Chain<std::uint8_t>>(peaks, fit);
  } else {
    parts_->deep = std::make_unique<Chain<std::uint16_t>>(peaks, fit);
  }
}

DetectorAndFit::DetectorAndFit(DetectorAndFit&& from) noexcept = default;
DetectorAndFit::~DetectorAndFit() = default;

Rows DetectorAndFit::rows(const Shot& shot) { return parts_->shallow ? parts_->shallow->rows(shot) : parts_->deep->rows(shot); }

double DetectorAndFit::width_px() const {
  return double(scan::width_in_picture_px(parts_->shallow ? parts_->shallow->refiner.optics() : parts_->deep->refiner.optics()));
}

double DetectorAndFit::gain() const { return double(parts_->shallow ? parts_->shallow->refiner.gain() : parts_->deep->refiner.gain()); }

std::array<Rows, 4> rows_of_others(const Shot& shot, double stripe_sigma_px, double gain) {
  const FormedImage image = in_grey(shot, gain);
  Rows mass = no_rows(image.width), log = mass, product = mass;
  for (int u = 0; u < image.width; ++u) {
    const auto column = static_cast<std::size_t>(u);
    const int start = log_row(image, u, log_sigma_px);
    mass[column] = centre_of_mass(image, u, start, static_cast<int>(std::ceil(2.5 * stripe_sigma_px)));
    log[column] = log_centre(image, u, start, log_sigma_px);
    product[column] = product_centre(image, u, start, stripe_sigma_px);
  }
  return {mass, log, product, ridge_rows(image, ridge_sigma_px(stripe_sigma_px))};
}

}  // namespace lf::test
