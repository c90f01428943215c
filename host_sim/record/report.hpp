// report.html: one self-contained file that shows a run to a person. Opens from disk, refers to nothing outside, and shows its facts without scripts.
//
// With scripts its charts answer a pointer and the robot moves in 3D, both at one moment that a slider, a player and the charts' cursor set. What they show is
// in the page as JSON (element "run"): docs/report.md.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/record/result.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/scene/scene.hpp"

namespace lf::record {

struct ReportPicture {
  std::string title;               // "Stripe at 7.32 s"
  std::string caption;             // one sentence; may be empty
  std::vector<std::uint8_t> file;  // a PNG or a JPEG: overlay_peaks + encode_jpeg make one
};

// Lines across a chart at the lowest and the highest value that a series may have; unknown: no line.
struct ReportLimits {
  double low = unknown, high = unknown;
};

struct ReportSeries {
  std::string name;
  std::vector<double> t_s;    // ascending
  std::vector<double> value;  // as many; not a number is a gap
  bool dashed = false;        // for a target, after the series that it belongs to and in its colour
  ReportLimits limits{};
};

struct ReportChart {
  std::string title;  // "Joint positions"
  std::string unit;   // "rad"
  std::vector<ReportSeries> series;
};

// Parts that are shown or hidden together.
enum class PartGroup : std::uint8_t { robot, vehicle, panel, controls };  // controls: what of the panel moves

// A rigid part: it hangs on an earlier one, and one coordinate turns or slides it.
struct ReportPart {
  std::string name;
  PartGroup group = PartGroup::robot;
  int parent = -1;                           // index of an earlier part; -1: the base frame
  Pose parent_from_part = Pose::Identity();  // with the coordinate at 0
  int coordinate = -1;                       // index into ReportMotion::coordinates; -1: it does not move on its parent
  bool slides = false;                       // along the axis, m; else about it, rad
  Vec3 axis = Vec3::UnitZ();                 // in its own frame
  std::vector<scene::Shape> shapes;          // in its own frame; those that are not visible are left out
};

struct ReportCoordinate {
  std::string name;
  std::vector<double> value;  // rad or m, as many as there are times
};

// How the robot truly moved, for the 3D view. No parts: nothing is known of it.
struct ReportMotion {
  std::vector<ReportPart> parts;
  std::vector<double> t_s;  // ascending
  std::vector<ReportCoordinate> coordinates;
  std::size_t tool_part = 0;  // the part that carries the tool point
  Vec3 tool_m = Vec3::Zero();
  Pose base_from_panel = Pose::Identity();  // the view's frame where there is no cloud
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
  std::vector<ReportChart> charts;  // what is the simulator's truth says so in its title or in its series' names
  ReportMotion motion;
  std::vector<std::string> notes;  // what a reader should know, one sentence each: "the disk filled up at 12.3 s"
};

// The errors of a run beside the project's aims for one run; those of cloud and peaks grow with the water's attenuation from clear to 0.8 per m.
std::vector<ReportError> report_errors(const RunResult& result, double attenuation_per_m);

// Deterministic: equal data, equal bytes. All text is escaped. 2 to 4 MB for a usual run.
std::string report_html(const ReportData& data);

}  // namespace lf::record
