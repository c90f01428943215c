#include "firmware/canopen/boot_sequence.hpp"

#include <algorithm>

#include "firmware/canopen/cob_id.hpp"

namespace lf::canopen {

namespace {

// Lost or garbled on the way: worth another try. Everything else is the node's considered answer.
bool worth_retry(std::uint32_t abort_code) {
  return abort_code == sdo_abort::timeout || abort_code == sdo_abort::toggle || abort_code == sdo_abort::command;
}

bool says_absent(std::uint32_t abort_code) { return abort_code == sdo_abort::no_object || abort_code == sdo_abort::no_sub_index; }

constexpr std::uint16_t mode_display = 0x6061;

}  // namespace

BootSequence::BootSequence(const NetworkConfig& config)
    : boot_up_timeout_(config.boot_up_timeout), start_timeout_(config.start_timeout), retries_allowed_(config.retries) {}

void BootSequence::begin(const BootContext& context, Time now) {
  plan_ = context.drive != nullptr ? drive_boot_plan() : io_boot_plan();
  report_ = NodeBoot{};
  report_.state = BootState::running;
  report_.node = context.node;
  report_.steps = static_cast<std::uint16_t>(plan_.size());
  phase_ = Phase::reset;
  exchange_ = Exchange::next;
  retries_left_ = retries_allowed_;
  nmt_ = NmtCommand::reset_communication;
  nmt_due_ = true;
  deadline_ = now + boot_up_timeout_;
}

void BootSequence::fail(BootFailure failure) {
  phase_ = Phase::failed;
  nmt_due_ = false;
  report_.state = BootState::failed;
  report_.failure = failure;
}

std::optional<NmtCommand> BootSequence::take_nmt() {
  if (!nmt_due_) return std::nullopt;
  nmt_due_ = false;
  if (phase_ == Phase::reset) phase_ = Phase::await_boot_up;
  if (phase_ == Phase::start) phase_ = Phase::await_operational;
  return nmt_;
}

bool BootSequence::retry() {
  if (retries_left_ == 0) return false;
  --retries_left_;
  ++report_.retries;
  return true;
}

void BootSequence::on_boot_up(Time now, SdoClient& sdo) {
  if (phase_ == Phase::reset || phase_ == Phase::idle || phase_ == Phase::failed || phase_ == Phase::done) return;
  // Again while being configured: it forgot. A second reset command may have crossed a late first boot-up, so this is tried again, boundedly.
  if (phase_ != Phase::await_boot_up && !(phase_ == Phase::configure && report_.step == 0)) {
    if (report_.retries >= retries_allowed_) return fail(BootFailure::rebooted);
    ++report_.retries;
  }
  sdo.reset();
  phase_ = Phase::configure;
  exchange_ = Exchange::next;
  nmt_due_ = false;
  report_.step = 0;
  retries_left_ = retries_allowed_;
  deadline_ = now;
}

void BootSequence::on_operational(Time now) {
  if (phase_ != Phase::await_operational) return;
  phase_ = Phase::await_data;
  deadline_ = now + start_timeout_;
}

void BootSequence::on_process_data() {
  if (phase_ != Phase::await_data) return;
  phase_ = Phase::done;
  report_.state = BootState::done;
}

void BootSequence::release(Time now) {
  if (phase_ != Phase::configured) return;
  phase_ = Phase::start;
  nmt_ = NmtCommand::start;
  nmt_due_ = true;
  retries_left_ = retries_allowed_;
  deadline_ = now + start_timeout_;
}

void BootSequence::await(Time now, Phase again, Duration timeout, BootFailure failure) {
  if (now < deadline_) return;
  if (!retry()) return fail(failure);
  phase_ = again;
  nmt_due_ = true;
  deadline_ = now + timeout;
}

void BootSequence::step(Time now, SdoClient& sdo, const BootContext& context) {
  switch (phase_) {
    case Phase::await_boot_up: return await(now, Phase::reset, boot_up_timeout_, BootFailure::no_boot_up);
    case Phase::await_operational: return await(now, Phase::start, start_timeout_, BootFailure::not_operational);
    case Phase::await_data:
      if (now >= deadline_) fail(BootFailure::no_process_data);
      return;
    case Phase::configure: break;
    default: return;
  }
  if (sdo.busy()) return;
  if (exchange_ != Exchange::next) take_result(sdo);
  if (phase_ == Phase::configure && exchange_ == Exchange::next) start_step(sdo, context);
}

void BootSequence::start_step(SdoClient& sdo, const BootContext& context) {
  while (report_.step < plan_.size() && !boot_value(plan_[report_.step], context)) ++report_.step;
  if (report_.step >= plan_.size()) {
    phase_ = Phase::configured;
    report_.index = 0;
    report_.sub = 0;
    return;
  }
  const BootStep& step = plan_[report_.step];
  report_.index = step.index;
  report_.sub = step.sub;
  mode_reads_left_ = mode_reads;
  written_ = *boot_value(step, context);
  const bool writes = step.action == BootAction::write || step.action == BootAction::set_mode;
  exchange_ = writes ? Exchange::writing : Exchange::reading;
  if (writes) sdo.download(step.index, step.sub, written_, step.width);
  if (!writes) sdo.upload(step.index, step.sub);
}

void BootSequence::take_result(SdoClient& sdo) {
  const BootStep& step = plan_[report_.step];
  if (sdo.state() != SdoClient::State::done) return take_sdo_failure(sdo, step);
  if (exchange_ != Exchange::writing) return take_read(sdo, step);
  exchange_ = Exchange::reading_back;
  sdo.upload(step.action == BootAction::set_mode ? mode_display : step.index, step.sub);
}

void BootSequence::take_sdo_failure(const SdoClient& sdo, const BootStep& step) {
  const std::uint32_t code = sdo.state() == SdoClient::State::failed ? sdo.abort_code() : sdo_abort::timeout;
  if (step.optional && says_absent(code)) return next_step();
  report_.abort_code = code;
  if (worth_retry(code) && retry()) {
    exchange_ = Exchange::next;
    return;
  }
  fail(code == sdo_abort::timeout && !sdo.aborted_by_server() ? BootFailure::sdo_timeout : BootFailure::sdo_aborted);
}

void BootSequence::take_read(SdoClient& sdo, const BootStep& step) {
  const std::size_t bytes = sdo.value().size();
  const bool length_fits = step.width == 0 || bytes == step.width || (!sdo.size_known() && bytes > step.width);
  if (!length_fits) return fail(BootFailure::wrong_length);
  const std::uint32_t width_mask = step.width >= 4 || step.width == 0 ? 0xFFFFFFFFu : (1u << (8 * step.width)) - 1u;
  const std::uint32_t read = sdo.number() & width_mask;
  report_.read = read;

  if (step.action == BootAction::record) {
    record(sdo, step);
    return next_step();
  }
  if (step.action == BootAction::invalidate_pdo && exchange_ == Exchange::reading) {
    if ((read & cob_id::pdo_invalid) != 0) return next_step();
    written_ = read | cob_id::pdo_invalid;
    exchange_ = Exchange::writing;
    sdo.download(step.index, step.sub, written_, step.width);
    return;
  }
  const std::uint32_t mask = step.mask & width_mask;
  if ((read & mask) == (written_ & mask)) {
    if (step.index == 0x1000) report_.device_type = read;
    return next_step();
  }
  if (step.action == BootAction::set_mode && mode_reads_left_ > 0) {
    --mode_reads_left_;
    sdo.upload(mode_display, step.sub);
    return;
  }
  report_.expected = written_ & mask;
  fail(step.action == BootAction::check ? BootFailure::wrong_identity : BootFailure::wrong_readback);
}

void BootSequence::record(const SdoClient& sdo, const BootStep& step) {
  if (step.index == 0x1018 && step.sub == 1) report_.vendor = sdo.number();
  if (step.index == 0x1018 && step.sub == 2) report_.product = sdo.number();
  if (step.index == 0x6076) report_.rated_torque_mnm = sdo.number();
  if (step.index != 0x1008) return;
  const auto text = sdo.value();
  const std::size_t length = std::min(text.size(), report_.device_name.size() - 1);
  report_.device_name = {};
  for (std::size_t i = 0; i < length && text[i] != 0; ++i) {
    const bool printable = text[i] >= 0x20 && text[i] < 0x7F;
    report_.device_name[i] = printable ? static_cast<char>(text[i]) : '?';
  }
}

void BootSequence::next_step() {
  ++report_.step;
  report_.abort_code = 0;
  exchange_ = Exchange::next;
  retries_left_ = retries_allowed_;
}

}  // namespace lf::canopen
