// A scenario with its overrides (comment lines "#--set key=value"): read, drawn, and made into a core's configuration, or refused with an InputError.
#include <cmath>
#include <string_view>

#include "host_sim/scenario/draw.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/input_error.hpp"
#include "tests/fuzz/input.hpp"

namespace {

std::vector<std::string> overrides_of(std::string_view text) {
  constexpr std::string_view mark = "#--set ";
  std::vector<std::string> overrides;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (line.starts_with(mark)) overrides.emplace_back(line.substr(mark.size()));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return overrides;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static lf::fuzz::MemoryFile file;
  try {
    const auto overrides = overrides_of({reinterpret_cast<const char*>(data), size});
    const lf::scenario::Scenario scenario = lf::scenario::load_scenario(file.holding({data, size}), overrides);
    const lf::scenario::Sample sample = lf::scenario::draw(scenario, 1);
    lf::fuzz::expect(sample.docking_shift_m.allFinite() && std::isfinite(sample.attenuation_per_m), "what is drawn is a number");
    (void)lf::scenario::make_nominal(scenario, sample.lamps_lit);
  } catch (const lf::InputError& refused) {
    lf::fuzz::expect(refused.what()[0] != '\0', "a refusal says why");
  }
  return 0;
}
