#include "hal/vehicle/doctor/examination.hpp"

#include <algorithm>
#include <array>
#include <fstream>

namespace lf::hal::doctor {

const char* name(Grade grade) {
  static constexpr std::array<const char*, 3> names{"good", "note", "BAD"};
  return names[static_cast<std::size_t>(grade)];
}

Examinations examine(const VehicleConfig& config, const Machine& machine) {
  Examinations found;
  examine_bus(config, machine, found);
  examine_camera(config, machine, found);
  examine_realtime(config, machine, found);
  examine_clock(config, machine, found);
  examine_places(config, machine, found);
  examine_people(config, machine, found);
  examine_arm(config, machine, found);
  return found;
}

std::string text_of(const Examinations& found) {
  std::size_t width = 0;
  for (const Examination& one : found) width = std::max(width, one.subject.size());
  std::string text;
  for (const Examination& one : found) {
    const std::string grade = name(one.grade);
    text += one.subject + std::string(width - one.subject.size() + 2, ' ') + grade + std::string(6 - grade.size(), ' ') + one.found + "\n";
    if (one.grade != Grade::good && !one.remedy.empty()) text += std::string(width + 8, ' ') + "to do: " + one.remedy + "\n";
  }
  return text;
}

std::string first_line(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

}  // namespace lf::hal::doctor
