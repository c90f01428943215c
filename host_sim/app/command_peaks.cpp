#include <algorithm>
#include <bit>
#include <limits>
#include <memory>
#include <optional>

#include "firmware/scan/peak_refiner.hpp"
#include "firmware/scan/peaks.hpp"
#include "firmware/scan/stripe_finder.hpp"
#include "hal/config/nearest.hpp"
#include "hal/vision/image_file.hpp"
#include "host_sim/app/checks.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/peak_doubt.hpp"
#include "host_sim/record/file_sink.hpp"
#include "host_sim/record/png.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace {

struct Options {
  std::string image, off, axis = "column", channel = "grey", overlay;
  bool csv = false, json = false;
};

struct Found {
  std::vector<scan::Peak> peaks;
  std::vector<scan::Peak> detected;  // before the fit: what a doubt is seen by
  scan::PeakCounters counters;
  scan::StripeOptics optics;
};

scan::PeakCounters since(const scan::PeakCounters& before, const scan::PeakCounters& now) {
  return {now.found - before.found, now.weak - before.weak, now.saturated - before.saturated, now.ambiguous - before.ambiguous};
}

template <class Pixel>
Found detect(const scan::PixelView<Pixel>& image, const scan::PixelView<Pixel>& off, const scan::PeakConfig& config) {
  using Detector = scan::BasicPeakDetector<Pixel, 4096>;
  const auto detector = std::make_unique<Detector>(config);
  Found found;
  const auto lines = static_cast<std::size_t>(std::max(image.width, image.height));
  scan::RefinerConfig refiner_config;
  refiner_config.axis = config.axis;
  refiner_config.full_scale = config.full_scale;
  refiner_config.largest_misfit =
      std::numeric_limits<float>::infinity();  // nothing comes after that would sort silhouettes out, or miss them
  const auto refiner = std::make_unique<scan::BasicPeakRefiner<Pixel, 4096, 4096>>(refiner_config);
  bool again = true;
  for (int time = 0; again && time < 2; ++time) {
    const scan::PeakCounters before = detector->counters();
    found.detected.resize(lines);
    found.detected.resize(detector->detect(image, off, found.detected));
    found.counters = since(before, detector->counters());
    found.peaks = found.detected;
    found.peaks.resize(refiner->refine(image, off, found.peaks));
    again = scan::follow_width(*detector, *refiner);
  }
  // A stripe that is wider than the fit's window, or no Gaussian: what the filter finds is the better answer, and doubtful.
  if (found.peaks.size() * 2 < found.detected.size()) found.peaks = found.detected;
  found.optics = refiner->optics();
  return found;
}

// 2^n - 1 for the bits that the image uses, 8 at least: cameras of 10, 12 and 14 bits store their pixels in 16.
std::int32_t full_scale(const std::vector<std::uint16_t>& pixels) {
  const std::uint16_t highest = *std::max_element(pixels.begin(), pixels.end());
  const int bits = std::max(8, (std::bit_width(highest) + 1) / 2 * 2);
  return (1 << bits) - 1;
}

Found detect(const vision::DeepImage& image, const std::optional<vision::DeepImage>& off, scan::PeakConfig config) {
  if (!image.deep) {
    const scan::PixelView<std::uint8_t> on(image.pixels8.data(), image.width, image.height, image.width);
    return detect<std::uint8_t>(
        on, off ? scan::PixelView<std::uint8_t>(off->pixels8.data(), off->width, off->height, off->width) : scan::PixelView<std::uint8_t>(),
        config);
  }
  config.full_scale = full_scale(image.pixels16);
  config.min_contrast *= static_cast<float>(config.full_scale) / 255.0f;
  const scan::PixelView<std::uint16_t> on(image.pixels16.data(), image.width, image.height, image.width);
  return detect<std::uint16_t>(
      on,
      off ? scan::PixelView<std::uint16_t>(off->pixels16.data(), off->width, off->height, off->width) : scan::PixelView<std::uint16_t>(),
      config);
}

void check_sizes(const Options& options, const vision::DeepImage& image, const std::optional<vision::DeepImage>& off) {
  constexpr std::int32_t longest = scan::LargePeakDetector::max_length;
  constexpr std::int32_t shortest = scan::LargePeakDetector::min_length;
  const std::int32_t length = options.axis == "column" ? image.height : image.width;
  if (length > longest || length < shortest) {
    throw InputError(options.image + ": " + std::to_string(length) + " pixels a " + options.axis + ", peaks takes " +
                     std::to_string(shortest) + " to " + std::to_string(longest));
  }
  if (!off) return;
  if (off->width != image.width || off->height != image.height) throw InputError(options.off + ": not of the size of " + options.image);
  if (off->deep != image.deep) throw InputError(options.off + ": not of the depth of " + options.image);
}

StripePicture picture_of(const vision::DeepImage& image, const std::optional<vision::DeepImage>& off, scan::PeakAxis axis) {
  const bool columns = axis == scan::PeakAxis::column;
  const auto grey = [](const vision::DeepImage& of, std::size_t at) { return double(of.deep ? of.pixels16[at] : of.pixels8[at]); };
  return {columns ? image.width : image.height, columns ? image.height : image.width,
          [&image, &off, columns, grey](std::int32_t line, std::int32_t place) {
            const std::int32_t u = columns ? line : place, v = columns ? place : line;
            const std::size_t at = static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(u);
            return grey(image, at) - (off ? grey(*off, at) : 0);
          }};
}

void write_overlay(const Options& options, const Found& found) {
  const vision::GreyImage grey = vision::read_image_file(options.image, vision::channel_from_name(options.channel));
  std::vector<record::PixelPoint> points;
  for (const scan::Peak& peak : found.peaks) points.push_back({peak.u_px, peak.v_px});
  const std::vector<std::uint8_t> png = record::encode_png(record::overlay_peaks(grey.view(), points));
  record::write_file_atomically(options.overlay, {reinterpret_cast<const char*>(png.data()), png.size()});
}

void tell(const Options& options, const vision::DeepImage& image, const Found& found, const StripeLook& look,
          const std::vector<std::string>& doubts) {
  const std::size_t not_fitted = found.detected.size() - found.peaks.size();
  if (options.json) {
    Json peaks = Json::array();
    for (const scan::Peak& peak : found.peaks)
      peaks.push_back({{"u", peak.u_px}, {"v", peak.v_px}, {"amplitude", peak.amplitude}, {"ratio", peak.ratio}});
    print_json(
        {{"width", image.width},
         {"height", image.height},
         {"peaks", peaks},
         {"rejected", {{"weak", found.counters.weak}, {"saturated", found.counters.saturated}, {"ambiguous", found.counters.ambiguous}, {"not_fitted", not_fitted}}},
         {"stripe_width_px", look.width_px},
         {"scatter_px", look.scatter_px},
         {"doubts", doubts}});
  } else if (options.csv) {
    print("u,v,amplitude,ratio\n");
    for (const scan::Peak& peak : found.peaks) {
      print("%.4f,%.4f,%.2f,%.4f\n", double(peak.u_px), double(peak.v_px), double(peak.amplitude), double(peak.ratio));
    }
  } else {
    print("%s in %d %ss; refused: %llu weak, %llu saturated, %llu ambiguous, %zu not fitted\n", count_of(found.peaks.size(), "peak").c_str(),
          options.axis == "column" ? image.width : image.height, options.axis.c_str(), static_cast<unsigned long long>(found.counters.weak),
          static_cast<unsigned long long>(found.counters.saturated), static_cast<unsigned long long>(found.counters.ambiguous), not_fitted);
  }
}

int peaks(const Options& options) {
  config::check_names({options.channel}, {"grey", "red", "green", "blue", "r", "g", "b", "red-excess", "green-excess", "blue-excess"},
                      "--channel");
  const vision::Channel channel = vision::channel_from_name(options.channel);
  const vision::DeepImage image = vision::read_deep_image(options.image, channel);
  std::optional<vision::DeepImage> off;
  if (!options.off.empty()) off = vision::read_deep_image(options.off, channel);
  check_sizes(options, image, off);
  scan::PeakConfig config;
  config.axis = options.axis == "column" ? scan::PeakAxis::column : scan::PeakAxis::row;
  const Found found = detect(image, off, config);
  if (!options.overlay.empty()) write_overlay(options, found);
  StripeLook look = look_at_stripe(picture_of(image, off, config.axis), found.detected, config.axis);
  look.off_given = off.has_value();
  look.ambiguous = found.counters.ambiguous;
  const std::vector<std::string> doubts = peak_doubts(look);
  tell_doubts(options.image, doubts);
  tell(options, image, found, look, doubts);
  return doubts.empty() ? done : failed;
}

}  // namespace

void add_peaks(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("peaks", "Sub-pixel peaks of a laser stripe in an image");
  auto options = std::make_shared<Options>();
  command->add_option("IMAGE", options->image, "PNG, JPEG and what OpenCV reads, 8 or 16 bits")->required();
  command->add_option("--off", options->off, "The same scene without the laser: is subtracted");
  command->add_option("--axis", options->axis, "One peak in each column or row")
      ->check(CLI::IsMember({"column", "row"}))
      ->capture_default_str();
  command->add_option("--channel", options->channel, vision::channel_names)->capture_default_str();
  command->add_option("--overlay", options->overlay, "Write the image with its peaks in red to this PNG")->check(check_png);
  CLI::Option* csv = command->add_flag("--csv", options->csv, "Print CSV");
  command->add_flag("--json", options->json, "Print JSON")->excludes(csv);
  command->callback([options, &action] { action = [options] { return peaks(*options); }; });
}

}  // namespace lf::app
