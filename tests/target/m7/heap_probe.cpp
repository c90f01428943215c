// Has a heap call no one would see in the source: the link has to refuse it. Built by a test that wants to see the refusal.
#include <cstdlib>

#include "toolchain/cortex_m7/semihosting.hpp"

extern "C" void* _sbrk(int);
extern "C" void* _sbrk(int) { return nullptr; }

int main() {
  volatile std::size_t bytes = 16;
  void* block = std::malloc(bytes);
  lf::m7::print(block != nullptr ? "a block\n" : "no block\n");
  return 0;
}
