// Peaks of the laser's stripe in images of any size, shape and content, with and without a background.
#include <cmath>

#include "firmware/scan/peaks.hpp"
#include "tests/fuzz/picture.hpp"

namespace lf::fuzz {
namespace {

template <class Detector, class Pixel>
void detect(Input& in) {
  scan::PeakConfig config;
  const std::uint8_t flags = in.byte();
  config.axis = (flags & 1U) != 0 ? scan::PeakAxis::row : scan::PeakAxis::column;
  config.peaks_per_line = 1 + (flags >> 1U & 3U);
  config.min_contrast = static_cast<float>(in.byte()) / 8;
  config.max_clipped = in.byte();
  config.full_scale = (flags & 8U) != 0 ? 65535 : 255;
  const std::int32_t width = in.byte(), height = in.byte();
  Picture<Pixel> off = blank<Pixel>(in, width, height);
  Picture<Pixel> on = (flags & 16U) != 0 ? off : blank<Pixel>(in, width - (flags >> 7U), height);
  draw(in, on);
  // Scratch memory is large: the detectors stay, and are made anew in their place.
  static Detector detector;
  detector = Detector(config);
  const bool background = (flags & 32U) != 0;
  const scan::PixelView<Pixel> lit(on.pixels.data(), on.width, on.height, on.stride),
      dark(off.pixels.data(), off.width, off.height, off.stride);
  std::vector<scan::Peak> peaks((flags & 64U) != 0 ? 1024 : in.byte());
  const std::size_t found = detector.detect(lit, background ? dark : scan::PixelView<Pixel>(), peaks);
  expect(found <= peaks.size(), "peaks fit");
  for (std::size_t i = 0; i < found; ++i) {
    const scan::Peak& peak = peaks[i];
    expect(std::isfinite(peak.u_px) && std::isfinite(peak.v_px) && std::isfinite(peak.amplitude) && std::isfinite(peak.ratio),
           "a peak is numbers");
    expect(
        peak.u_px >= -0.5F && peak.u_px <= static_cast<float>(on.width) && peak.v_px >= -0.5F && peak.v_px <= static_cast<float>(on.height),
        "a peak lies in the image");
  }
}

}  // namespace
}  // namespace lf::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  lf::fuzz::Input in(data, size);
  if ((in.byte() & 3U) != 3)
    lf::fuzz::detect<lf::scan::PeakDetector, std::uint8_t>(in);
  else
    lf::fuzz::detect<lf::scan::LargePeakDetector16, std::uint16_t>(in);
  return 0;
}
