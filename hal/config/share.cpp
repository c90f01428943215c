#include "hal/config/share.hpp"

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "shared/input_error.hpp"

namespace lf::config {

namespace fs = std::filesystem;

namespace {

// The arm is what both programs need; scenarios come with one of them only.
bool holds_files(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / "arm" / "arm5e.urdf", ignored);
}

}  // namespace

fs::path share_beside(const fs::path& program) {
  fs::path installed = program.parent_path().parent_path() / "share" / "lanternfish";
  if (holds_files(installed)) return installed;
  // CHECKOUT/build/PRESET/bin or .../tests: a build folder's depth is its user's affair.
  for (fs::path above = program.parent_path(); above.has_relative_path(); above = above.parent_path()) {
    if (fs::path source = above / "shared"; holds_files(source)) return source;
  }
  return {};
}

fs::path share_folder() {
  if (const char* set = std::getenv("LANTERNFISH_SHARE"); set != nullptr && *set != '\0') {
    if (holds_files(set)) return set;
    throw InputError(std::string(set) + ": LANTERNFISH_SHARE names this folder, but arm/arm5e.urdf is not in it");
  }
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    if (fs::path near = share_beside(program); !near.empty()) return near;
  }
  if (fs::path source = fs::path(LANTERNFISH_SOURCE_DIR) / "shared"; holds_files(source)) return source;
  throw InputError("the shipped files are not beside the program, nor in " LANTERNFISH_SOURCE_DIR
                   "/shared; set LANTERNFISH_SHARE to their folder");
}

fs::path find_file(const std::string& name, const fs::path& folder) {
  fs::path path(name);
  if (path.is_absolute()) return path;
  std::error_code ignored;
  if (fs::exists(folder / path, ignored)) return folder / path;
  const fs::path shipped = share_folder() / path;
  return fs::exists(shipped, ignored) ? shipped : folder / path;  // what is nowhere is missed where its user put it
}

std::vector<std::string> shipped_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(share_folder() / folder, none)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

bool is_shipped(const fs::path& file) {
  std::error_code ignored;
  const fs::path under =
      fs::weakly_canonical(fs::absolute(file), ignored).lexically_relative(fs::weakly_canonical(share_folder(), ignored));
  return !under.empty() && *under.begin() != "..";
}

fs::path named_file(const std::string& told_in, const char* key, const std::string& name) {
  const fs::path folder = fs::path(told_in).parent_path();
  fs::path found = find_file(name, folder);
  std::error_code ignored;
  if (fs::is_directory(found, ignored)) throw InputError(told_in + ": '" + key + "': " + found.string() + " is a folder, not a file");
  if (fs::exists(found, ignored)) return found;
  std::string places;
  if (!fs::path(name).is_absolute())
    places =
        " in " + fs::absolute(folder.empty() ? fs::path(".") : folder).lexically_normal().string() + " nor in " + share_folder().string();
  throw InputError(told_in + ": '" + key + "': there is no " + name + places);
}

}  // namespace lf::config
