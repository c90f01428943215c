#include "hal/vision/codecs/picture_codecs.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "shared/input_error.hpp"

namespace lf::vision {
namespace {

namespace fs = std::filesystem;

// Installed beside the program's folder; in a build folder there, too, or where it was built.
std::vector<fs::path> places() {
  constexpr const char* name = LANTERNFISH_CODECS_NAME;
  std::vector<fs::path> all;
  std::error_code error;
  if (const fs::path program = fs::read_symlink("/proc/self/exe", error); !error) {
    const fs::path lib = program.parent_path().parent_path() / "lib";
    all = {lib / "lanternfish" / name, lib / name};
  }
  all.emplace_back(fs::path(LANTERNFISH_CODECS_BUILT) / name);
  return all;
}

const PictureCodecs& load() {
  std::error_code ignored;
  std::string looked_at;
  for (const fs::path& place : places()) {
    looked_at += (looked_at.empty() ? "" : ", ") + place.string();
    if (!fs::exists(place, ignored)) continue;
    void* library = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw InputError(std::string("pictures cannot be read or written: ") + ::dlerror());
    const auto get = reinterpret_cast<const PictureCodecs* (*)()>(::dlsym(library, "lanternfish_picture_codecs"));
    if (get == nullptr) throw InputError("pictures cannot be read or written: " + place.string() + " is another program's");
    return *get();
  }
  throw InputError("pictures cannot be read or written: none of these is there: " + looked_at);
}

}  // namespace

const PictureCodecs& picture_codecs() {
  static const PictureCodecs& codecs = load();
  return codecs;
}

}  // namespace lf::vision
