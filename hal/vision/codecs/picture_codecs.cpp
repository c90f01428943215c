#include "hal/vision/codecs/picture_codecs.hpp"

#include <dlfcn.h>
#include <elf.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "hal/vision/codecs/codecs_file.hpp"
#include "shared/input_error.hpp"

namespace lf::vision {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& why) {
  throw InputError("pictures cannot be read or written: " + why +
                   ". Install the package anew, or copy the build's lib folder along with its bin");
}

// What is cut off, by a full disk perhaps, would end the program where it is mapped. The section headers come last.
bool is_whole(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  Elf64_Ehdr header{};
  std::error_code error;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return false;
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64) return false;
  const std::uint64_t size = fs::file_size(file, error), headers = std::uint64_t{header.e_shnum} * header.e_shentsize;
  return !error && header.e_shoff <= size && headers <= size - header.e_shoff;
}

struct Loaded {
  fs::path file;
  const PictureCodecs* codecs;
};

const PictureCodecs* load(const fs::path& file) {
  if (!is_whole(file)) refuse(file.string() + " is no library of this kind of processor, or is cut off");
  void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) refuse(::dlerror());
  const auto get = reinterpret_cast<const PictureCodecs* (*)()>(::dlsym(library, "lanternfish_picture_codecs"));
  const PictureCodecs* codecs = get == nullptr ? nullptr : get();
  if (codecs == nullptr || codecs->edition != codecs_edition || codecs->size != sizeof(PictureCodecs))
    refuse(file.string() + " belongs to another version of the program");
  return codecs;
}

Loaded find() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error), lib = program.parent_path().parent_path() / "lib";
  const std::array<fs::path, 2> places{lib / "lanternfish" / LANTERNFISH_CODECS_NAME, lib / LANTERNFISH_CODECS_NAME};
  for (const fs::path& place : places)
    if (fs::exists(place, error)) return {place, load(place)};
  refuse("neither " + places[0].string() + " nor " + places[1].string() + " is there");
}

const Loaded& loaded() {
  static const Loaded once = find();
  return once;
}

}  // namespace

const PictureCodecs& picture_codecs() { return *loaded().codecs; }

std::string picture_codecs_file() { return loaded().file; }

}  // namespace lf::vision
