#include "host_sim/record/digest.hpp"

#include <openssl/evp.h>

#include <array>
#include <bit>
#include <new>
#include <stdexcept>

namespace lf::record {
namespace {

enum class Entry : std::uint8_t { can_frame = 1, decision = 2, state = 3 };

struct ContextDelete {
  void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
};
using Context = std::unique_ptr<EVP_MD_CTX, ContextDelete>;

Context new_context() {
  Context context(EVP_MD_CTX_new());
  if (!context || EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) != 1) throw std::runtime_error("OpenSSL has no SHA-256");
  return context;
}

void feed(EVP_MD_CTX* context, const void* data, std::size_t size) {
  if (EVP_DigestUpdate(context, data, size) != 1) throw std::runtime_error("SHA-256 failed");
}

// Little endian, whatever the machine.
void feed_number(EVP_MD_CTX* context, std::uint64_t value) {
  std::array<std::uint8_t, 8> bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  feed(context, bytes.data(), bytes.size());
}

void feed_text(EVP_MD_CTX* context, std::string_view text) {
  feed_number(context, text.size());
  feed(context, text.data(), text.size());
}

std::string finish(const EVP_MD_CTX* context) {
  const Context copy(EVP_MD_CTX_new());
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> digest;
  unsigned size = 0;
  if (!copy || EVP_MD_CTX_copy_ex(copy.get(), context) != 1 || EVP_DigestFinal_ex(copy.get(), digest.data(), &size) != 1) {
    throw std::runtime_error("SHA-256 failed");
  }
  constexpr char digits[] = "0123456789abcdef";
  std::string hex;
  for (unsigned i = 0; i < size; ++i) {
    hex += digits[digest[i] >> 4];
    hex += digits[digest[i] & 15];
  }
  return hex;
}

}  // namespace

struct RunDigest::Implementation {
  Context context = new_context();

  void begin(Entry entry) { feed_number(context.get(), static_cast<std::uint64_t>(entry)); }
};

RunDigest::RunDigest() : implementation_(std::make_unique<Implementation>()) {}
RunDigest::~RunDigest() = default;
RunDigest::RunDigest(RunDigest&&) noexcept = default;
RunDigest& RunDigest::operator=(RunDigest&&) noexcept = default;

void RunDigest::can_frame(Time t, std::uint8_t bus, CanDirection direction, const CanFrame& frame) {
  EVP_MD_CTX* context = implementation_->context.get();
  implementation_->begin(Entry::can_frame);
  feed_number(context, static_cast<std::uint64_t>(t.ns()));
  feed_number(context, static_cast<std::uint64_t>(bus) | static_cast<std::uint64_t>(direction) << 8 |
                           static_cast<std::uint64_t>(frame.length) << 16 | static_cast<std::uint64_t>(frame.id) << 32);
  feed(context, frame.data.data(), frame.data.size());
}

void RunDigest::decision(Time t, std::string_view text) {
  implementation_->begin(Entry::decision);
  feed_number(implementation_->context.get(), static_cast<std::uint64_t>(t.ns()));
  feed_text(implementation_->context.get(), text);
}

void RunDigest::state(std::string_view name, double value) { state(name, std::span<const double>(&value, 1)); }

void RunDigest::state(std::string_view name, std::span<const double> values) {
  implementation_->begin(Entry::state);
  feed_text(implementation_->context.get(), name);
  feed_number(implementation_->context.get(), values.size());
  for (const double value : values) feed_number(implementation_->context.get(), std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value));
}

std::string RunDigest::hex() const { return finish(implementation_->context.get()); }

std::string sha256_hex(std::string_view bytes) {
  const Context context = new_context();
  feed(context.get(), bytes.data(), bytes.size());
  return finish(context.get());
}

}  // namespace lf::record
