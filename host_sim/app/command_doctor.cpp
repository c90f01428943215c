#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "hal/config/limits_file.hpp"
#include "hal/config/share.hpp"
#include "hal/vision/codecs/codecs_file.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/input_error.hpp"
#include "shared/version/version.hpp"

namespace lf::app {

namespace fs = std::filesystem;

namespace {

struct Finding {
  std::string name;
  bool good = false;
  std::string found;
  std::string remedy;  // what to do when it is not good
};

Finding processor() {
#if defined(__x86_64__)
  const bool fast = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return {"processor", fast, fast ? "AVX2 and FMA" : "no AVX2", "build with -DLANTERNFISH_MARCH=x86-64"};
#else
  return {"processor", true, "not x86-64", ""};
#endif
}

Finding threads() {
  const unsigned n = std::thread::hardware_concurrency();
  return {"threads", n >= 1, std::to_string(n), "a run wants two"};
}

Finding memory() {
  constexpr std::uint64_t needed_kb = 600'000;  // a run with its report takes about 400 MB
  std::ifstream in("/proc/meminfo");
  std::string word;
  std::uint64_t available_kb = 0;
  while (in >> word) {
    if (word == "MemAvailable:") in >> available_kb;
  }
  return {"memory", available_kb >= needed_kb, std::to_string(available_kb / 1024) + " MB available",
          "free some: a run takes about 400 MB"};
}

// The shared libraries that this process has loaded, by the versions in their files' names.
Finding libraries() {
  static const std::set<std::string> wanted{"libembree3", "libBulletDynamics-float64", "libpcl_common", "libopencv_core", "libapriltag",
                                            "libyaml-cpp"};
  std::ifstream maps("/proc/self/maps");
  std::set<std::string> found;
  for (std::string line; std::getline(maps, line);) {
    const std::string file = fs::path(line.substr(std::min(line.find('/'), line.size()))).filename();
    if (wanted.contains(file.substr(0, file.find(".so")))) found.insert(file);
  }
  std::string list;
  for (const std::string& file : found) list += (list.empty() ? "" : ", ") + file;
  return {"libraries", !found.empty(), list, "install the packages of toolchain/packages.txt"};
}

Finding pictures() {
  try {
    return {"pictures", true, vision::picture_codecs_file(), ""};
  } catch (const InputError& error) {
    return {"pictures", false, error.what(), "without them no picture is read, and no run leaves one"};
  }
}

Finding share() {
  try {
    const std::string folder = config::share_folder();
    return {"shipped files", true, folder, ""};
  } catch (const std::exception& error) {
    return {"shipped files", false, error.what(), "set LANTERNFISH_SHARE to the folder that holds scenarios/"};
  }
}

Finding scenarios() {
  try {
    std::size_t n = 0;
    for (const scenario::ShippedScenario& shipped : scenario::shipped_scenarios()) {
      (void)scenario::make_nominal(scenario::load_scenario(shipped.name), true);
      ++n;
    }
    return {"scenarios", n > 0, count_of(n, "scenario") + ", the arm and the safety limits read well", "install the shipped files again"};
  } catch (const std::exception& error) {
    return {"scenarios", false, error.what(), "put the file right, or install the shipped files again"};
  }
}

Finding writable() {
  std::error_code error;
  const fs::path here = fs::current_path(error);
  const bool good = !error && access(here.c_str(), W_OK) == 0;
  const fs::space_info space = fs::space(here, error);
  return {"this folder", good, here.string() + (error ? "" : ", " + std::to_string(space.available >> 20) + " MB free"),
          "runs need --out with a folder that can be written"};
}

int doctor(bool json) {
  const std::vector<Finding> findings{processor(), threads(), memory(), libraries(), pictures(), share(), scenarios(), writable()};
  bool all = true;
  Json list = Json::array();
  for (const Finding& finding : findings) {
    all = all && finding.good;
    list.push_back({{"name", finding.name},
                    {"good", finding.good},
                    {"found", finding.found},
                    {"remedy", finding.good ? Json(nullptr) : Json(finding.remedy)}});
    if (json) continue;
    print("%-14s %-5s %s\n", finding.name.c_str(), finding.good ? "good" : "BAD", finding.found.c_str());
    if (!finding.good) print("%-20s to do: %s\n", "", finding.remedy.c_str());
  }
  if (json) {
    print_json({{"good", all},
                {"version", version()},
                {"revision", revision()},
                {"compiler", compiler()},
                {"opencv", cv::getVersionString()},
                {"findings", list}});
  } else {
    print("%-14s       %s\n", "version", version_line("lanternfish").c_str());
  }
  return all ? done : environment;
}

}  // namespace

void add_doctor(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("doctor", "Check that this machine has what a run needs");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print JSON");
  command->callback([json, &action] { action = [json] { return doctor(*json); }; });
}

}  // namespace lf::app
