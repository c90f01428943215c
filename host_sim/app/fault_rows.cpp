// Rows of the fault matrix as lines of JSON, and back.
#include <fstream>
#include <nlohmann/json.hpp>

#include "host_sim/app/fault_matrix.hpp"

namespace lf::app {

namespace {

using Object = nlohmann::ordered_json;

Object number(const std::optional<double>& value) { return value ? Object(*value) : Object(nullptr); }

void read(const Object& object, const char* key, std::optional<double>& value) {
  if (const auto it = object.find(key); it != object.end() && it->is_number()) value = it->get<double>();
}

}  // namespace

std::string row_json(const RowResult& row) {
  const Object object{{"row", row.row},
                      {"kind", row.kind},
                      {"step", row.step},
                      {"walk", row.walk},
                      {"at_s", row.at_s},
                      {"safe", row.safe()},
                      {"wrong", row.wrong},
                      {"unclear", row.unclear},
                      {"false_success", row.false_success},
                      {"unfelt", row.unfelt},
                      {"stood_anyway", row.stood_anyway},
                      {"gripped", row.gripped},
                      {"gave_way", row.gave_way},
                      {"must_go_on", row.must_go_on},
                      {"went_on", row.went_on},
                      {"end", row.end},
                      {"reason", row.reason},
                      {"reported", row.reported},
                      {"stop_ms", number(row.stop_ms)},
                      {"standing_s", number(row.standing_s)},
                      {"power_off_s", number(row.power_off_s)},
                      {"stop_to_off_s", number(row.stop_to_off_s)},
                      {"force_n", row.force_n}};
  return object.dump(-1, ' ', false, Object::error_handler_t::replace) + "\n";
}

std::optional<RowResult> parse_row(const std::string& line) {
  const Object object = Object::parse(line, nullptr, false);
  if (!object.is_object()) return std::nullopt;
  RowResult row;
  try {
    object.at("row").get_to(row.row);
    object.at("kind").get_to(row.kind);
    object.at("step").get_to(row.step);
    object.at("walk").get_to(row.walk);
    object.at("wrong").get_to(row.wrong);
    object.at("unclear").get_to(row.unclear);
    object.at("false_success").get_to(row.false_success);
    object.at("unfelt").get_to(row.unfelt);
    object.at("stood_anyway").get_to(row.stood_anyway);
    object.at("gripped").get_to(row.gripped);
    object.at("gave_way").get_to(row.gave_way);
    object.at("at_s").get_to(row.at_s);
    object.at("must_go_on").get_to(row.must_go_on);
    object.at("went_on").get_to(row.went_on);
    object.at("end").get_to(row.end);
    object.at("reason").get_to(row.reason);
    object.at("reported").get_to(row.reported);
    object.at("force_n").get_to(row.force_n);
  } catch (const Object::exception&) {
    return std::nullopt;
  }
  read(object, "stop_ms", row.stop_ms);
  read(object, "standing_s", row.standing_s);
  read(object, "power_off_s", row.power_off_s);
  read(object, "stop_to_off_s", row.stop_to_off_s);
  return row;
}

std::vector<RowResult> read_rows(const std::filesystem::path& file) {
  std::vector<RowResult> rows;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (std::optional<RowResult> row = parse_row(line)) rows.push_back(std::move(*row));
  }
  return rows;
}

}  // namespace lf::app
