// Files of the repository that the programs print themselves: manual pages, completion, schemas. Set LANTERNFISH_UPDATE_DOCS to write them anew.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace lf::app {

inline void expect_in_repository(const std::string& file, const std::string& printed) {
  const std::filesystem::path path = std::filesystem::path(LANTERNFISH_SOURCE_DIR) / file;
  if (std::getenv("LANTERNFISH_UPDATE_DOCS") != nullptr) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << printed;
    return;
  }
  std::ifstream in(path, std::ios::binary);
  const std::string held{std::istreambuf_iterator<char>(in), {}};
  EXPECT_TRUE(held == printed) << file << " is not what the program prints: LANTERNFISH_UPDATE_DOCS=1 writes it anew";
}

// The options that a help text lists, by its own layout: "  --seed UINT ...".
inline std::vector<std::string> options_in(const std::string& help) {
  std::vector<std::string> options;
  for (std::size_t at = 0; at < help.size();) {
    const std::size_t end = std::min(help.find('\n', at), help.size());
    const std::string line = help.substr(at, end - at);
    at = end + 1;
    const std::size_t dashes = line.find("--");
    if (dashes == std::string::npos || !line.starts_with("  ") || line.find_first_not_of(" -,h") < dashes) continue;
    options.push_back(line.substr(dashes, line.find_first_of(" =,:[{", dashes) - dashes));
  }
  return options;
}

// As man(7) has a hyphen that is typed.
inline std::string in_roff(std::string text) {
  for (std::size_t at = 0; (at = text.find('-', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

// The part of a page under `.SS` or `.SH` `title`, up to the next.
inline std::string part_of(const std::string& page, const std::string& begin) {
  const std::size_t at = page.find(begin);
  if (at == std::string::npos) return "";
  const std::size_t end = std::min(page.find("\n.SS ", at), page.find("\n.SH ", at));
  return page.substr(at, end == std::string::npos ? end : end - at);
}

}  // namespace lf::app
