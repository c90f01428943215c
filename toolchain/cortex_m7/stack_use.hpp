// How deep the stack has been: painted at reset, read back by the paint that is left.
#pragma once

#include <cstddef>

namespace lf::m7 {

std::size_t stack_bytes();
std::size_t stack_used_bytes();

}  // namespace lf::m7
