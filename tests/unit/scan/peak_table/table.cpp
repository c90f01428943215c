#include "tests/unit/scan/peak_table/table.hpp"

#include <atomic>
#include <cstdio>
#include <thread>

namespace lf::test {
namespace {

std::string number(const char* format, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::vector<std::vector<TableRow>> measured(const Table& table) {
  std::vector<std::vector<TableRow>> rows(table.parts.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < table.parts.size(); i = next++) rows[i] = table.parts[i]();
  };
  std::thread other(work);
  work();
  other.join();
  return rows;
}

void print(const TableRow& row) {
  const double rms = row.scores[0].rms_px();
  std::printf("| %s | %s |", row.scene.c_str(),
              row.bound_px ? (number("%.3f", *row.bound_px) + " (x " + number("%.2f", rms / *row.bound_px) + ")").c_str() : "");
  for (const PeakScore& score : row.scores) std::printf(" %s |", score.cell().c_str());
  std::printf("\n");
}

}  // namespace

std::string miss_of(const TableRow& row) {
  if (!row.asked) return {};
  const PeakScore& ours = row.scores[0];
  const Asked& asked = *row.asked;
  std::string miss;
  const auto check = [&](bool met, const std::string& what) {
    if (!met) miss += (miss.empty() ? "" : ", ") + what;
  };
  check(!asked.rms_px || ours.rms_px() <= *asked.rms_px,
        "rms " + number("%.3f", ours.rms_px()) + " of " + number("%.3f px", asked.rms_px.value_or(0)));
  check(!asked.percentile_999_px || ours.percentile_999_px() <= *asked.percentile_999_px,
        "99.9th percentile " + number("%.2f", ours.percentile_999_px()) + " of " + number("%.2f px", asked.percentile_999_px.value_or(0)));
  check(ours.recall() >= asked.recall, "recall " + number("%.1f %%", 100 * ours.recall()));
  check(ours.false_share() <= asked.false_share, "false " + number("%.2f %%", 100 * ours.false_share()));
  return miss;
}

std::vector<std::string> print(const Table& table) {
  std::printf("\n### %s\n\n| scene | bound px |", table.title.c_str());
  for (const char* name : method_names) std::printf(" %s |", name);
  std::printf("\n|---|---|");
  for (std::size_t i = 0; i < method_names.size(); ++i) std::printf("---|");
  std::printf("\n");
  std::vector<std::string> missed;
  for (const std::vector<TableRow>& rows : measured(table)) {
    for (const TableRow& row : rows) {
      print(row);
      if (const std::string miss = miss_of(row); !miss.empty()) missed.push_back("- " + table.title + ", " + row.scene + ": " + miss);
    }
  }
  std::fflush(stdout);
  return missed;
}

}  // namespace lf::test
