#include <memory>
#include <string>
#include <vector>

#include "host_sim/app/checks.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/record/result.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/serve/render_rings.hpp"

namespace lf::app {

namespace {

struct Options {
  std::string scenario;
  std::string file;
  std::uint64_t seed = 1;
  std::vector<std::string> set;
  int render_threads = 1;
  bool json = false;
};

int run(const Options& options) {
  const scenario::Scenario scenario = scenario::load_scenario(options.scenario, options.set);
  const scenario::Sample sample = scenario::draw(scenario, options.seed);
  const scenario::Nominal nominal = scenario::make_nominal(scenario, sample.lamps_lit);
  const hal::SimConfig sim = scenario::make_truth(scenario, sample, nominal, options.render_threads);
  catch_interrupts();
  const serve::RenderServer server = serve::render_frames(sim.optics, options.file, &interrupted);
  const record::TimesRecord times = record::times_record(server.render_ms);
  if (options.json) {
    print_json({{"pictures", server.pictures},
                {"missed", server.missed},
                {"render_ms", {{"p50", times.p50}, {"p99", times.p99}, {"max", times.max}}}});
  } else {
    print("%llu pictures, %llu exposures missed; a picture took %.1f ms (p50), %.1f ms (p99)\n",
          static_cast<unsigned long long>(server.pictures), static_cast<unsigned long long>(server.missed), times.p50, times.p99);
  }
  return done;
}

}  // namespace

void add_render_frames(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("render-frames", "Render for a `lanternfish serve --renderer FILE` that runs elsewhere, until SIGTERM");
  auto options = std::make_shared<Options>();
  command->add_option("SCENARIO", options->scenario, "The scenario that is served")->required();
  command->add_option("FILE", options->file, "The shared file; made if need be")->required();
  command->add_option("--seed", options->seed, "The seed that is served")->check(check_seed)->capture_default_str();
  command->add_option("--set", options->set, "path.to.key=value: as it is served")->allow_extra_args(false);
  command->add_option("--render-threads", options->render_threads, "Threads that render")->check(CLI::Range(1, 256))->capture_default_str();
  command->add_flag("--json", options->json, "Print what was rendered as JSON");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace lf::app
