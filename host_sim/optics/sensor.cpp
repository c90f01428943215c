#include "host_sim/optics/sensor.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace lf::optics {
namespace {

typedef std::uint8_t Bytes __attribute__((vector_size(32)));

}  // namespace

Sensor::Sensor(const CameraConfig& camera)
    : grey_per_radiance_(static_cast<float>(camera.gain * camera.sensitivity * camera.exposure.s())),
      read_variance_(static_cast<float>(camera.gain * camera.gain * camera.read_noise_grey * camera.read_noise_grey)),
      variance_per_grey_(camera.electrons_per_grey > 0 ? static_cast<float>(camera.gain / camera.electrons_per_grey) : 0.f) {}

// Eight pixels a turn; what is left of the row goes through a padded packet.
void Sensor::expose(const float* grey, std::uint8_t* pixels, std::size_t count, std::uint32_t first, std::uint64_t key) const {
  std::size_t i = 0;
  for (; i + lane_count <= count; i += lane_count) {
    expose_packet(load_lanes(grey + i), pixels + i, first + static_cast<std::uint32_t>(i), key);
  }
  if (i == count) return;
  std::array<float, lane_count> rest{};
  std::array<std::uint8_t, lane_count> exposed;
  std::copy(grey + i, grey + count, rest.begin());
  expose_packet(load_lanes(rest.data()), exposed.data(), first + static_cast<std::uint32_t>(i), key);
  std::copy_n(exposed.begin(), count - i, pixels + i);
}

void Sensor::expose_packet(Lanes grey, std::uint8_t* pixels, std::uint32_t first, std::uint64_t key) const {
  const Lanes deviate = normal_deviates(WordLanes{0, 1, 2, 3, 4, 5, 6, 7} + first, key);
  const Lanes sigma = sqrt(read_variance_ + variance_per_grey_ * max(grey, Lanes{}));
  const Lanes value = clamp(grey + sigma * deviate + 0.5f, 0.f, 255.f);
  const LaneMask levels = __builtin_convertvector(value, LaneMask);
  Bytes bytes;
  std::memcpy(&bytes, &levels, sizeof bytes);
  const auto low_bytes = __builtin_shufflevector(bytes, bytes, 0, 4, 8, 12, 16, 20, 24, 28);
  std::memcpy(pixels, &low_bytes, sizeof low_bytes);
}

}  // namespace lf::optics
