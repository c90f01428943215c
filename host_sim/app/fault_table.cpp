#include "host_sim/app/fault_table.hpp"

#include <algorithm>
#include <cstdio>
#include <map>

namespace lf::app {

namespace {

void worsen(std::optional<double>& worst, const std::optional<double>& value) {
  if (value && (!worst || *value > *worst)) worst = value;
}

std::string number(const std::optional<double>& value, const char* format) {
  if (!value) return "";
  char text[32];
  std::snprintf(text, sizeof text, format, *value);
  return text;
}

// Unclear rows that must go on are counted there: one in twenty may fail.
bool unclear(const RowResult& row) { return row.safe() && !row.unclear.empty() && !row.must_go_on; }

std::string why(const RowResult& row) {
  std::string text;
  for (const std::vector<std::string>* list : {&row.wrong, &row.unclear}) {
    for (const std::string& each : *list) text += (text.empty() ? "" : "; ") + each;
  }
  return text;
}

std::vector<std::string> excused(const FaultTable& table) {
  std::vector<std::string> sentences;
  const auto of = [](std::size_t excused, std::size_t all) { return std::to_string(excused) + " of " + std::to_string(all); };
  if (table.unfelt > 0)
    sentences.push_back(of(table.unfelt, table.pushed) + " that were pushed succeeded, and had no drive that could feel it");
  if (table.stood_anyway > 0)
    sentences.push_back(of(table.stood_anyway, table.seized) +
                        " with a joint that seized were told as a contact: it had seized where it was to stay");
  if (table.gave_way > 0)
    sentences.push_back(of(table.gave_way, table.gripped) +
                        " with the handle in a jaw without power moved in their gears later than a joint may: the handle slipped");
  if (!table.few_excused()) sentences.emplace_back("These are too many: of each sort one in ten, and two more, may be excused");
  return sentences;
}

std::string csv_cell(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string markdown_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

}  // namespace

bool FaultTable::good() const {
  return unsafe == 0 && unclear == 0 && false_success == 0 && few_excused() &&
         static_cast<double>(went_on) >= go_on_share * static_cast<double>(must_go_on);
}

bool FaultTable::few_excused() const {
  const auto few = [](std::size_t excused, std::size_t all) {
    return static_cast<double>(excused) <= excused_share * static_cast<double>(all) + 2;
  };
  return few(unfelt, pushed) && few(stood_anyway, seized) && few(gave_way, gripped);
}

FaultTable tabulate_faults(const std::vector<RowResult>& rows) {
  FaultTable table;
  std::map<std::string, FaultTable::Line> lines;
  for (const RowResult& row : rows) {
    const bool pair = row.kind.find(" + ") != std::string::npos;
    FaultTable::Line& line = lines[pair ? "pairs, in " + row.step : row.kind];
    ++line.rows;
    line.unsafe += row.safe() ? 0 : 1;
    line.unclear += lf::app::unclear(row) ? 1 : 0;
    line.false_success += row.false_success ? 1 : 0;
    line.unfelt += row.unfelt ? 1 : 0;
    line.stood_anyway += row.stood_anyway ? 1 : 0;
    line.gave_way += row.gave_way ? 1 : 0;
    table.pushed += row.kind.find("obstacle") != std::string::npos ? 1 : 0;
    table.gripped += row.gripped ? 1 : 0;
    table.seized += row.kind.find("following") != std::string::npos ? 1 : 0;
    line.must_go_on += row.must_go_on ? 1 : 0;
    line.went_on += row.must_go_on && row.went_on ? 1 : 0;
    worsen(line.stop_ms, row.stop_ms);
    worsen(line.standing_s, row.standing_s);
    worsen(line.power_off_s, row.power_off_s);
    worsen(line.stop_to_off_s, row.stop_to_off_s);
    line.force_n = std::max(line.force_n, row.force_n);
    if (!row.safe() || !row.unclear.empty()) table.bad.push_back(row);
  }
  std::stable_partition(table.bad.begin(), table.bad.end(), [](const RowResult& row) { return !row.safe(); });
  for (auto& [kind, line] : lines) {
    line.kind = kind;
    table.rows += line.rows;
    table.unsafe += line.unsafe;
    table.unclear += line.unclear;
    table.false_success += line.false_success;
    table.unfelt += line.unfelt;
    table.stood_anyway += line.stood_anyway;
    table.gave_way += line.gave_way;
    table.must_go_on += line.must_go_on;
    table.went_on += line.went_on;
    table.kinds.push_back(line);
  }
  return table;
}

void tell(const FaultTable& table) {
  print("\n%-32s %5s %6s %7s %6s %8s %9s %9s %8s\n", "", "rows", "unsafe", "unclear", "went on", "stop ms", "stands s", "no power s",
        "force N");
  for (const FaultTable::Line& line : table.kinds) {
    const std::string on = line.must_go_on > 0 ? std::to_string(line.went_on) + "/" + std::to_string(line.must_go_on) : "";
    print("%-32s %5zu %6zu %7zu %7s %8s %9s %9s %8.0f\n", line.kind.c_str(), line.rows, line.unsafe, line.unclear, on.c_str(),
          number(line.stop_ms, "%.1f").c_str(), number(line.standing_s, "%.2f").c_str(), number(line.stop_to_off_s, "%.2f").c_str(),
          line.force_n);
  }
  for (const RowResult& row : table.bad) print("%s: %s\n    %s\n", row.safe() ? "unclear" : "UNSAFE", row.row.c_str(), why(row).c_str());
  for (const std::string& sentence : excused(table)) print("%s\n", sentence.c_str());
  print("%zu rows: %zu unsafe, %zu unclear, %zu false successes; %zu of %zu went on that must\n", table.rows, table.unsafe, table.unclear,
        table.false_success, table.went_on, table.must_go_on);
}

Json json_of(const FaultTable& table) {
  const auto number_or_null = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  Json kinds = Json::array(), bad = Json::array();
  for (const FaultTable::Line& line : table.kinds) {
    kinds.push_back({{"kind", line.kind},
                     {"rows", line.rows},
                     {"unsafe", line.unsafe},
                     {"unclear", line.unclear},
                     {"false_successes", line.false_success},
                     {"unfelt", line.unfelt},
                     {"stood_anyway", line.stood_anyway},
                     {"gave_way", line.gave_way},
                     {"must_go_on", line.must_go_on},
                     {"went_on", line.went_on},
                     {"stop_ms", number_or_null(line.stop_ms)},
                     {"standing_s", number_or_null(line.standing_s)},
                     {"power_off_s", number_or_null(line.power_off_s)},
                     {"stop_to_off_s", number_or_null(line.stop_to_off_s)},
                     {"force_n", line.force_n}});
  }
  for (const RowResult& row : table.bad)
    bad.push_back({{"row", row.row}, {"safe", row.safe()}, {"why", why(row)}, {"end", row.end}, {"reason", row.reason}});
  return {{"rows", table.rows},
          {"unsafe", table.unsafe},
          {"unclear", table.unclear},
          {"false_successes", table.false_success},
          {"pushed", table.pushed},
          {"unfelt", table.unfelt},
          {"seized", table.seized},
          {"stood_anyway", table.stood_anyway},
          {"gripped", table.gripped},
          {"gave_way", table.gave_way},
          {"must_go_on", table.must_go_on},
          {"went_on", table.went_on},
          {"kinds", kinds},
          {"bad", bad}};
}

std::string markdown_of(const FaultTable& table, const std::string& command) {
  std::string text = "    " + command +
                     "\n\n| fault | rows | unsafe | unclear | went on | stop (ms) | standing (s) | power off after standing (s) | after "
                     "the stop (s) | force (N) |\n" +
                     "|---|---|---|---|---|---|---|---|---|---|\n";
  for (const FaultTable::Line& line : table.kinds) {
    const std::string on = line.must_go_on > 0 ? std::to_string(line.went_on) + " of " + std::to_string(line.must_go_on) : "";
    text += "| " + line.kind + " | " + std::to_string(line.rows) + " | " + std::to_string(line.unsafe) + " | " +
            std::to_string(line.unclear) + " | " + on + " | " + number(line.stop_ms, "%.1f") + " | " + number(line.standing_s, "%.2f") +
            " | " + number(line.power_off_s, "%.2f") + " | " + number(line.stop_to_off_s, "%.2f") + " | " + number(line.force_n, "%.0f") +
            " |\n";
  }
  text += "| all | " + std::to_string(table.rows) + " | " + std::to_string(table.unsafe) + " | " + std::to_string(table.unclear) + " | " +
          std::to_string(table.went_on) + " of " + std::to_string(table.must_go_on) + " | | | | | |\n";
  for (const std::string& sentence : excused(table)) text += "\n" + sentence + ".\n";
  if (table.bad.empty()) return text;
  text += "\n| row | what was wrong |\n|---|---|\n";
  for (const RowResult& row : table.bad) text += "| " + markdown_cell(row.row) + " | " + markdown_cell(why(row)) + " |\n";
  return text;
}

std::string csv_of(const std::vector<RowResult>& rows) {
  std::string text =
      "row,kind,step,walk,safe,false_success,unfelt,stood_anyway,gave_way,must_go_on,went_on,end,reason,why,stop_ms,standing_s,power_off_s,"
      "stop_to_"
      "off_s,force_"
      "n\n";
  for (const RowResult& row : rows) {
    for (const std::string* cell : {&row.row, &row.kind, &row.step, &row.walk}) text += csv_cell(*cell) + ",";
    for (const bool flag : {row.safe(), row.false_success, row.unfelt, row.stood_anyway, row.gave_way, row.must_go_on, row.went_on})
      text += flag ? "1," : "0,";
    text += csv_cell(row.end) + "," + csv_cell(row.reason) + "," + csv_cell(why(row)) + "," + number(row.stop_ms, "%.2f") + "," +
            number(row.standing_s, "%.3f") + "," + number(row.power_off_s, "%.3f") + "," + number(row.stop_to_off_s, "%.3f") + "," +
            number(row.force_n, "%.1f") + "\n";
  }
  return text;
}

}  // namespace lf::app
