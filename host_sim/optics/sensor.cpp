#include "host_sim/optics/sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "shared/random.hpp"

namespace lf::optics {
namespace {

typedef std::uint8_t Bytes __attribute__((vector_size(32)));

std::size_t padded(std::size_t size) { return (size + lane_count - 1) / lane_count * lane_count; }

}  // namespace

Sensor::Sensor(const CameraConfig& camera)
    : row_size_(static_cast<std::size_t>(camera.intrinsics.width) * (camera.colour ? 3 : 1)),
      width_(camera.intrinsics.width),
      height_(camera.intrinsics.height),
      corner_loss_(1 - camera.corner_light),
      grey_per_radiance_(static_cast<float>(camera.gain * camera.sensitivity * camera.exposure.s())),
      read_variance_(static_cast<float>(camera.gain * camera.gain * camera.read_noise_grey * camera.read_noise_grey)),
      variance_per_grey_(camera.electrons_per_grey > 0 ? static_cast<float>(camera.gain / camera.electrons_per_grey) : 0.f),
      row_noise_(static_cast<float>(camera.gain * camera.row_noise_grey)) {
  const std::size_t stride = padded(row_size_), size = stride * static_cast<std::size_t>(height_);
  sensitivity_.resize(size), dark_.resize(size);
  const std::uint64_t prnu_key = noise_key(camera.serial, 1, 0), dsnu_key = noise_key(camera.serial, 2, 0),
                      hot_key = noise_key(camera.serial, 3, 0);
  const auto hot_below = static_cast<std::uint64_t>(std::min(std::ldexp(camera.hot_pixels, 63), std::ldexp(0.999, 63))) * 2;
  const std::size_t channels = camera.colour ? 3 : 1;
  for (std::size_t i = 0; i < size; ++i) {
    const auto number = static_cast<std::uint32_t>(i);
    const auto v = static_cast<int>(i / stride), u = static_cast<int>(std::min(i % stride, row_size_ - 1) / channels);
    const float own = 1 + static_cast<float>(camera.prnu) * normal_deviate(number, prnu_key);
    sensitivity_[i] = vignetting(u, v) * own * static_cast<float>(1 - camera.stray_share);
    dark_[i] = static_cast<float>(camera.dsnu_grey) * normal_deviate(number, dsnu_key);
    const std::uint64_t draw = splitmix64(hot_key + number);
    if (draw < hot_below) dark_[i] += 20 + 180 * static_cast<float>(draw) / static_cast<float>(hot_below);
  }
}

// The loss grows with the square of the distance from the middle.
float Sensor::vignetting(int u, int v) const {
  const double cu = 0.5 * (width_ - 1), cv = 0.5 * (height_ - 1);
  const double share = ((u - cu) * (u - cu) + (v - cv) * (v - cv)) / std::max(cu * cu + cv * cv, 1.0);
  return static_cast<float>(1 - corner_loss_ * share);
}

// Eight pixels a turn; what is left of the row goes through a padded packet.
void Sensor::expose(const float* grey, int v, const Exposing& exposing, std::uint8_t* pixels) const {
  static thread_local std::vector<float> deviates;  // kept from row to row
  const std::size_t stride = padded(row_size_), row = static_cast<std::size_t>(v) * stride;
  const float *sensitivity = sensitivity_.data() + row, *dark = dark_.data() + row;
  const float row_level = row_noise_ * exposing.gain * normal_deviate(static_cast<std::uint32_t>(v), exposing.key + 1);
  deviates.resize(stride);
  normal_deviates(static_cast<std::uint32_t>(static_cast<std::size_t>(v) * row_size_), row_size_, exposing.key, deviates.data());
  std::size_t i = 0;
  for (; i + lane_count <= row_size_; i += lane_count) {
    const Lanes light = load_lanes(grey + i) * load_lanes(sensitivity + i) * exposing.light;
    expose_packet(light, load_lanes(dark + i) + row_level, load_lanes(deviates.data() + i), exposing, pixels + i);
  }
  if (i == row_size_) return;
  std::array<float, lane_count> rest{};
  std::array<std::uint8_t, lane_count> exposed;
  std::copy(grey + i, grey + row_size_, rest.begin());
  const Lanes light = load_lanes(rest.data()) * load_lanes(sensitivity + i) * exposing.light;
  expose_packet(light, load_lanes(dark + i) + row_level, load_lanes(deviates.data() + i), exposing, exposed.data());
  std::copy_n(exposed.begin(), row_size_ - i, pixels + i);
}

void Sensor::expose_packet(Lanes grey, Lanes dark, Lanes deviate, const Exposing& exposing, std::uint8_t* pixels) const {
  const float read_variance = read_variance_ * exposing.gain * exposing.gain, variance_per_grey = variance_per_grey_ * exposing.gain;
  const Lanes sigma = sqrt(read_variance + variance_per_grey * max(grey, Lanes{}));
  const Lanes value = clamp(grey + dark + sigma * deviate + 0.5f, 0.f, 255.f);
  const LaneMask levels = __builtin_convertvector(value, LaneMask);
  Bytes bytes;
  std::memcpy(&bytes, &levels, sizeof bytes);
  const auto low_bytes = __builtin_shufflevector(bytes, bytes, 0, 4, 8, 12, 16, 20, 24, 28);
  std::memcpy(pixels, &low_bytes, sizeof low_bytes);
}

}  // namespace lf::optics
