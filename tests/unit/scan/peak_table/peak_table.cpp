// Prints, as Markdown, how well five methods find a stripe's rows (docs/peaks.md). Usage: peak_table [SEED]
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/scan/peak_table/formed_tables.hpp"
#include "tests/unit/scan/peak_table/real_tables.hpp"

int main(int count, char** arguments) {
  const std::uint64_t seed = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 1;
  std::printf(
      "Seed %llu. Each cell: rms px / 99.9th percentile px / recall %% / false %%. Behind the bound, in brackets: rms of detector + fit "
      "over it.\n",
      static_cast<unsigned long long>(seed));
  std::vector<lf::test::Table> tables{lf::test::step_table(seed), lf::test::hard_table(seed)};
  for (lf::test::Table& table : lf::test::plain_tables(seed)) tables.push_back(std::move(table));
  lf::test::print_real_pairs();
  lf::test::print_real_weld();
  std::vector<std::string> missed;
  for (const lf::test::Table& table : tables) {
    for (std::string& row : print(table)) missed.push_back(std::move(row));
  }
  std::printf("\n### Rows where detector + fit misses what is asked: %zu\n\n", missed.size());
  for (const std::string& row : missed) std::printf("%s\n", row.c_str());
  return 0;
}
