#include "firmware/canopen/boot_sequence.hpp"

#include <algorithm>
#include <cstdint>

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
  report_ = NodeBoot{};
  report_.state = BootState::running;
  report_.node = context.node;
  report_.steps = static_cast<std::uint16_t>(boot_step_count(context));
  if (context.drive != nullptr) {
    report_.quick_stop_option = context.drive->quick_stop_option;
    report_.rated_torque_unm = context.drive->profile.rated_torque_unm;
  }
  phase_ = Phase::reset;
  exchange_ = Exchange::next;
  retries_left_ = retries_allowed_;
  resets_unanswered_ = 0;
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
  if (phase_ == Phase::reset) {
    phase_ = Phase::await_boot_up;
    ++resets_unanswered_;
  }
  if (phase_ == Phase::start) phase_ = Phase::await_operational;
  return nmt_;
}

bool BootSequence::retry() {
  if (retries_left_ == 0) return false;
  --retries_left_;
  ++report_.retries;
  return true;
}

bool BootSequence::on_boot_up(Time now, SdoClient& sdo) {
  const bool caused = resets_unanswered_ > 0;
  if (caused) --resets_unanswered_;
  if (phase_ == Phase::reset || phase_ == Phase::idle || phase_ == Phase::failed || phase_ == Phase::done) return caused;
  // Again while being configured: it forgot. A second reset command may have crossed a late first boot-up, so this is tried again, boundedly.
  if (phase_ != Phase::await_boot_up && !(phase_ == Phase::configure && report_.step == 0)) {
    if (report_.retries >= retries_allowed_) {
      fail(BootFailure::rebooted);
      return caused;
    }
    ++report_.retries;
  }
  sdo.reset();
  phase_ = Phase::configure;
  exchange_ = Exchange::next;
  nmt_due_ = false;
  report_.step = 0;
  report_.substitutions.clear();
  retries_left_ = retries_allowed_;
  deadline_ = now;
  return caused;
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
  if (exchange_ != Exchange::next) take_result(sdo, context);
  if (phase_ == Phase::configure && exchange_ == Exchange::next) start_step(sdo, context);
}

void BootSequence::start_step(SdoClient& sdo, const BootContext& of_node) {
  BootContext context = of_node;
  context.rated_torque_unm = report_.rated_torque_unm;
  while (report_.step < report_.steps && !boot_value(boot_step(report_.step, context), context)) ++report_.step;
  if (report_.step >= report_.steps) {
    phase_ = Phase::configured;
    report_.index = 0;
    report_.sub = 0;
    return;
  }
  step_ = boot_step(report_.step, context);
  report_.index = step_.index;
  report_.sub = step_.sub;
  mode_reads_left_ = mode_reads;
  fallback_tried_ = false;
  written_ = *boot_value(step_, context);
  const bool blind = step_.action == BootAction::set_mode;
  exchange_ = blind ? Exchange::writing : Exchange::reading;
  if (blind) sdo.download(step_.index, step_.sub, written_, step_.width);
  if (!blind) sdo.upload(step_.index, step_.sub);
}

void BootSequence::take_result(SdoClient& sdo, const BootContext& context) {
  if (sdo.state() != SdoClient::State::done) return take_sdo_failure(sdo, context);
  if (exchange_ != Exchange::writing) return take_read(sdo, context);
  exchange_ = Exchange::reading_back;
  sdo.upload(step_.action == BootAction::set_mode ? mode_display : step_.index, step_.sub);
}

void BootSequence::take_sdo_failure(SdoClient& sdo, const BootContext& context) {
  const std::uint32_t code = sdo.state() == SdoClient::State::failed ? sdo.abort_code() : sdo_abort::timeout;
  if (says_absent(code) && (step_.optional || substituted(context))) return next_step();
  report_.abort_code = code;
  if (worth_retry(code) && retry()) {
    exchange_ = Exchange::next;
    return;
  }
  if (exchange_ == Exchange::writing && write_fallback(code, sdo, context)) return;
  if (step_.best_effort && sdo.aborted_by_server()) {
    report_.abort_code = 0;
    return next_step();
  }
  if (exchange_ == Exchange::writing) report_.expected = written_;
  if (code == sdo_abort::read_only) return fail(BootFailure::read_only);
  fail(code == sdo_abort::timeout && !sdo.aborted_by_server() ? BootFailure::sdo_timeout : BootFailure::sdo_aborted);
}

// The drive has no such object, and its profile says what does its work.
bool BootSequence::substituted(const BootContext& context) {
  if (context.drive == nullptr) return false;
  const Absence* absence = context.drive->profile.absence(step_.value);
  if (absence == nullptr || absence->by == Substitute::none || absence->by == Substitute::other_object) return false;
  return report_.substitutions.push_back({step_.index, step_.sub, absence->by});
}

// 605A and 6007 take few values on many drives. The second choice of the profile is tried once.
bool BootSequence::write_fallback(std::uint32_t code, SdoClient& sdo, const BootContext& context) {
  const bool refused = code == sdo_abort::bad_value || code == sdo_abort::too_high || code == sdo_abort::too_low;
  if (!refused || fallback_tried_ || context.drive == nullptr) return false;
  const DriveProfile& profile = context.drive->profile;
  std::int16_t fallback = 0;
  if (step_.value == BootValue::quick_stop_option) fallback = profile.quick_stop_fallback;
  if (step_.value == BootValue::abort_option) fallback = profile.abort_fallback;
  if (fallback == 0) return false;
  fallback_tried_ = true;
  written_ = static_cast<std::uint16_t>(fallback);
  exchange_ = Exchange::writing;
  sdo.download(step_.index, step_.sub, written_, step_.width);
  return true;
}

void BootSequence::take_read(SdoClient& sdo, const BootContext& context) {
  const std::size_t bytes = sdo.value().size();
  const bool length_fits = step_.width == 0 || bytes == step_.width || (!sdo.size_known() && bytes > step_.width);
  if (!length_fits) return step_.best_effort ? next_step() : fail(BootFailure::wrong_length);
  const std::uint32_t width_mask = step_.width >= 4 || step_.width == 0 ? 0xFFFFFFFFu : (1u << (8 * step_.width)) - 1u;
  const std::uint32_t read = sdo.number() & width_mask;
  report_.read = read;

  if (step_.action == BootAction::record) return record(sdo, context);
  if (step_.action == BootAction::invalidate_pdo && exchange_ == Exchange::reading) written_ = read | cob_id::pdo_invalid;
  const std::uint32_t mask = step_.mask & width_mask;
  if ((read & mask) == (written_ & mask)) {
    if (step_.index == 0x1000) report_.device_type = read;
    if (step_.value == BootValue::quick_stop_option) report_.quick_stop_option = static_cast<std::int16_t>(written_);
    return next_step();
  }
  if (step_.action == BootAction::set_mode && mode_reads_left_ > 0) {
    --mode_reads_left_;
    sdo.upload(mode_display, step_.sub);
    return;
  }
  const bool writes = step_.action == BootAction::write || step_.action == BootAction::invalidate_pdo;
  if (writes && exchange_ == Exchange::reading) {
    exchange_ = Exchange::writing;
    sdo.download(step_.index, step_.sub, written_, step_.width);
    return;
  }
  if (step_.best_effort) return next_step();
  report_.expected = written_ & mask;
  const bool identity = step_.value == BootValue::vendor || step_.value == BootValue::product || step_.index == 0x1000;
  if (step_.action != BootAction::check) return fail(BootFailure::wrong_readback);
  fail(identity ? BootFailure::wrong_identity : BootFailure::wrong_setting);
}

void BootSequence::record(const SdoClient& sdo, const BootContext& context) {
  if (step_.index == 0x1018 && step_.sub == 1) report_.vendor = sdo.number();
  if (step_.index == 0x1018 && step_.sub == 2) report_.product = sdo.number();
  if (step_.value == BootValue::rated_torque) return record_rating(sdo.number(), context);
  if (step_.index == 0x1008) {
    const auto text = sdo.value();
    const std::size_t length = std::min(text.size(), report_.device_name.size() - 1);
    report_.device_name = {};
    for (std::size_t i = 0; i < length && text[i] != 0; ++i) {
      const bool printable = text[i] >= 0x20 && text[i] < 0x7F;
      report_.device_name[i] = printable ? static_cast<char>(text[i]) : '?';
    }
  }
  next_step();
}

// A torque whose unit is not known is no torque: contact, grip and overload are judged by it.
void BootSequence::record_rating(std::uint32_t number, const BootContext& context) {
  const DriveProfile& profile = context.drive->profile;
  const std::uint64_t rated_unm = std::uint64_t{number} * profile.rated_torque_unit_unm;
  if (rated_unm == 0 || rated_unm > UINT32_MAX) return fail(BootFailure::no_rating);
  const std::uint64_t stated_unm = profile.rated_torque_unm;
  const std::uint64_t apart_unm = rated_unm > stated_unm ? rated_unm - stated_unm : stated_unm - rated_unm;
  if (stated_unm != 0 && apart_unm > stated_unm / 10) {
    report_.expected = static_cast<std::uint32_t>(stated_unm / profile.rated_torque_unit_unm);
    return fail(BootFailure::wrong_rating);
  }
  report_.rated_torque_unm = static_cast<std::uint32_t>(rated_unm);
  if (context.drive->is_other_motor(report_.rated_torque_unm)) {
    report_.expected = context.drive->described_torque_unm / profile.rated_torque_unit_unm;
    return fail(BootFailure::other_motor);
  }
  next_step();
}

void BootSequence::next_step() {
  ++report_.step;
  report_.abort_code = 0;
  exchange_ = Exchange::next;
  retries_left_ = retries_allowed_;
}

}  // namespace lf::canopen
