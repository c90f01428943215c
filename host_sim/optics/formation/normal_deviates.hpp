// Normal deviates that are a hash of a number and a key: the same ones in any order of the work.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lf::optics {

// Mean 0, variance 1, 4096 different values; those of different numbers or keys have nothing to do with each other.
float normal_deviate(std::uint32_t number, std::uint64_t key);

// Those of `count` numbers from `first` on, into `out`, eight at a time: it has room for a multiple of eight.
void normal_deviates(std::uint32_t first, std::size_t count, std::uint64_t key, float* out);

// What a camera's frame has its noise from.
std::uint64_t noise_key(std::uint64_t seed, std::uint64_t camera, std::uint64_t frame_number);

}  // namespace lf::optics
