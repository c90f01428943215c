#include <fstream>
#include <iterator>

#include "host_sim/campaign/campaign_file.hpp"
#include "host_sim/campaign/figures.hpp"
#include "shared/input_error.hpp"
#include "shared/unreadable_file.hpp"

namespace lf::campaign {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double number(const Json& object, const char* key) {
  const auto it = object.find(key);
  return it == object.end() || it->is_null() ? record::unknown : it->get<double>();
}

RunSummary run_from(const Json& json) {
  RunSummary run;
  json.at("seed").get_to(run.seed);
  json.at("success").get_to(run.success);
  json.at("false_success").get_to(run.false_success);
  run.calibration_doubted = json.value("calibration_doubted", false);
  if (const Json& failure = json.at("failure"); !failure.is_null())
    run.failure = record::FailureRecord{failure.at("phase").get<std::string>(), failure.at("reason").get<std::string>()};
  run.as_expected = json.value("as_expected", "");
  const Json& values = json.at("figures");
  if (!values.is_object()) throw InputError("its figures are none");
  for (const Figure& figure : figures())
    run.figures.push_back(number(values, figure.name));  // one that an older program did not have is unknown
  run.wall_s = number(json, "wall_s");
  run.digest = json.value("digest", "");
  run.folder = json.value("folder", "");
  run.has_report = json.value("has_report", false);
  return run;
}

Cell cell_from(const Json& json) {
  Cell cell;
  for (const auto& [key, value] : json.at("choice").items()) cell.choice.emplace_back(key, value.get<std::string>());
  json.at("folder").get_to(cell.folder);
  json.at("not_flown_seeds").get_to(cell.not_flown);
  for (const auto& [name, value] : json.at("experiment").items()) cell.experiment[name] = value.get<std::string>();
  for (const Json& run : json.at("results")) cell.runs.push_back(run_from(run));
  return cell;
}

Campaign campaign_from(const Json& json) {
  Campaign campaign;
  if (const auto format = json.at("format").get<int>(); format != 1)
    throw InputError("its format is " + std::to_string(format) + ", which this version does not read");
  json.at("scenario").get_to(campaign.scenario);
  json.at("seeds").get_to(campaign.seeds);
  json.at("set").get_to(campaign.set);
  json.at("grid").get_to(campaign.keys);
  json.at("command").get_to(campaign.command);
  json.at("version").get_to(campaign.version);
  json.at("revision").get_to(campaign.revision);
  for (const Json& sitting : json.at("sittings"))
    campaign.sittings.push_back(
        {sitting.at("begun").get<std::string>(), sitting.at("ended").get<std::string>(), sitting.at("flown").get<std::size_t>()});
  for (const Json& cell : json.at("cells")) campaign.cells.push_back(cell_from(cell));
  if (campaign.cells.empty()) throw InputError("it has no cell");
  return campaign;
}

// A folder without the file: what it is instead.
std::string instead(const fs::path& folder) {
  const std::optional<record::Experiment> experiment = record::read_experiment(folder);
  const std::string none = std::string("has no ") + campaign_file;
  if (!experiment) return none + ": it is not a campaign's folder";
  const auto kind = experiment->find("campaign");
  if (kind == experiment->end()) return none + ": it is the folder of one run";
  if (kind->second != "campaign") return none + ": it is a campaign of " + kind->second + ", not of seeds";
  return none +
         ": the campaign is being flown, was ended before it could write, or is of an earlier version. Start it again: what is flown is "
         "kept";
}

}  // namespace

Campaign read_campaign(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) throw InputError(path.string(), 0, "there is no such folder");
  const bool is_folder = fs::is_directory(path, ignored);
  const fs::path file_path = is_folder ? path / campaign_file : path;
  std::ifstream file(file_path);
  if (is_folder && !file) throw InputError(path.string(), 0, instead(path));
  if (!file) throw unreadable(path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  try {
    return campaign_from(Json::parse(text));
  } catch (const Json::exception& error) {
    throw InputError(file_path.string(), 0, std::string("is not a campaign's: ").append(error.what()));
  } catch (const InputError& error) {
    throw InputError(file_path.string(), 0, std::string("is not a campaign's: ").append(error.what()));
  }
}

}  // namespace lf::campaign
