// What a run came to: result.json, as a struct.
//
// A number that is unknown is NaN here and null in the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lf::record {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct PhaseRecord {
  std::string name;
  double start_s = unknown;
  double end_s = unknown;
  std::string outcome;  // "done", "retried", "failed", "aborted": the mission's word
};

struct TaskRecord {
  std::string task;              // "turn_valve" or "press_button"
  std::string valve{};           // turn_valve: its name, where the panel has several
  std::string button;            // press_button: its name
  int presses = 0;               // press_button: clicks counted by the button itself
  double target_deg = unknown;   // turn_valve
  double reached_deg = unknown;  // turn_valve: the true angle
  bool done = false;
  double travel_mm = unknown;  // press_button: how far it went in, as the core felt it
  bool click_felt = false;     // press_button: by the core
  std::string failure{};       // press_button: what the core found wrong with it; empty: nothing
};

// Against the simulator's truth, scored outside the core.
struct ErrorRecord {
  double plane_normal_deg = unknown;
  double plane_offset_mm = unknown;
  double panel_over_doubt = unknown;  // place and attitude along and about each axis, the worst, over what the core keeps clear for it
  double valve_base_mm = unknown;
  double handle_angle_deg = unknown;
  double cloud_truth_median_mm = unknown;  // to the true surface
  double cloud_truth_p95_mm = unknown;
  double peak_rms_px = unknown;           // of all columns, those at edges of the scene included
  double peak_rms_smooth_px = unknown;    // of those whose stripe lies on one smooth surface
  double peak_rms_clear_px = unknown;     // of those of them that stand clear of the noise, away from marks
  double peak_bound_px = unknown;         // the least rms that noise and speckle allow there
  double peak_rms_at_marks_px = unknown;  // of those that stand clear of the noise, near marks
  double peak_recall = unknown;           // 0..1
  double peaks_false = unknown;           // 0..1 of all peaks: on no piece of the stripe
  double peaks_elsewhere = unknown;       // 0..1 of the visible columns: on another piece than the brightest, and not on that
};

// By the core's own looks, the largest of each, and presses: what they leave over that an exact calibration would explain. Not held against the truth.
struct CalibrationRecord {
  double marker_side_percent = unknown;  // of the marker's square on the scanned plane: side over the surveyed one, less 100; signed
  double marker_corners_mm = unknown;    // rms of its corners about a square
  double plane_bend_mm = unknown;        // what neighbouring points of the plane err by together
  double panel_shift_mm = unknown;       // of the panel from look to look; unknown with one look
  double faces_off_mm = unknown;         // how far behind the place where they were seen the presses felt the buttons' faces, in the mean
  std::string doubt{};                   // all that does not fit; empty: all does
  std::string remedy{};
};

struct DockingRecord {
  int attempts = 0;
  double offset_mm = unknown;
  double angle_deg = unknown;
  double peak_force_n = unknown;
};

struct ContactRecord {
  double peak_force_n = unknown;
  std::uint64_t unintended_contacts = 0;
};

// Microseconds of thread CPU time.
struct TimesRecord {
  double p50 = unknown, p99 = unknown, p999 = unknown, max = unknown;
};

struct CoreRecord {
  std::optional<std::uint64_t> heap_calls;  // none: this build does not count them
  std::uint64_t controller_bytes = 0;
  TimesRecord tick_us;
  TimesRecord frame_us;
  std::map<std::string, std::uint64_t> rejected_inputs;
};

struct BusRecord {
  double load_percent = unknown;             // mean, with the stuff bits that these frames have
  double load_unstuffed_percent = unknown;   // the same frames without stuff bits
  double load_worst_case_percent = unknown;  // with as many as any content of their length could need: what a bus is planned for
  std::uint64_t frames = 0;
  std::uint64_t errors = 0;
};

struct HostRecord {
  std::string isa;
  int threads = 0;
  std::string build;
};

struct TimeRecord {
  double simulated_s = unknown;
  double wall_s = unknown;
  double real_time_factor = unknown;
};

struct FailureRecord {
  std::string phase;
  std::string reason;
  std::string cause{};   // by name; empty where `reason` says it all
  std::string remedy{};  // what to do about it; may be empty
  std::string seen{};    // what the look that failed saw, where it was one
};

// A fault that the core reported, with what it did about it, or an error message of a node. Equal ones that follow each other are one record.
struct FaultRecord {
  double t_s = unknown;     // of the first
  double last_s = unknown;  // of the last
  std::uint64_t times = 1;
  std::string step;
  std::string fault;     // its kind: "drive fault", or "emcy"
  std::string text;      // in words, with its cause
  std::string reaction;  // the core's; empty for an error message
};

// How a run came about.
struct ProvenanceRecord {
  std::string date_utc;          // when it began: "2026-11-24T21:34:07Z"
  std::string command;           // that began it
  std::vector<std::string> set;  // its --set, as they were given
  std::string scenario_file;     // of which scenario.yaml, beside this, was resolved
  std::string experiment;        // SHA-256 over experiment.json: resolved scenario, seed, program and files
};

// What the seed drew, by key, the unit in its name: one number, or one an axis or a joint.
using DrawnRecord = std::map<std::string, std::vector<double>>;

inline constexpr std::size_t most_faults = 200;

struct RunResult {
  std::string scenario;
  std::uint64_t seed = 0;
  std::string version;
  ProvenanceRecord provenance;
  bool success = false;
  std::optional<FailureRecord> failure;
  std::optional<FailureRecord> expected_failure;  // that the scenario asked for, and got
  bool false_success = false;                     // the mission believes it succeeded, and the truth disagrees
  std::vector<FaultRecord> faults;                // in the order of their times, at most `most_faults`
  std::uint64_t faults_left_out = 0;              // beyond these
  std::vector<std::string> faults_not_made;       // of the scenario: the run had ended before, or never came to their step
  DrawnRecord drawn;
  std::vector<PhaseRecord> phases;
  std::vector<TaskRecord> tasks;
  ErrorRecord errors;
  std::optional<CalibrationRecord> calibration;  // none: no look found plane and marker
  std::optional<DockingRecord> docking;          // when the vehicle swims
  ContactRecord contact;
  CoreRecord core;
  BusRecord bus;
  HostRecord host;
  TimeRecord time;
  std::string digest;
};

// nearest-rank percentiles of `values_us`; all unknown when there are none.
TimesRecord times_record(std::vector<double> values_us);

// JSON text, two blanks of indentation, keys in the order above, a newline at the end. Text that is not UTF-8 has its bad bytes replaced.
std::string result_json(const RunResult& result);

// The reverse, for a campaign that goes on where it stopped. Throws InputError for text that is not such a result; keys that are missing keep
// their defaults, unknown ones are ignored.
RunResult parse_result_json(const std::string& text, const std::string& name_for_errors);
RunResult read_result_file(const std::filesystem::path& path);

}  // namespace lf::record
