// Normal deviates that are a hash of a number and a key: the same ones in any order of the work.
#pragma once

#include <cstdint>

#include "shared/lanes/lanes.hpp"

namespace lf::optics {

typedef std::uint32_t WordLanes __attribute__((vector_size(32)));

// Mean 0, variance 1, 4096 different values; those of different numbers or keys have nothing to do with each other.
Lanes normal_deviates(WordLanes number, std::uint64_t key);
float normal_deviate(std::uint32_t number, std::uint64_t key);

// What a camera's frame has its noise from.
std::uint64_t noise_key(std::uint64_t seed, std::uint64_t camera, std::uint64_t frame_number);

}  // namespace lf::optics
