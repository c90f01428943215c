#include <algorithm>
#include <memory>

#include "hal/config/nearest.hpp"
#include "host_sim/app/bench_areas.hpp"
#include "host_sim/app/command.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace {

struct Options {
  std::vector<std::string> names;
  bool json = false;
};

void refuse_unknown(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const BenchArea& area : bench_areas()) known.push_back(area.name);
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string list;
    for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
    const std::string near = config::suggestion(name, known);
    throw InputError("no benchmark '" + name + "'" + (near.empty() ? "; there are " + list : near));
  }
}

Json json_of(const bench::Row& row) {
  return {{"name", row.name},   {"ours", row.ours}, {"peer", row.peer}, {"peer_name", row.peer_name},
          {"ratio", row.ratio}, {"unit", row.unit}, {"note", row.note}};
}

int run_bench(const Options& options) {
  if (bench_areas().empty()) throw EnvironmentError("this build has no benchmarks: configure it with -DLANTERNFISH_TESTS=ON");
  refuse_unknown(options.names);
  Json all = Json::array();
  if (!options.json) print("%-44s %12s %12s %8s  %-10s %s\n", "", "ours", "peer", "ratio", "unit", "peer");
  for (const BenchArea& area : bench_areas()) {
    if (!options.names.empty() && std::find(options.names.begin(), options.names.end(), area.name) == options.names.end()) continue;
    for (const bench::Row& row : area.run()) {
      if (options.json) {
        all.push_back(json_of(row));
        continue;
      }
      print("%-44s %12.5g %12.5g %8.2f  %-10s %s%s%s\n", row.name.c_str(), row.ours, row.peer, row.ratio, row.unit.c_str(),
            row.peer_name.c_str(), row.note.empty() ? "" : "; ", row.note.c_str());
    }
  }
  if (options.json) print_json(all);
  return done;
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("bench", "Measure our algorithms beside their peers, interleaved in one process");
  auto options = std::make_shared<Options>();
  std::string names;
  for (const BenchArea& area : bench_areas()) names += (names.empty() ? "" : ", ") + std::string(area.name);
  command->add_option("NAME", options->names, "Which: " + (names.empty() ? "none in this build" : names) + " (default all)");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &action] { action = [options] { return run_bench(*options); }; });
}

}  // namespace lf::app
