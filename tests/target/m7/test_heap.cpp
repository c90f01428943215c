// What the unit tests' own containers ask of a C++ library. Debian's for this processor takes 1.5 GB of disk; this is all of it that is called.
// The core stays without: its libraries are the same that link without a heap in the other programs.
#include <bits/stl_tree.h>
#include <malloc.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "toolchain/cortex_m7/semihosting.hpp"

extern "C" {

extern char psram_end[], psram_limit[];

void* _sbrk(std::ptrdiff_t bytes);
void* _sbrk(std::ptrdiff_t bytes) {
  static char* top = psram_end;
  if (bytes > psram_limit - top) lf::m7::fail("the tests' heap is used up");
  char* block = top;
  top += bytes;
  return block;
}

}  // extern "C"

void* operator new(std::size_t bytes) {
  void* block = std::malloc(bytes);
  if (block == nullptr) lf::m7::fail("no memory");
  return block;
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  void* block = memalign(static_cast<std::size_t>(alignment), bytes);
  if (block == nullptr) lf::m7::fail("no memory");
  return block;
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
void operator delete(void* block, std::align_val_t) noexcept { std::free(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { std::free(block); }

namespace std {

void __throw_length_error(const char* what) { lf::m7::fail(what); }
void __throw_invalid_argument(const char* what) { lf::m7::fail(what); }
void __throw_logic_error(const char* what) { lf::m7::fail(what); }
void __throw_out_of_range(const char* what) { lf::m7::fail(what); }
void __throw_out_of_range_fmt(const char* what, ...) { lf::m7::fail(what); }
void __throw_bad_alloc() { lf::m7::fail("bad allocation"); }
void __throw_bad_array_new_length() { lf::m7::fail("bad array length"); }
void __throw_bad_function_call() { lf::m7::fail("an empty function was called"); }
void __throw_bad_optional_access() { lf::m7::fail("an empty optional was read"); }

// Trees, not balanced: those of the tests are small.
_Rb_tree_node_base* _Rb_tree_increment(_Rb_tree_node_base* x) noexcept {
  if (x->_M_right != nullptr) return _Rb_tree_node_base::_S_minimum(x->_M_right);
  _Rb_tree_node_base* parent = x->_M_parent;
  while (x == parent->_M_right) {
    x = parent;
    parent = parent->_M_parent;
  }
  return x->_M_right != parent ? parent : x;
}
const _Rb_tree_node_base* _Rb_tree_increment(const _Rb_tree_node_base* x) noexcept {
  return _Rb_tree_increment(const_cast<_Rb_tree_node_base*>(x));
}
_Rb_tree_node_base* _Rb_tree_decrement(_Rb_tree_node_base* x) noexcept {
  if (x->_M_parent->_M_parent == x && x->_M_color == _S_red) return x->_M_right;  // from the end
  if (x->_M_left != nullptr) return _Rb_tree_node_base::_S_maximum(x->_M_left);
  _Rb_tree_node_base* parent = x->_M_parent;
  while (x == parent->_M_left) {
    x = parent;
    parent = parent->_M_parent;
  }
  return parent;
}
void _Rb_tree_insert_and_rebalance(const bool left, _Rb_tree_node_base* x, _Rb_tree_node_base* parent,
                                   _Rb_tree_node_base& header) noexcept {
  x->_M_parent = parent;
  x->_M_left = x->_M_right = nullptr;
  x->_M_color = _S_black;  // the header alone is red
  if (parent == &header) {
    header._M_parent = header._M_left = header._M_right = x;
  } else if (left) {
    parent->_M_left = x;
    if (parent == header._M_left) header._M_left = x;
  } else {
    parent->_M_right = x;
    if (parent == header._M_right) header._M_right = x;
  }
}
namespace {

// `child`, or nothing, takes the place of `old` under old's parent.
void hang(_Rb_tree_node_base* old, _Rb_tree_node_base* child, _Rb_tree_node_base& header) {
  _Rb_tree_node_base* parent = old->_M_parent;
  if (header._M_parent == old)
    header._M_parent = child;
  else if (parent->_M_left == old)
    parent->_M_left = child;
  else
    parent->_M_right = child;
  if (child != nullptr) child->_M_parent = parent;
}

}  // namespace

_Rb_tree_node_base* _Rb_tree_rebalance_for_erase(_Rb_tree_node_base* const z, _Rb_tree_node_base& header) noexcept {
  _Rb_tree_node_base* const next = _Rb_tree_increment(z);
  if (header._M_right == z) header._M_right = _Rb_tree_decrement(z);
  if (header._M_left == z) header._M_left = next;
  if (z->_M_left == nullptr || z->_M_right == nullptr) {
    hang(z, z->_M_left != nullptr ? z->_M_left : z->_M_right, header);
    return z;
  }
  // `next` is the leftmost of the right branch: it leaves its place and takes that of `z`.
  hang(next, next->_M_right, header);
  hang(z, next, header);
  next->_M_left = z->_M_left;
  next->_M_left->_M_parent = next;
  next->_M_right = z->_M_right;
  if (next->_M_right != nullptr) next->_M_right->_M_parent = next;
  return z;
}

}  // namespace std
