#include <memory>

#include "host_sim/app/command.hpp"
#include "shared/version/version.hpp"

namespace lf::app {

void add_version(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("version", "Version, source revision and compiler");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print JSON");
  command->callback([json, &action] {
    action = [json] {
      if (*json) {
        print_json({{"version", version()}, {"revision", revision()}, {"compiler", compiler()}, {"build", build_type()}});
      } else {
        print("%s\n", version_line("lanternfish").c_str());
      }
      return int(done);
    };
  });
}

}  // namespace lf::app
