#include "host_sim/app/peak_doubt.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace lf::app {

namespace {

constexpr std::size_t fewest_peaks = 10;
constexpr std::int32_t half_window = 40;  // px to either side of a peak: a stripe of sigma 10 px has 0.03 % of its height there
// Peaks are made for stripes of sigma 0.8 to 5 px: 12 px at half height.
constexpr double widest_px = 12;
// 0.1 px is usual, 0.3 px what speckle gives. With more a neighbour tells as little as the peak itself.
constexpr double most_scatter_px = 0.7;

// A stripe crosses a picture, or a good part of it.
constexpr double least_share = 0.125;
// Specks and what moved leave a dark line in some columns.
constexpr double most_dark_share = 0.3;

// In a profile, of the pixel `i` from the peak.
std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i) + static_cast<std::size_t>(half_window); }

struct Place {
  std::int32_t line = 0;
  double along = 0;
};

std::vector<Place> places_of(std::span<const scan::Peak> peaks, scan::PeakAxis axis) {
  std::vector<Place> places;
  for (const scan::Peak& peak : peaks) {
    const bool column = axis == scan::PeakAxis::column;
    places.push_back({static_cast<std::int32_t>(std::lround(column ? peak.u_px : peak.v_px)), double(column ? peak.v_px : peak.u_px)});
  }
  return places;
}

// The mean of the profiles, each about its own peak: noise averages out, the width stays.
double width_of(const StripePicture& picture, std::span<const Place> places) {
  std::array<double, 2 * half_window + 1> sum{}, weight{};
  for (const Place& place : places) {
    const auto middle = static_cast<std::int32_t>(std::lround(place.along));
    for (std::int32_t i = -half_window; i <= half_window; ++i) {
      const std::int32_t at = middle + i;
      if (at < 0 || at >= picture.length) continue;
      sum[index(i)] += picture.grey(place.line, at);
      weight[index(i)] += 1;
    }
  }
  const auto grey = [&](std::int32_t i) { return weight[index(i)] > 0 ? sum[index(i)] / weight[index(i)] : std::nan(""); };
  double floor = HUGE_VAL, top = -HUGE_VAL;
  for (std::int32_t i = -half_window; i <= half_window; ++i) {
    if (std::isfinite(grey(i))) floor = std::min(floor, grey(i));
  }
  for (std::int32_t i = -1; i <= 1; ++i) top = std::max(top, grey(i));
  const double half = (top + floor) / 2;
  // Where the profile falls below half its height, to either side, between pixels.
  double width = 0;
  for (const std::int32_t side : {-1, 1}) {
    std::int32_t i = 0;
    while (i < half_window && grey(side * (i + 1)) >= half) ++i;
    const double above = grey(side * i), below = i < half_window ? grey(side * (i + 1)) : std::nan("");
    width += i + (std::isfinite(below) && above > below ? std::clamp((above - half) / (above - below), 0.0, 1.0) : 0.5);
  }
  return width;
}

// 1.4826 of the median is the sigma of a normal distribution; a second difference has the variance of its places six times.
double scatter_of(std::span<const Place> places) {
  std::vector<double> bends;
  for (std::size_t i = 1; i + 1 < places.size(); ++i) {
    if (places[i].line - places[i - 1].line != 1 || places[i + 1].line - places[i].line != 1) continue;
    bends.push_back(std::abs(places[i - 1].along - 2 * places[i].along + places[i + 1].along));
  }
  if (bends.size() < fewest_peaks / 2) return 0;
  const auto middle = bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2);
  std::nth_element(bends.begin(), middle, bends.end());
  return 1.4826 * *middle / std::sqrt(6.0);
}

// How far a place stands over what is some stripe's width beside it.
double height_at(const StripePicture& picture, std::int32_t line, std::int32_t at) {
  constexpr std::int32_t beside = 8;
  if (at < beside || at + beside >= picture.length) return 0;
  return picture.grey(line, at) - 0.5 * (picture.grey(line, at - beside) + picture.grey(line, at + beside));
}

// Whether right beside a peak it is darker than farther out, by half of the peak's height: the other picture's stripe has moved by less than its width.
bool has_dark_side(const StripePicture& picture, std::int32_t line, std::int32_t middle, std::int32_t apart) {
  std::vector<double> farther;
  for (std::int32_t at = std::max(0, middle - half_window); at <= std::min(picture.length - 1, middle + half_window); ++at) {
    if (std::abs(at - middle) > apart) farther.push_back(picture.grey(line, at));
  }
  if (farther.empty() || middle < 0 || middle >= picture.length) return false;
  const auto median = farther.begin() + static_cast<std::ptrdiff_t>(farther.size() / 2);
  std::nth_element(farther.begin(), median, farther.end());
  const double dark = *median - 0.5 * (picture.grey(line, middle) - *median);
  for (std::int32_t at = std::max(0, middle - apart); at + 1 <= std::min(picture.length - 1, middle + apart); ++at) {
    if (picture.grey(line, at) < dark && picture.grey(line, at + 1) < dark) return true;
  }
  return false;
}

// A picture of the laser that is subtracted leaves its own stripe, dark.
double dark_share_of(const StripePicture& picture, std::span<const Place> places) {
  constexpr std::int32_t apart = 12;
  std::size_t dark = 0;
  for (const Place& place : places) {
    const auto middle = static_cast<std::int32_t>(std::lround(place.along));
    const double least = -0.5 * height_at(picture, place.line, middle);
    bool found = has_dark_side(picture, place.line, middle, apart);
    for (std::int32_t at = 0; at < picture.length && !found; ++at)
      found = std::abs(at - middle) > apart && height_at(picture, place.line, at) < least && height_at(picture, place.line, at + 1) < least;
    dark += found ? 1 : 0;
  }
  return static_cast<double>(dark) / static_cast<double>(places.size());
}

std::string formatted(const char* format, double a, double b) {
  std::array<char, 200> text;
  (void)std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

}  // namespace

StripeLook look_at_stripe(const StripePicture& picture, std::span<const scan::Peak> peaks, scan::PeakAxis axis) {
  StripeLook look;
  const std::vector<Place> places = places_of(peaks, axis);
  look.lines = picture.lines;
  look.found = static_cast<std::int32_t>(places.size());
  if (places.size() < fewest_peaks) return look;
  look.dark_share = dark_share_of(picture, places);
  look.width_px = width_of(picture, places);
  look.scatter_px = scatter_of(places);
  return look;
}

std::vector<std::string> peak_doubts(const StripeLook& look) {
  std::vector<std::string> doubts;
  if (2 * look.ambiguous > static_cast<std::uint64_t>(look.lines))
    doubts.push_back(formatted(look.off_given ? "%.0f of %.0f lines have several peaks as strong: crop the picture to the one that counts"
                                              : "%.0f of %.0f lines have several peaks as strong: give --off, or crop the picture to the one "
                                                "that counts",
                               static_cast<double>(look.ambiguous), look.lines));
  else if (look.found < least_share * look.lines)
    doubts.push_back(formatted(
        look.off_given
            ? "peaks in %.0f of %.0f lines alone: is the laser in this picture and in this channel, does its line run across them (--axis), "
              "and is --off the same scene without it?"
            : "peaks in %.0f of %.0f lines alone: is the laser in this picture and in this channel, and does its line run across them "
              "(--axis)?",
        look.found, look.lines));
  if (look.off_given && look.dark_share > most_dark_share)
    doubts.push_back(
        formatted("beside %.0f %% of the peaks stands a dark line: --off seems to have the laser, too", 100 * look.dark_share, 0));
  if (look.found < static_cast<std::int32_t>(fewest_peaks)) return doubts;
  if (look.width_px > widest_px)
    doubts.push_back(
        formatted("the stripe is %.0f px wide at half its height, and peaks are sure up to %.0f px: bin the picture or focus "
                  "the line",
                  look.width_px, widest_px));
  if (look.scatter_px > most_scatter_px)
    doubts.push_back(
        formatted("the peaks scatter by %.2f px about their neighbours: the picture is too noisy for places better than %.1f px",
                  look.scatter_px, most_scatter_px));
  return doubts;
}

}  // namespace lf::app
