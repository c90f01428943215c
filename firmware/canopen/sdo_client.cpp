#include "firmware/canopen/sdo_client.hpp"

#include <algorithm>

#include "firmware/canopen/cob_id.hpp"
#include "firmware/canopen/codec.hpp"

namespace lf::canopen {

namespace {

// Command specifiers, bits 5-7 of the first byte.
constexpr std::uint8_t answer_upload_segment = 0;
constexpr std::uint8_t answer_download_segment = 1;
constexpr std::uint8_t answer_upload = 2;
constexpr std::uint8_t answer_download = 3;
constexpr std::uint8_t answer_abort = 4;

constexpr std::uint8_t specifier(const CanFrame& frame) { return static_cast<std::uint8_t>(frame.data[0] >> 5); }
constexpr std::size_t segment_bytes = 7;

}  // namespace

bool SdoClient::upload(std::uint16_t index, std::uint8_t sub) {
  if (busy()) return false;
  begin(Phase::upload_initiate, index, sub);
  size_ = 0;
  return true;
}

bool SdoClient::download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> value) {
  if (busy() || value.empty() || value.size() > capacity) return false;
  begin(Phase::download_initiate, index, sub);
  std::copy(value.begin(), value.end(), buffer_.begin());
  size_ = value.size();
  return true;
}

bool SdoClient::download(std::uint16_t index, std::uint8_t sub, std::uint32_t value, std::uint8_t width) {
  if (width > 4) return false;
  CanFrame bytes;
  put(bytes, 0, value);
  return download(index, sub, std::span<const std::uint8_t>(bytes.data.data(), width));
}

std::uint32_t SdoClient::number() const {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(size_, 4); ++i) number |= static_cast<std::uint32_t>(buffer_[i]) << (8 * i);
  return number;
}

void SdoClient::reset() {
  state_ = State::idle;
  request_due_ = false;
  abort_due_ = false;
}

void SdoClient::begin(Phase phase, std::uint16_t index, std::uint8_t sub) {
  state_ = State::busy;
  phase_ = phase;
  index_ = index;
  sub_ = sub;
  request_due_ = true;
  server_aborted_ = false;
  size_known_ = false;
  toggle_ = false;
  abort_code_ = 0;
  position_ = 0;
  ++stats_.transfers;
}

void SdoClient::fail(std::uint32_t code) {
  state_ = State::failed;
  abort_code_ = code;
  request_due_ = false;
}

void SdoClient::abort(std::uint32_t code) {
  fail(code);
  abort_due_ = true;
  aborted_index_ = index_;
  aborted_sub_ = sub_;
  own_abort_code_ = code;
  ++stats_.own_aborts;
}

void SdoClient::finish() {
  state_ = State::done;
  ++stats_.completed;
}

bool SdoClient::same_object(const CanFrame& frame) const {
  return get<std::uint16_t>(frame, 1) == index_ && get<std::uint8_t>(frame, 3) == sub_;
}

bool SdoClient::on_frame(const CanFrame& frame, Time now) {
  // An answer before its request left is an answer to something else.
  if (!busy() || request_due_) {
    ++stats_.unexpected;
    return false;
  }
  const std::uint8_t command = specifier(frame);
  const bool initiates = phase_ == Phase::upload_initiate || phase_ == Phase::download_initiate;
  if ((initiates || command == answer_abort) && !same_object(frame)) {
    ++stats_.wrong_object;
    return false;
  }
  deadline_ = now + timeout_;
  if (command == answer_abort) {
    ++stats_.server_aborts;
    server_aborted_ = true;
    fail(get<std::uint32_t>(frame, 4));
    return true;
  }
  switch (phase_) {
    case Phase::upload_initiate: on_upload_initiated(frame); break;
    case Phase::upload_segment: on_upload_segment(frame); break;
    case Phase::download_initiate: on_download_initiated(frame); break;
    case Phase::download_segment: on_download_segment(frame); break;
  }
  return true;
}

void SdoClient::on_upload_initiated(const CanFrame& frame) {
  if (specifier(frame) != answer_upload) return abort(sdo_abort::command);
  const bool expedited = (frame.data[0] & 0x02u) != 0;
  size_known_ = (frame.data[0] & 0x01u) != 0;
  if (expedited) {
    size_ = size_known_ ? 4u - ((frame.data[0] >> 2) & 0x03u) : 4u;
    std::copy_n(frame.data.begin() + 4, size_, buffer_.begin());
    return finish();
  }
  position_ = size_known_ ? get<std::uint32_t>(frame, 4) : 0;
  if (position_ > capacity) return abort(sdo_abort::out_of_memory);
  phase_ = Phase::upload_segment;
  request_due_ = true;
}

void SdoClient::on_upload_segment(const CanFrame& frame) {
  if (specifier(frame) != answer_upload_segment) return abort(sdo_abort::command);
  if (((frame.data[0] & 0x10u) != 0) != toggle_) return abort(sdo_abort::toggle);
  const std::size_t bytes = segment_bytes - ((frame.data[0] >> 1) & 0x07u);
  const bool last = (frame.data[0] & 0x01u) != 0;
  if (size_ + bytes > capacity) return abort(sdo_abort::out_of_memory);
  std::copy_n(frame.data.begin() + 1, bytes, buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += bytes;
  if (size_known_ && size_ > position_) return abort(sdo_abort::length_high);
  // An empty segment that is not the last would let a broken server hold us for ever.
  if (!last && bytes == 0) return abort(sdo_abort::length);
  if (last && size_known_ && size_ != position_) return abort(sdo_abort::length);
  if (last) return finish();
  toggle_ = !toggle_;
  request_due_ = true;
}

void SdoClient::on_download_initiated(const CanFrame& frame) {
  if (specifier(frame) != answer_download) return abort(sdo_abort::command);
  if (size_ <= 4) return finish();
  phase_ = Phase::download_segment;
  request_due_ = true;
}

void SdoClient::on_download_segment(const CanFrame& frame) {
  if (specifier(frame) != answer_download_segment) return abort(sdo_abort::command);
  if (((frame.data[0] & 0x10u) != 0) != toggle_) return abort(sdo_abort::toggle);
  position_ += last_segment_;
  if (position_ >= size_) return finish();
  toggle_ = !toggle_;
  request_due_ = true;
}

bool SdoClient::poll(Time now, CanFrame& frame) {
  if (busy() && !request_due_ && now >= deadline_) {
    ++stats_.timeouts;
    abort(sdo_abort::timeout);
  }
  if (!abort_due_ && !request_due_) return false;
  frame = empty_frame(cob_id::sdo_request + node_, 8);
  if (abort_due_) {
    frame.data[0] = answer_abort << 5;
    put(frame, 1, aborted_index_);
    put(frame, 3, aborted_sub_);
    put(frame, 4, own_abort_code_);
    abort_due_ = false;
    return true;
  }
  make_request(frame);
  request_due_ = false;
  deadline_ = now + timeout_;
  return true;
}

void SdoClient::make_request(CanFrame& frame) {
  const std::uint8_t toggle_bit = toggle_ ? 0x10 : 0x00;
  switch (phase_) {
    case Phase::upload_initiate: frame.data[0] = 0x40; break;
    case Phase::upload_segment: frame.data[0] = static_cast<std::uint8_t>(0x60 | toggle_bit); return;
    case Phase::download_segment: return make_download_segment(frame);
    case Phase::download_initiate:
      if (size_ <= 4) {
        frame.data[0] = static_cast<std::uint8_t>(0x23 | ((4 - size_) << 2));
        std::copy_n(buffer_.begin(), size_, frame.data.begin() + 4);
      } else {
        frame.data[0] = 0x21;
        put(frame, 4, static_cast<std::uint32_t>(size_));
      }
      break;
  }
  put(frame, 1, index_);
  put(frame, 3, sub_);
}

void SdoClient::make_download_segment(CanFrame& frame) {
  last_segment_ = static_cast<std::uint8_t>(std::min(segment_bytes, size_ - position_));
  const bool last = position_ + last_segment_ == size_;
  frame.data[0] = static_cast<std::uint8_t>((toggle_ ? 0x10 : 0x00) | ((segment_bytes - last_segment_) << 1) | (last ? 0x01 : 0x00));
  std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(position_), last_segment_, frame.data.begin() + 1);
}

}  // namespace lf::canopen
