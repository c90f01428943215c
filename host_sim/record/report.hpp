// report.html: one self-contained file that shows a run to a person. Opens from disk, refers to nothing outside, and shows its facts without scripts.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/record/result.hpp"
#include "shared/messages/panel_vision.hpp"

namespace lf::record {

struct ReportPicture {
  std::string title;              // "Stripe at 7.32 s"
  std::string caption;            // one sentence; may be empty
  std::vector<std::uint8_t> png;  // overlay_peaks + encode_png make one
};

struct ReportSeries {
  std::string name;
  std::vector<double> t_s;    // ascending
  std::vector<double> value;  // as many; not a number is a gap
  bool dashed = false;        // for a target, after the series that it belongs to and in its colour
};

struct ReportChart {
  std::string title;  // "Joint positions"
  std::string unit;   // "rad"
  std::vector<ReportSeries> series;
};

// A row of the table of errors.
struct ReportError {
  std::string name;
  double value = unknown;
  double aim = unknown;  // unknown: no aim, the value stands alone
  std::string unit;
  bool at_least = false;  // the aim is a lower bound (recall)
};

struct ReportData {
  RunResult result;
  std::string command;                                          // that reproduces the run
  std::vector<std::pair<std::string, std::string>> conditions;  // drawn by the seed: "friction torque", "1.82 N m"
  std::vector<ReportError> errors;                              // usually report_errors(result, attenuation)
  std::vector<ReportPicture> pictures;
  std::vector<CloudPoint> cloud;  // base frame; thinned to 40,000 points
  PlaneFit fit;
  std::vector<ReportChart> charts;
  std::vector<std::string> notes;  // what a reader should know, one sentence each: "the disk filled up at 12.3 s"
};

// The errors of a run beside the project's aims for one run; those of cloud and peaks grow with the water's attenuation from clear to 0.8 per m.
std::vector<ReportError> report_errors(const RunResult& result, double attenuation_per_m);

// Deterministic: equal data, equal bytes. All text is escaped. 1..4 MB for a usual run.
std::string report_html(const ReportData& data);

}  // namespace lf::record
