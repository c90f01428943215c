#include "hal/vehicle/commissioner.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <utility>

#include "firmware/arm/actuator.hpp"
#include "hal/config/share.hpp"
#include "hal/vehicle/tick_clock.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/input_error.hpp"

namespace lf::hal {

namespace {

// `lanternfishd commission` gives up after 5 s, which it counts from a little before: who ordered it is still there.
constexpr Duration begin_within = Duration::from_s(4);
// A file that could not be written, for a full disk for instance, is tried again so much later.
constexpr Duration forget_again_after = Duration::from_ms(2000);
// Of a control period, 4 ms, several: a commissioning that cannot begin comes back at once.
constexpr Duration refused_within = Duration::from_ms(50);

Json refused(const std::string& why) { return {{"ok", false}, {"why", why}}; }

std::string now_text() {
  char day[32] = "";
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(day, sizeof day, "%Y-%m-%d %H:%M", &utc);
  return day;
}

// Where that cannot be done the joints stay in doubt there, and the next daemon says so.
void lift(const Marks& marks, const std::string& file) {
  try {
    (void)write_offsets(file, marks.lifted_from(config::read_homing_file(file, marks.before.names)));
  } catch (const InputError&) {
  }
}

}  // namespace

Commissioner::Commissioner(const VehicleConfig& config, LoopRings& rings, Log log)
    : core_(config.core.controller), file_(config.machine.homing_file), rings_(rings), log_(std::move(log)) {
  file_is_shipped_ = !file_.empty() && config::is_shipped(file_);
  const std::filesystem::path folder = std::filesystem::path(config.machine.file).parent_path();
  const ArmDescription arm = load_arm_urdf(config::find_file(config.machine.arm_urdf, folder));
  names_ = arm.names();
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    backlash_rad_[i] = arm.joints[i].backlash_rad;
    motors_[i] = motor_of(arm.joints[i], core_.transmissions[i].counts_per_rev);
  }
}

// The control thread has ended before: what was lent is the owner's again.
Commissioner::~Commissioner() {
  for (Controller* old = nullptr; rings_.old_cores.pop(old);) delete old;
  if (Controller* untaken = nullptr; rings_.cores.pop(untaken)) {
    (void)untaken;  // still held by core_given_
  } else {
    (void)core_given_.release();  // the control loop has it
  }
}

// While a new core waits for its reset the old one goes on to hear its drives: what they lose meanwhile has to leave the file. A report from before a commissioning's
// end does not know what it has found.
void Commissioner::hear(const ControlReport& report) {
  if (report.cores_taken != cores_taken_ || report.commissionings_ended != ended_) return;
  if (stage_ == Stage::installing) {
    zero_lost_ = either(zero_lost_, report.zeros_lost);
    forget_in_file(report.zeros_lost);
  } else if (!busy()) {
    jaw_doubted_ = report.jaw_doubted;
    lose_zeros(report.zeros_lost);
  }
}

void Commissioner::lose_zeros(const JointSet& lost) {
  zero_lost_ = lost;
  forget_in_file(lost);
}

void Commissioner::forget_in_file(const JointSet& lost) {
  JointSet to_forget{};
  for (std::size_t i = 0; i < to_forget.size(); ++i) to_forget[i] = lost[i] && !forgotten_[i];
  if (!any(to_forget) || file_.empty() || file_is_shipped_ || forgetting_ != nullptr || monotonic_now() < try_again_) return;
  auto forgetting = std::make_shared<Forgetting>();
  forgetting->joints = to_forget;
  const bool posted = worker_.post([forgetting, file = file_, names = names_] {
    std::string problem;
    try {
      config::HomingOffsets offsets = config::read_homing_file(file, names);
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (forgetting->joints[i]) offsets.forget_zero(i);
      }
      config::write_homing_file(file, offsets);
    } catch (const InputError& error) {
      problem = error.what();
    }
    const std::lock_guard lock(forgetting->mutex);
    forgetting->problem = problem;
    forgetting->done = true;
  });
  if (posted) forgetting_ = forgetting;  // otherwise the next report says it again
}

// A zero that was lost is no longer in the file: a daemon that is started anew must not trust it.
void Commissioner::note_forgotten() {
  const std::shared_ptr<Forgetting> forgetting = forgetting_;
  if (forgetting == nullptr) return;
  const std::lock_guard lock(forgetting->mutex);
  if (!forgetting->done) return;
  forgetting_ = nullptr;
  const bool told = try_again_ != Time{} && forgetting->joints == last_tried_;
  const bool gone = forgetting->problem.empty();
  last_tried_ = forgetting->joints;
  try_again_ = gone ? Time{} : monotonic_now() + forget_again_after;
  Json names = Json::array();
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (!forgetting->joints[i]) continue;
    forgotten_[i] = gone;
    names.push_back(names_[i]);
  }
  if (told && !gone) return;
  Json line{{"t_s", monotonic_now().s()}, {"kind", "zeros_lost"}, {"joints", names}, {"file", file_}};
  if (!forgetting->problem.empty())
    line["why"] = forgetting->problem + ": commission them before the daemon is started anew; the file is tried again meanwhile";
  log_(line);
}

std::string Commissioner::unknown_joints() const {
  JointSet unknown{};
  for (std::size_t i = 0; i < names_.size(); ++i) unknown[i] = zero_lost_[i] || disowned_[i] || !core_.network.drives[i].may_have_power();
  return names_of(unknown, names_);
}

std::optional<std::string> Commissioner::begin(const CommissionOrder& order, Time ordered) {
  if (stage_ != Stage::idle || answer_) return "a commissioning is under way";
  if (file_.empty()) return "'homing.file' names no file to write the zeros to";
  if (file_is_shipped_) return "'homing.file' is the shipped " + file_ + ": copy it, and name the copy";
  for (std::size_t i = 0; order.here && i < names_.size(); ++i) {
    const ArmModel::Joint& joint = core_.arm.joint(i);
    if (order.joints[i] && (joint.lower_rad > 0 || joint.upper_rad < 0))
      return "the " + names_[i] + " cannot stand at its zero, which its range leaves out: commission it against its stop";
  }
  order_ = order;
  ordered_ = ordered;
  called_off_.clear();
  prepared_ = std::make_shared<Prepared>();
  Commissioning::Config setup;
  setup.arm = core_.arm;
  setup.names = names_;
  setup.network = core_.network;
  // It presses with thousandths of each drive's own rating, and reads them back as such.
  for (canopen::DriveSetup& drive : setup.network.drives) drive.described_torque_unm = 0;
  setup.transmissions = core_.transmissions;
  setup.joints = order.joints;
  setup.backlash_rad = backlash_rad_;
  setup.here = order.here;
  setup.moved = order.moved;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    bool& known = setup.network.drives[i].zero_known;
    known = known && !zero_lost_[i];
  }
  const std::size_t jaw = core_.arm.jaw_joint();
  setup.jaw_known = setup.network.drives[jaw].zero_known && !jaw_doubted_ && !disowned_[jaw];
  const bool posted = worker_.post([prepared = prepared_, setup, file = file_, lost = zero_lost_, core = core_]() mutable {
    std::string problem;
    try {
      prepared->marks = Marks::of(setup.joints, lost, config::read_homing_file(file, setup.names), core);
      for (std::size_t i = 0; i < setup.names.size(); ++i) {
        if (prepared->marks.before.has_earlier_zero(i)) setup.zero_in_file[i] = prepared->marks.before.zero_counts[i];
      }
      problem = write_offsets(file, prepared->marks.marked);
      // It may have the marks all the same, where its folder alone could not be brought to the disk.
      if (!problem.empty()) (void)write_offsets(file, prepared->marks.before);
    } catch (const InputError& error) {
      problem = error.what();
    }
    auto commissioning = problem.empty() ? std::make_unique<Commissioning>(setup) : nullptr;
    const std::lock_guard lock(prepared->mutex);
    prepared->problem = problem;
    prepared->commissioning = std::move(commissioning);
    prepared->done = true;
  });
  if (!posted) return "too much is waiting to be done";
  stage_ = Stage::preparing;
  return std::nullopt;
}

std::optional<std::string> Commissioner::why_no_power() const {
  if (stage_ == Stage::idle) return std::nullopt;
  // The core is exchanged at rest only: in the next control period, or after the reset that a stop wants first.
  if (stage_ == Stage::installing)
    return "the zeros that were found are not in the core yet: try again, after a `reset` if the mission has ended";
  return "not while the arm is being commissioned: `abort` calls it off";
}

std::optional<Json> Commissioner::answer() { return std::exchange(answer_, std::nullopt); }

void Commissioner::step() {
  note_forgotten();
  for (Controller* old = nullptr; rings_.old_cores.pop(old);) {
    delete old;
    (void)core_given_.release();  // in the control loop now
    ++cores_taken_;
    last_ = std::exchange(outcome_, nullptr);
    stage_ = Stage::idle;
  }
  for (CommissioningResult result; rings_.commissioned.pop(result);) take_back(result);
  if (stage_ == Stage::preparing) lend();
  if (stage_ == Stage::lending && monotonic_now() - lent_ >= refused_within) {
    stage_ = Stage::running;
    last_ = {{"state", "under way"}};
    answer_ = Json{{"ok", true}, {"standing", "commissioning"}};
  }
  if (stage_ == Stage::storing) install();
}

bool Commissioner::call_off_before_it_moves(const std::string& why) {
  const bool may_be_waiting = stage_ == Stage::preparing || stage_ == Stage::lending || stage_ == Stage::running;
  if (!may_be_waiting || !called_off_.empty()) return false;
  called_off_ = why;
  if (stage_ == Stage::preparing)
    answer_ = refused(disown(why));
  else
    rings_.loan_is_void.store(true, std::memory_order_release);
  return true;
}

// By the order's own words the earlier zeros are wrong, whether or not it moved anything.
std::string Commissioner::disown(const std::string& why) {
  std::string text = why + ": nothing moves";
  if (!order_.moved) return text;
  disowned_ = either(disowned_, order_.joints);
  return text + ". These joints' zeros have moved, as the order says, and take no power until they are commissioned: " +
         names_of(order_.joints, names_);
}

// A disk that takes its time must not have the arm move when nobody expects it any more.
void Commissioner::drop_late() {
  if (!called_off_.empty() || monotonic_now() - ordered_ < begin_within) return;
  called_off_ = "the homing file could not be written in time, look at its disk";
  answer_ = refused(disown(called_off_));
}

void Commissioner::lend() {
  drop_late();
  {
    const std::lock_guard lock(prepared_->mutex);
    if (!prepared_->done) return;
    if (!prepared_->problem.empty() && called_off_.empty()) answer_ = refused(prepared_->problem + old_zero_stays());
    commissioning_ = std::move(prepared_->commissioning);
    marks_ = prepared_->marks;
  }
  if (!called_off_.empty() && commissioning_ != nullptr) {
    commissioning_.reset();
    // Zeros that have moved stay in doubt.
    if (!order_.moved) (void)worker_.post([marks = marks_, file = file_] { lift(marks, file); });
  }
  stage_ = commissioning_ != nullptr ? Stage::lending : Stage::idle;
  last_ = nullptr;
  lent_ = monotonic_now();
  if (commissioning_ == nullptr) return;
  rings_.loan_is_void.store(false, std::memory_order_release);
  (void)rings_.commissionings.push({commissioning_.get(), ordered_ + begin_within});
}

// Of an order that was refused: it changes nothing.
std::string Commissioner::old_zero_stays() const {
  return order_.moved ? ". Nothing was begun: the core still trusts the old zero of a joint that has moved" : "";
}

void Commissioner::not_begun() {
  if (called_off_.empty() && monotonic_now() - ordered_ >= begin_within) called_off_ = "the control thread did not begin it in time";
  const bool is_void = !called_off_.empty();
  const std::string why =
      is_void ? disown(called_off_) : "the arm is not at rest without power: `abort` or `reset` first" + old_zero_stays();
  if (!is_void || !order_.moved) (void)worker_.post([marks = marks_, file = file_] { lift(marks, file); });
  if (stage_ == Stage::running) return end_with({{"state", "failed"}, {"why", why}});
  answer_ = refused(why);
  stage_ = Stage::idle;
}

void Commissioner::take_back(const CommissioningResult& result) {
  const std::unique_ptr<Commissioning> ended = std::move(commissioning_);
  if (!result.begun) return not_begun();
  ++ended_;
  if (last_.is_null()) answer_ = Json{{"ok", true}, {"standing", "commissioning"}};
  const bool well = ended->state() == Commissioning::State::done;
  const JointSet lost = ended->zeros_lost();
  JointSet lost_again{};
  for (std::size_t i = 0; i < names_.size(); ++i) lost_again[i] = well && ended->found()[i] && lost[i];
  std::string failed = well ? "" : std::string(ended->failure());
  if (any(lost_again)) failed = "a drive lost its position again after its zero was found: " + names_of(lost_again, names_);
  without_power_ = ended->without_power();
  zero_lost_ = either(zero_lost_, lost);
  store(*ended, failed);
}

void Commissioner::end_with(const Json& outcome) {
  last_ = outcome;
  stage_ = Stage::idle;
  write_down(outcome);
}

void Commissioner::write_down(const Json& outcome) const {
  Json line{{"t_s", monotonic_now().s()}, {"kind", "commissioning"}};
  line.update(outcome);
  log_(line);
}

void Commissioner::give(Prepared& prepared, const std::string& problem, const TakenOver& taken, const config::HomingOffsets& offsets,
                        std::unique_ptr<Controller> core) {
  const std::lock_guard lock(prepared.mutex);
  prepared.problem = problem;
  prepared.taken = taken;
  prepared.offsets = offsets;
  prepared.core = std::move(core);
  prepared.done = true;
}

Commissioned Commissioner::findings_of(const Commissioning& ended) const {
  Commissioned all{ended.found(), ended.zero_counts(), ended.friction_found(), ended.friction(), "", ended.places_rad()};
  all.how = (order_.here ? "in the jig, " : "at its stop, ") + now_text() + " UTC";
  all.moved_rad = ended.moved_rad();
  all.lost = either(either(ended.lost_before_found(), ended.zeros_lost()), zero_lost_);
  for (std::size_t i = 0; i < names_.size(); ++i) all.found[i] = all.found[i] && !ended.zeros_lost()[i];
  return all;
}

// The file is read again: it keeps what this commissioning has not found. Of one that failed only the doubt is kept, in zeros found elsewhere and in joints
// that rub.
void Commissioner::store(const Commissioning& ended, const std::string& failed) {
  stage_ = Stage::storing;
  last_ = {{"state", "under way"}};  // also of one that ended before its begin was told
  prepared_ = std::make_shared<Prepared>();
  const Commissioned commissioned = findings_of(ended);
  for (std::size_t i = 0; i < names_.size(); ++i) still_lost_[i] = zero_lost_[i] && !commissioned.found[i];
  JointSet disowned{};  // their earlier zeros are wrong, by the order's own words, and no other was found
  for (std::size_t i = 0; i < names_.size(); ++i) disowned[i] = order_.moved && order_.joints[i] && !commissioned.found[i];
  bool changes_core = failed.empty() || any(disowned) || any(ended.zeros_lost()) || leaves_doubt(ended, motors_, names_);
  const bool posted =
      worker_.post([prepared = prepared_, file = file_, commissioned, core = core_, names = names_, motors = motors_, marks = marks_,
                    still_lost = still_lost_, failed = failed, moved_as_ordered = order_.moved, disowned, changes_core]() mutable {
        std::string problem;
        TakenOver taken;
        config::HomingOffsets offsets;
        try {
          offsets = marks.lifted_from(config::read_homing_file(file, names));
          const JointSet gone = with_a_zero(commissioned.lost, offsets);
          forget_lost(commissioned.lost, offsets, core);
          const config::HomingOffsets before = offsets;
          if (changes_core) taken = take_over(core.arm, commissioned, motors, offsets);
          if (failed.empty() && !moved_as_ordered) failed = found_elsewhere(taken, names);
          const JointSet doubted = changes_core ? either(disowned, doubted_joints(commissioned, taken, offsets)) : JointSet{};
          const std::string unwritten_for = write_offsets(file, failed.empty() ? offsets : with_doubts(before, doubted, offsets, core));
          problem = ending(failed, unwritten_for, doubted, gone, marks);
          if (problem.empty()) {
            const std::vector<std::string> older =
                config::leave_out_doubtful(offsets, motors);  // the file's, of joints that were not commissioned now
            taken.left_out.insert(taken.left_out.end(), older.begin(), older.end());
            const std::vector<std::string> cut = cut_off(offsets, commissioned.found, core);
            taken.left_out.insert(taken.left_out.end(), cut.begin(), cut.end());
            use_zeros(offsets, commissioned.found, still_lost, core);
          } else {
            tell_moved(taken, names);
            deny_power(doubted, core, offsets);
          }
        } catch (const InputError& error) {
          // The file cannot be read, so that what was found cannot be compared with it.
          const JointSet denied = either(either(commissioned.found, disowned), commissioned.lost);
          problem = (failed.empty() ? "" : failed + ". ") + "Nothing was written: " + error.what() +
                    (any(denied) ? ". These joints take no power until they are commissioned again: " + names_of(denied, names) : "");
          deny_power(denied, core, offsets);
          changes_core = changes_core || any(denied);
        }
        prepared->found = commissioned.found;
        give(*prepared, problem, taken, offsets, changes_core ? std::make_unique<Controller>(core) : nullptr);
      });
  if (!posted)
    end_with({{"state", "failed"}, {"why", "nothing was written: too much is waiting to be done"}, {"without_power", without_power_}});
}

void Commissioner::give_core(std::unique_ptr<Controller> core, const Json& outcome) {
  stage_ = Stage::installing;
  outcome_ = outcome;
  write_down(outcome);
  core_given_ = std::move(core);
  (void)rings_.cores.push(core_given_.get());
}

void Commissioner::install() {
  const std::lock_guard lock(prepared_->mutex);
  if (!prepared_->done) return;
  std::string why;
  for (const std::string& sentence : prepared_->taken.left_out) why += (why.empty() ? "these joints take no power: " : "; ") + sentence;
  if (!prepared_->problem.empty()) {
    for (std::size_t i = 0; i < names_.size() && prepared_->core; ++i)
      core_.network.drives[i].zero_known = core_.network.drives[i].zero_known && prepared_->offsets.known[i] && !zero_lost_[i];
    const Json failed{
        {"state", "failed"}, {"why", prepared_->problem + (why.empty() ? "" : "; " + why)}, {"without_power", without_power_}};
    return prepared_->core ? give_core(std::move(prepared_->core), failed) : end_with(failed);
  }
  use_zeros(prepared_->offsets, prepared_->found, still_lost_, core_);
  Json zeros = Json::object(), moved = Json::object();
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const canopen::DriveSetup& drive = core_.network.drives[i];  // what the core has, whatever else the file says
    if (prepared_->offsets.known[i]) forgotten_[i] = false;
    if (prepared_->found[i] && drive.zero_known) disowned_[i] = false;
    if (drive.zero_known) zeros[names_[i]] = drive.encoder_zero_counts;
    if (prepared_->taken.moved_rad[i] > 0) moved[names_[i]] = prepared_->taken.moved_rad[i];
  }
  zero_lost_ = still_lost_;
  Json outcome{{"state", "done"}, {"zeros", zeros}, {"friction", friction_json(prepared_->offsets)}, {"file", file_}};
  if (!moved.empty()) outcome["moved_rad"] = moved;
  if (!why.empty()) outcome.update({{"state", "failed"}, {"why", why}, {"without_power", without_power_}});
  give_core(std::move(prepared_->core), outcome);
}

}  // namespace lf::hal
