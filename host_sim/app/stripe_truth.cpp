#include "host_sim/app/stripe_truth.hpp"

#include <algorithm>
#include <cmath>

namespace lf::app {
namespace {

std::size_t index(const optics::Frame& frame, std::int32_t u, std::int32_t v) {
  return static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(u);
}

// Whether the depth has no jump and no crease within the stripe's width about a pixel.
bool on_smooth_surface(const optics::Frame& truth, std::int32_t u, std::int32_t v) {
  constexpr std::int32_t reach = 5;  // px: three standard deviations of a stripe in clear water
  constexpr double bend_m = 2e-3;    // a face of the panel seen at a slant bends by 0.1 mm over the reach, its arris by 5 mm
  if (u < reach || v < reach || u + reach >= truth.width || v + reach >= truth.height) return false;
  const auto depth_m = [&](std::int32_t x, std::int32_t y) { return double(truth.depth_m[index(truth, x, y)]); };
  const double centre_m = depth_m(u, v);
  return std::abs(depth_m(u, v - reach) + depth_m(u, v + reach) - 2 * centre_m) < bend_m &&
         std::abs(depth_m(u - reach, v) + depth_m(u + reach, v) - 2 * centre_m) < bend_m;
}

// The darker side: the other may be of another thing.
float background_beside(const optics::Frame& frame, const optics::StripePiece& piece) {
  if (frame.pixels.empty()) return 0;
  const auto off = static_cast<std::int32_t>(std::ceil(4 * std::max(piece.sigma_px, 1.f)));
  const auto channels = static_cast<std::size_t>(frame.channels);
  const auto at = [&](std::int32_t v) {
    return float(frame.pixels[index(frame, piece.u, std::clamp(v, 0, frame.height - 1)) * channels + channels / 2]);
  };
  const auto v = static_cast<std::int32_t>(std::lround(piece.v));
  return std::min(at(v - off), at(v + off));
}

// Of what a piece lies on. At a border its centre may fall on the pixel beside, in which there is nothing: the nearest thing up or down has its light.
std::uint16_t object_about(const optics::Frame& frame, std::int32_t u, std::int32_t v) {
  constexpr std::int32_t reach_px = 2;  // as far as a peak is matched with a piece
  for (std::int32_t off = 0; off <= reach_px; ++off) {
    for (const std::int32_t at : {v - off, v + off}) {
      const std::uint16_t object = frame.object[index(frame, u, std::clamp(at, 0, frame.height - 1))];
      if (object != 0) return object;
    }
  }
  return 0;
}

}  // namespace

StripeTruth stripe_truth(const optics::Frame& frame, const std::function<bool(std::uint16_t)>& looked_for) {
  const std::size_t pixels = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  const bool has_depth = frame.depth_m.size() == pixels, has_objects = frame.object.size() == pixels;
  StripeTruth truth;
  truth.columns.resize(static_cast<std::size_t>(frame.width));
  for (const optics::StripePiece& piece : frame.pieces) {
    const auto v = std::clamp(static_cast<std::int32_t>(std::lround(piece.v)), 0, frame.height - 1);
    truth.columns[static_cast<std::size_t>(piece.u)].push_back(
        {piece.v, piece.grey, piece.sigma_px, background_beside(frame, piece), has_depth && on_smooth_surface(frame, piece.u, v),
         piece.part, piece.near_mark, looked_for && has_objects && !looked_for(object_about(frame, piece.u, v))});
  }
  return truth;
}

double PictureNoise::difference_variance(double background_grey) const {
  return 2 * (read_grey * read_grey + (electrons_per_grey > 0 ? background_grey / electrons_per_grey : 0));
}

double PictureNoise::centre_variance_px2(const TruePiece& piece) const {
  const double sigma = double(piece.sigma_px), height = double(piece.grey);
  const double of_speckle = speckle * speckle * sigma / (4 * std::sqrt(pi));
  const double of_background = difference_variance(double(piece.background)) * 2 * sigma / (std::sqrt(pi) * height * height);
  const double of_stripe = electrons_per_grey > 0 ? sigma / (std::sqrt(2 * pi) * height * electrons_per_grey) : 0;
  return of_speckle + of_background + of_stripe;
}

}  // namespace lf::app
