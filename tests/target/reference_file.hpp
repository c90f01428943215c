// How written-down results lie in their file: 64-bit words, little-endian, one a value; an operation begins with the hash of its name.
#pragma once

#include <cstdint>

namespace lf::test {

// FNV-1a.
constexpr std::uint64_t hash_of(const char* name) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (; *name != 0; ++name) hash = (hash ^ static_cast<unsigned char>(*name)) * 0x100000001b3u;
  return hash;
}

}  // namespace lf::test
