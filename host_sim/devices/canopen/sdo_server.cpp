#include "host_sim/devices/canopen/sdo_server.hpp"

#include <algorithm>

namespace lf::devices {
namespace {

// Command specifiers, the top three bits of byte 0.
constexpr std::uint8_t ccs_download_segment = 0;
constexpr std::uint8_t ccs_initiate_download = 1;
constexpr std::uint8_t ccs_initiate_upload = 2;
constexpr std::uint8_t ccs_upload_segment = 3;
constexpr std::uint8_t cs_abort = 4;
constexpr std::uint8_t ccs_block_upload = 5;
constexpr std::uint8_t ccs_block_download = 6;
constexpr std::uint8_t expedited = 0x02;
constexpr std::uint8_t size_indicated = 0x01;
constexpr std::uint8_t toggle_bit = 0x10;
constexpr std::size_t segment_bytes = 7;

void put_u32(std::uint32_t value, std::uint8_t* bytes) {
  for (int i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

std::uint32_t get_u32(const std::uint8_t* bytes) {
  return bytes[0] | (std::uint32_t{bytes[1]} << 8) | (std::uint32_t{bytes[2]} << 16) | (std::uint32_t{bytes[3]} << 24);
}

}  // namespace

bool SdoServer::on_request(std::span<const std::uint8_t> request, Time now, Answer& answer) {
  if (request.size() != 8) return false;
  answer.fill(0);
  last_ = now;
  const std::uint8_t command = request[0];
  const std::uint8_t specifier = command >> 5;
  if (specifier == cs_abort) {
    transfer_ = Transfer::none;
    return false;
  }
  const bool names_object = specifier == ccs_initiate_download || specifier == ccs_initiate_upload || specifier == ccs_block_upload ||
                            specifier == ccs_block_download;
  if (names_object) {
    transfer_ = Transfer::none;
    index_ = static_cast<std::uint16_t>(request[1] | (request[2] << 8));
    sub_ = request[3];
  }
  Abort code = Abort::command;
  if (specifier == ccs_initiate_upload) code = begin_upload(answer);
  if (specifier == ccs_initiate_download) code = begin_download(request, now, answer);
  if (specifier == ccs_upload_segment && transfer_ == Transfer::upload) code = upload_segment(command, answer);
  if (specifier == ccs_download_segment && transfer_ == Transfer::download) code = download_segment(request, now, answer);
  if (code != Abort::none) abort(code, answer);
  return true;
}

Abort SdoServer::begin_upload(Answer& answer) {
  bytes_.clear();
  const Abort code = target_.sdo_read(index_, sub_, bytes_);
  if (code != Abort::none) return code;
  name_object(answer);
  if (!bytes_.empty() && bytes_.size() <= 4) {
    answer[0] = static_cast<std::uint8_t>(0x40 | ((4 - bytes_.size()) << 2) | expedited | size_indicated);
    std::copy(bytes_.begin(), bytes_.end(), answer.begin() + 4);
    return Abort::none;
  }
  answer[0] = 0x40 | size_indicated;
  put_u32(static_cast<std::uint32_t>(bytes_.size()), answer.data() + 4);
  transfer_ = Transfer::upload;
  position_ = 0;
  toggle_ = false;
  return Abort::none;
}

Abort SdoServer::upload_segment(std::uint8_t command, Answer& answer) {
  if (((command & toggle_bit) != 0) != toggle_) return Abort::toggle;
  const std::size_t size = std::min(segment_bytes, bytes_.size() - position_);
  const bool last = position_ + size == bytes_.size();
  answer[0] = static_cast<std::uint8_t>((toggle_ ? toggle_bit : 0) | ((segment_bytes - size) << 1) | (last ? 1 : 0));
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(position_), size, answer.begin() + 1);
  position_ += size;
  toggle_ = !toggle_;
  if (last) transfer_ = Transfer::none;
  return Abort::none;
}

Abort SdoServer::begin_download(std::span<const std::uint8_t> request, Time now, Answer& answer) {
  const std::uint8_t command = request[0];
  const bool sized = (command & size_indicated) != 0;
  answer[0] = 0x60;
  name_object(answer);
  if ((command & expedited) != 0) {
    // Without a size the object's own length counts: the client means as many of the four bytes as the object has.
    const std::size_t size = sized ? 4u - ((command >> 2) & 3u) : 4u;
    bytes_.assign(request.begin() + 4, request.begin() + 4 + static_cast<std::ptrdiff_t>(size));
    if (!sized) {
      std::vector<std::uint8_t> present;
      if (target_.sdo_read(index_, sub_, present) == Abort::none && !present.empty() && present.size() < 4) bytes_.resize(present.size());
    }
    return target_.sdo_write(index_, sub_, bytes_, now);
  }
  announced_ = sized ? get_u32(request.data() + 4) : 0;
  if (announced_ > max_download) return Abort::too_long;
  const Abort code = target_.sdo_may_write(index_, sub_, announced_);
  if (code != Abort::none) return code;
  bytes_.clear();
  transfer_ = Transfer::download;
  toggle_ = false;
  return Abort::none;
}

Abort SdoServer::download_segment(std::span<const std::uint8_t> request, Time now, Answer& answer) {
  const std::uint8_t command = request[0];
  if (((command & toggle_bit) != 0) != toggle_) return Abort::toggle;
  const std::size_t size = segment_bytes - ((command >> 1) & 7u);
  bytes_.insert(bytes_.end(), request.begin() + 1, request.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  if (bytes_.size() > max_download || (announced_ != 0 && bytes_.size() > announced_)) return Abort::too_long;
  answer[0] = static_cast<std::uint8_t>(0x20 | (toggle_ ? toggle_bit : 0));
  toggle_ = !toggle_;
  if ((command & 1) == 0) return Abort::none;
  transfer_ = Transfer::none;
  if (announced_ != 0 && bytes_.size() < announced_) return Abort::too_short;
  return target_.sdo_write(index_, sub_, bytes_, now);
}

bool SdoServer::expired(Time now, Answer& answer) {
  if (transfer_ == Transfer::none || now - last_ <= segment_timeout) return false;
  abort(Abort::timeout, answer);
  return true;
}

void SdoServer::abort(Abort code, Answer& answer) {
  transfer_ = Transfer::none;
  answer.fill(0);
  answer[0] = cs_abort << 5;
  name_object(answer);
  put_u32(static_cast<std::uint32_t>(code), answer.data() + 4);
}

void SdoServer::name_object(Answer& answer) const {
  answer[1] = static_cast<std::uint8_t>(index_ & 0xFF);
  answer[2] = static_cast<std::uint8_t>(index_ >> 8);
  answer[3] = sub_;
}

}  // namespace lf::devices
