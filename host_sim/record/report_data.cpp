#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "host_sim/record/report_parts.hpp"

namespace lf::record {
namespace {

// Times fall on whole milliseconds, and six digits hold them to 1000 s; longer runs get nine.
std::string number(double value, const char* format = "%.6g") { return std::isfinite(value) ? formatted(format, value) : "null"; }
std::string time_number(double t_s) { return number(t_s, "%.9g"); }

// A JSON string that no parser of HTML takes for the end of its element.
std::string text(const std::string& words) {
  std::string quoted = nlohmann::json(words).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = quoted.find('<'); at != std::string::npos; at = quoted.find('<', at)) quoted.replace(at, 1, "\\u003c");
  return quoted;
}

template <class Range, class Write>
std::string list(const Range& range, Write write) {
  std::string json = "[";
  for (const auto& each : range) {
    if (json.size() > 1) json += ',';
    json += write(each);
  }
  return json + "]";
}

std::string pose(const Pose& of) {
  std::string json = "[";
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) json += (json.size() > 1 ? "," : "") + number(of.matrix()(row, column), "%.9g");
  }
  return json + "]";
}

std::string vector(const Vec3& v) { return "[" + number(v.x()) + "," + number(v.y()) + "," + number(v.z()) + "]"; }

// A list of times that several series share, and the samples that are kept of it: all, or two of each piece.
class TimeBase {
 public:
  explicit TimeBase(std::vector<double> t_s) : t_s_(std::move(t_s)) {
    const std::size_t pieces = most_samples / 2, count = t_s_.size();
    if (count <= most_samples) return;
    for (std::size_t i = 0; i < pieces; ++i) starts_.push_back(i * count / pieces);
    starts_.push_back(count);
  }

  bool is(const std::vector<double>& t_s) const { return t_s == t_s_; }
  bool whole() const { return starts_.empty(); }

  // The first and last time of each piece.
  std::vector<double> times() const {
    return whole() ? t_s_ : ends_of([](const double* first, const double* last) { return std::pair(*first, *(last - 1)); }, t_s_);
  }
  // As many values as times: of each piece the lowest and the highest, in their order. A piece without a number stays a gap.
  std::vector<double> spikes(std::vector<double> value) const {
    value.resize(t_s_.size(), unknown);
    if (whole()) return value;
    return ends_of(
        [](const double* first, const double* last) {
          const double *lowest = nullptr, *highest = nullptr;
          for (const double* v = first; v != last; ++v) {
            if (!std::isfinite(*v)) continue;
            if (lowest == nullptr || *v < *lowest) lowest = v;
            if (highest == nullptr || *v > *highest) highest = v;
          }
          if (lowest == nullptr) return std::pair(unknown, unknown);
          return lowest < highest ? std::pair(*lowest, *highest) : std::pair(*highest, *lowest);
        },
        value);
  }
  // The values at times().
  std::vector<double> ends(std::vector<double> value) const {
    value.resize(t_s_.size(), unknown);
    return whole() ? value : ends_of([](const double* first, const double* last) { return std::pair(*first, *(last - 1)); }, value);
  }

 private:
  template <class Choose>
  std::vector<double> ends_of(Choose choose, const std::vector<double>& value) const {
    std::vector<double> kept;
    for (std::size_t i = 0; i + 1 < starts_.size(); ++i) {
      const auto [first, second] = choose(value.data() + starts_[i], value.data() + starts_[i + 1]);
      kept.push_back(first);
      kept.push_back(second);
    }
    return kept;
  }

  std::vector<double> t_s_;
  std::vector<std::size_t> starts_;
};

class TimeBases {
 public:
  std::size_t index_of(const std::vector<double>& t_s) {
    const auto found = std::find_if(bases_.begin(), bases_.end(), [&](const TimeBase& base) { return base.is(t_s); });
    if (found != bases_.end()) return static_cast<std::size_t>(found - bases_.begin());
    bases_.emplace_back(t_s);
    return bases_.size() - 1;
  }
  const TimeBase& operator[](std::size_t i) const { return bases_[i]; }
  std::string json() const {
    return list(bases_, [](const TimeBase& base) { return list(base.times(), time_number); });
  }

 private:
  std::vector<TimeBase> bases_;
};

// From the first to the last of all that has a time.
std::pair<double, double> span_of(const ReportData& data) {
  double from = std::numeric_limits<double>::infinity(), to = -from;
  const auto take = [&](double t_s) {
    if (!std::isfinite(t_s)) return;
    from = std::min(from, t_s);
    to = std::max(to, t_s);
  };
  for (const PhaseRecord& phase : data.result.phases) {
    take(phase.start_s);
    take(phase.end_s);
  }
  for (const FaultRecord& fault : data.result.faults) {
    take(fault.t_s);
    take(fault.last_s);
  }
  for (const ReportChart& chart : data.charts) {
    for (const ReportSeries& series : chart.series) std::for_each(series.t_s.begin(), series.t_s.end(), take);
  }
  std::for_each(data.motion.t_s.begin(), data.motion.t_s.end(), take);
  if (!(from <= to)) return {0, 1};
  return {from, to > from ? to : from + 1};
}

std::string phase_json(const PhaseRecord& phase) {
  return "{\"name\":" + text(phase.name) + ",\"from\":" + time_number(phase.start_s) + ",\"to\":" + time_number(phase.end_s) + "}";
}

std::string fault_json(const FaultRecord& fault) {
  const double last_s = std::isfinite(fault.last_s) ? std::max(fault.last_s, fault.t_s) : fault.t_s;
  return "{\"t\":" + time_number(fault.t_s) + ",\"last\":" + time_number(last_s) + ",\"times\":" + std::to_string(fault.times) +
         ",\"text\":" + text(fault.text) + ",\"reaction\":" + text(fault.reaction) + "}";
}

std::string chart_json(const ReportChart& chart, TimeBases& bases) {
  const std::vector<std::size_t> colours = series_colours(chart);
  std::size_t i = 0;
  const std::string series = list(chart.series, [&](const ReportSeries& each) {
    const std::size_t base = bases.index_of(each.t_s);
    return "{\"name\":" + text(each.name) + ",\"t\":" + std::to_string(base) + ",\"colour\":" + std::to_string(colours[i++]) +
           ",\"dashed\":" + (each.dashed ? "true" : "false") + ",\"limits\":[" + number(each.limits.low) + "," + number(each.limits.high) +
           "]" + ",\"v\":" + list(bases[base].spikes(each.value), [](double value) { return number(value); }) + "}";
  });
  return "{\"title\":" + text(chart.title) + ",\"unit\":" + text(chart.unit) + ",\"series\":" + series + "}";
}

// Reflectance to what a screen shows of it.
std::string paint(const scene::Shape& shape) {
  return list(shape.albedo, [](float share) { return number(std::pow(std::clamp(double(share), 0.0, 1.0), 1 / 2.2), "%.3g"); });
}

std::string solid_json(const scene::Shape& shape) {
  const Solid solid = solid_of(shape);
  std::string vertices, faces;
  for (const Vec3& vertex : solid.vertices_m) {
    for (int axis = 0; axis < 3; ++axis) vertices += (vertices.empty() ? "" : ",") + number(vertex[axis], "%.4f");
  }
  for (const auto& triangle : solid.triangles) {
    for (const std::uint32_t corner : triangle) faces += (faces.empty() ? "" : ",") + std::to_string(corner);
  }
  return "{\"c\":" + paint(shape) + ",\"v\":[" + vertices + "],\"f\":[" + faces + "]}";
}

const char* name_of(PartGroup group) {
  switch (group) {
    case PartGroup::robot: return "robot";
    case PartGroup::vehicle: return "vehicle";
    case PartGroup::panel: return "panel";
    case PartGroup::controls: return "controls";
  }
  return "robot";
}

std::string part_json(const ReportPart& part) {
  std::vector<scene::Shape> visible;
  std::copy_if(part.shapes.begin(), part.shapes.end(), std::back_inserter(visible),
               [](const scene::Shape& shape) { return shape.visible; });
  return "{\"name\":" + text(part.name) + ",\"group\":\"" + name_of(part.group) + "\",\"parent\":" + std::to_string(part.parent) +
         ",\"at\":" + pose(part.parent_from_part) + ",\"by\":" + std::to_string(part.coordinate) +
         ",\"slides\":" + (part.slides ? "true" : "false") + ",\"axis\":" + vector(part.axis) + ",\"solids\":" + list(visible, solid_json) +
         "}";
}

std::string motion_json(const ReportMotion& motion, TimeBases& bases) {
  if (motion.parts.empty() || motion.t_s.empty()) return "null";
  const std::size_t base = bases.index_of(motion.t_s);
  const std::string coordinates = list(motion.coordinates, [&](const ReportCoordinate& each) {
    return "{\"name\":" + text(each.name) + ",\"v\":" + list(bases[base].ends(each.value), [](double value) { return number(value); }) +
           "}";
  });
  return "{\"t\":" + std::to_string(base) + ",\"coordinates\":" + coordinates + ",\"parts\":" + list(motion.parts, part_json) +
         ",\"tool\":{\"part\":" + std::to_string(motion.tool_part) + ",\"at\":" + vector(motion.tool_m) + "}}";
}

bool has_times(const PhaseRecord& phase) { return std::isfinite(phase.start_s) && std::isfinite(phase.end_s); }

}  // namespace

std::string page_data(const ReportData& data) {
  TimeBases bases;
  const StageView view = stage_view(data);
  const auto [from, to] = span_of(data);
  std::vector<PhaseRecord> phases;
  std::copy_if(data.result.phases.begin(), data.result.phases.end(), std::back_inserter(phases), has_times);
  std::vector<FaultRecord> faults;
  std::copy_if(data.result.faults.begin(), data.result.faults.end(), std::back_inserter(faults),
               [](const FaultRecord& fault) { return std::isfinite(fault.t_s); });
  std::string json = "{\"from\":" + time_number(from) + ",\"to\":" + time_number(to) + ",\n\"phases\":" + list(phases, phase_json) +
                     ",\n\"faults\":" + list(faults, fault_json);
  json += ",\n\"charts\":" + list(data.charts, [&](const ReportChart& chart) { return chart_json(chart, bases); });
  json += ",\n\"motion\":" + motion_json(data.motion, bases);
  json += ",\n\"view\":{\"from_base\":" + pose(view.view_from_base) + ",\"radius\":" + number(view.radius_m) +
          ",\"yaw\":" + number(view.yaw_rad) + ",\"pitch\":" + number(view.pitch_rad) + "}";
  return json + ",\n\"times\":" + bases.json() + "}";
}

}  // namespace lf::record
