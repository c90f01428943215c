#include "shared/urdf/mesh_file.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <string_view>

#include "shared/urdf/element.hpp"

namespace lf::urdf {
namespace {

namespace fs = std::filesystem;

// ASCII, whatever the locale.
std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

// The entry of `folder` whose name differs from `name` in case alone. Looks at 4096 entries at most.
std::optional<std::string> other_case(const fs::path& folder, const std::string& name) {
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  for (int i = 0; !error && i < 4096 && entry != fs::directory_iterator(); ++i) {
    std::string found = entry->path().filename().string();
    if (found != name && lower_case(found) == lower_case(name)) return found;
    entry.increment(error);
  }
  return std::nullopt;
}

// How `path`, which is not there, is spelt on the disk: folders and name in another case. Nothing when it is not there at all.
std::optional<fs::path> spelt_otherwise(const fs::path& path) {
  fs::path so_far;
  std::error_code error;
  for (const fs::path& part : path) {
    if (fs::exists(so_far / part, error)) {
      so_far /= part;
    } else if (const auto other = other_case(so_far.empty() ? fs::path(".") : so_far, part.string())) {
      so_far /= *other;
    } else {
      return std::nullopt;
    }
  }
  if (!is_file(so_far)) return std::nullopt;
  return so_far;
}

// The folders in which package://NAME/REST may be, as whole paths, the likeliest first.
std::vector<fs::path> places_of(const std::string& package, const fs::path& rest, const fs::path& folder,
                                const std::vector<fs::path>& package_folders) {
  std::vector<fs::path> places;
  places.reserve(package_folders.size() + 8);
  for (const fs::path& root : package_folders) places.push_back(root / package / rest);
  std::error_code error;
  fs::path above = fs::absolute(folder, error).lexically_normal();
  if (!above.has_filename()) above = above.parent_path();
  for (;;) {
    if (above.filename() == package) places.push_back(above / rest);
    places.push_back(above / package / rest);
    if (!above.has_relative_path()) break;
    above = above.parent_path();
  }
  places.push_back(folder / rest);
  return places;
}

constexpr const char* add_it = "correct the name, add the file, or put a box, cylinder or sphere in its place";

MeshFile missing_at(const std::string& name, const fs::path& expected) {
  MeshFile result;
  result.missing = true;
  if (const auto other = spelt_otherwise(expected))
    result.problem =
        "names " + shown(name) + ", which is spelt " + shown(other->string()) + " on the disk: write upper and lower case alike";
  else if (name.find('\\') != std::string::npos)
    result.problem = "names " + shown(name) + ", which is not there: write / instead of \\";
  else
    result.problem = "names " + shown(name) + ", which is not there: " + add_it;
  return result;
}

MeshFile find_in_package(const std::string& name, const std::string& path, const fs::path& folder,
                         const std::vector<fs::path>& package_folders) {
  const std::size_t slash = path.find('/');
  MeshFile result;
  if (slash == std::string::npos || slash == 0 || slash + 1 == path.size()) {
    result.problem = "names " + shown(name) + ": write package://NAME/PATH";
    return result;
  }
  const std::string package = path.substr(0, slash);
  const fs::path rest = fs::path(path.substr(slash + 1)).relative_path();
  const std::vector<fs::path> places = places_of(package, rest, folder, package_folders);
  for (const fs::path& place : places) {
    if (!is_file(place)) continue;
    result.file = place;
    result.remark = "names " + shown(name) + ", found as " + shown(place.string());
    return result;
  }
  for (const fs::path& place : places)
    if (const auto other = spelt_otherwise(place)) return missing_at(name, place);
  result.missing = true;
  result.problem =
      "names " + shown(name) + ", and package " + shown(package) +
      " is neither in the given package folders nor in a folder above this file, nor is its file beside this one: say where it is, or " +
      add_it;
  return result;
}

}  // namespace

MeshFile find_mesh(const std::string& name, const fs::path& folder, const std::vector<fs::path>& package_folders) {
  MeshFile result;
  constexpr std::array<std::string_view, 4> formats{"stl", "obj", "ply", "dae"};
  const std::string extension = lower_case(fs::path(name).extension().string());
  if (extension.size() < 2 || std::find(formats.begin(), formats.end(), std::string_view(extension).substr(1)) == formats.end()) {
    result.problem = "names " + shown(name) + ", which is of no known format: export it as STL, OBJ, PLY or COLLADA (.dae)";
    return result;
  }
  const std::size_t scheme_end = name.find("://");
  if (scheme_end != std::string::npos) {
    const std::string scheme = name.substr(0, scheme_end);
    const std::string path = name.substr(scheme_end + 3);
    if (scheme == "package" || scheme == "model") return find_in_package(name, path, folder, package_folders);
    if (scheme != "file" || path.empty() || path.front() != '/') {
      result.problem = "names " + shown(name) + ": write a path relative to this file, package://NAME/PATH or file:///PATH";
      return result;
    }
    if (!is_file(path)) return missing_at(name, path);
    result.file = path;
    return result;
  }
  const fs::path path = folder / name;
  if (!is_file(path)) return missing_at(name, path);
  result.file = path;
  return result;
}

MeshUnit unit_of(const fs::path& file) {
  MeshUnit result;
  if (lower_case(file.extension().string()) != ".dae") return result;
  // <asset> is the first child of <COLLADA>; some tools write pages of comments into it.
  std::string head(std::size_t{256} * 1024, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  const std::size_t begin = head.find("<asset"), end = head.find("</asset>");
  tinyxml2::XMLDocument document;
  if (begin == std::string::npos || end == std::string::npos || end < begin ||
      document.Parse(head.data() + begin, end - begin + std::string_view("</asset>").size()) != tinyxml2::XML_SUCCESS) {
    result.problem =
        "is " + shown(file.filename().string()) + ", which has no readable <asset> with its unit: export it anew, or as STL, OBJ or PLY";
    return result;
  }
  const auto* const asset = document.RootElement();
  if (const auto* const up = asset->FirstChildElement("up_axis");
      up != nullptr && up->GetText() != nullptr && std::string_view(up->GetText()) != "Z_UP")
    result.remark = "is " + shown(file.filename().string()) + ", which has " + shown(up->GetText()) + "; its vertices are used as they are";
  const auto* const unit = asset->FirstChildElement("unit");
  const char* const meter = unit == nullptr ? nullptr : unit->Attribute("meter");
  if (meter == nullptr) return result;
  const std::string_view text = meter;
  const auto [last, error] = std::from_chars(text.data(), text.data() + text.size(), result.metres_per_unit);
  // From a micrometre to a kilometre. Nothing else is a unit of a robot's part.
  if (error != std::errc() || last != text.data() + text.size() || !(result.metres_per_unit >= 1e-6 && result.metres_per_unit <= 1e3)) {
    result.metres_per_unit = 1;
    result.problem =
        "is " + shown(file.filename().string()) + ", whose <unit meter=" + shown(text) + "> is no length from 1e-6 to 1000 m: correct it";
  }
  return result;
}

}  // namespace lf::urdf
