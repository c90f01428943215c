#include <memory>

#include "host_sim/app/command.hpp"
#include "host_sim/campaign/campaign_file.hpp"
#include "host_sim/campaign/comparison.hpp"

namespace lf::app {

namespace {

struct Options {
  std::string before, after;
  std::vector<std::string> across;
  bool json = false;
};

int compare_campaigns(const Options& options) {
  const campaign::Campaign before = campaign::read_campaign(options.before), after = campaign::read_campaign(options.after);
  const campaign::Comparison comparison = compare(before, after, options.across, options.before);
  if (options.json) {
    print_json(json_of(comparison));
  } else {
    print("%s", text_of(comparison).c_str());
  }
  return comparison.worse() || !comparison.doubt.empty() ? failed : done;
}

}  // namespace

void add_compare(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("compare", "Compare two campaigns: what got better or worse beyond chance");
  auto options = std::make_shared<Options>();
  command->add_option("BEFORE", options->before, "The earlier campaign's folder, or its campaign.json")->required();
  command->add_option("AFTER", options->after, "The later one's")->required();
  command->add_option("--across", options->across, "Keys of the scenario that may differ")->delimiter(',');
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &action] { action = [options] { return compare_campaigns(*options); }; });
}

}  // namespace lf::app
