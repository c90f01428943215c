#include <cmath>
#include <memory>

#include "host_sim/app/campaign_options.hpp"
#include "host_sim/app/command.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace {

int campaign(const CampaignOptions& options) {
  if (!std::isfinite(options.into))  // CLI11's range lets it through
    throw InputError("--into takes a share from 0 to 1");
  if (!options.seeds.empty() && (options.shard != "1/1" || !options.kinds.empty()))
    throw InputError("--shard and --kinds go with --faults or --ranges; of --seeds, name those that are wanted");
  if (options.faults) return fault_campaign(options);
  if (options.ranges) return range_campaign(options);
  if (options.seeds.empty()) throw InputError("--seeds is required, or --faults, or --ranges");
  return seed_campaign(options);
}

}  // namespace

void add_campaign(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("campaign", "Run a scenario over many seeds and tabulate what came of them");
  auto options = std::make_shared<CampaignOptions>();
  command->add_option("SCENARIO", options->scenario, "A file or a shipped name")->required();
  CLI::Option* seeds = command->add_option("--seeds", options->seeds, "Which to fly: seeds and ranges as 1,2,7-9, both ends included");
  CLI::Option* faults =
      command->add_flag("--faults", options->faults, "The fault matrix: every kind of fault in every step, on given sight");
  CLI::Option* ranges = command->add_flag("--ranges", options->ranges, "Every key of the scenario, drawn over its documented range");
  faults->excludes(ranges);
  seeds->excludes(faults)->excludes(ranges);
  command->add_option("--draws", options->draws, "--ranges: draws of each key by itself")->check(CLI::Range(0, 1000))->needs(ranges);
  command->add_option("--many", options->many, "--ranges: runs with eight keys at once")->check(CLI::Range(0, 100000))->needs(ranges);
  const CLI::Validator without_blanks(
      [](std::string& name) {
        name.erase(0, name.find_first_not_of(' '));
        name.erase(name.find_last_not_of(' ') + 1);
        return std::string();
      },
      "", "");
  CLI::Option* const kinds =
      command->add_option("--kinds", options->kinds, "--faults: these kinds only; --ranges: these keys only; as 'estop,silent'")
          ->delimiter(',')
          ->transform(without_blanks);
  CLI::Option* const steps = command->add_option("--steps", options->steps, "--faults: these steps only, as 'turn;let go'")
                                 ->delimiter(';')
                                 ->transform(without_blanks)
                                 ->needs(faults);
  CLI::Option* const rows =
      command->add_option("--rows", options->rows, "These rows of the matrix only, by name, as 'turn: overcurrent elbow;boot: estop'")
          ->delimiter(';')
          ->transform(without_blanks)
          ->needs(faults)
          ->excludes(kinds)
          ->excludes(steps);
  command->add_flag("--rendered", options->rendered, "--faults: camera and vision see what is drawn, instead of being given the true pose")
      ->needs(faults);
  command->add_flag("--pairs", options->pairs, "--faults: pairs of faults within 0.5 s, in a step of each phase")->needs(faults);
  command->add_option("--one-in", options->one_in, "--faults: a sample, one row in so many")
      ->check(CLI::Range(1, 100000))
      ->needs(faults)
      ->excludes(rows);
  command->add_option("--into", options->into, "--faults: how far into each step it is made, as a share of the step")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->needs(faults);
  command->add_option("--shard", options->shard, "K/N: the K-th of N parts");
  command->add_option("--jobs", options->jobs, "Runs at a time (default: the number of processors)")->check(CLI::Range(1, 1024));
  command->add_option("--set", options->set, "path.to.key=value, as for run; with --seeds a list of values, key=a,b,c, flies a grid")
      ->allow_extra_args(false);
  command->add_option("--out", options->out,
                      "Folder of the runs, one a seed; seeds already there are kept (default runs/SCENARIO-campaign)");
  command
      ->add_option("--compare", options->compare,
                   "The folder of an earlier campaign with --seeds: exit status 1 where this one is worse beyond chance")
      ->needs(seeds);
  command->add_option("--across", options->across, "--compare: keys of the scenario that may differ")->delimiter(',')->needs("--compare");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &action] { action = [options] { return campaign(*options); }; });
}

}  // namespace lf::app
