// Where the files that ship with the program are: scenarios, the arm's URDF, safety limits.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lf::config {

// The first of these that holds arm/arm5e.urdf: $LANTERNFISH_SHARE, what is beside the program, the shared/ of the source tree that it was built from.
// Throws InputError when $LANTERNFISH_SHARE is set and has none, or when there is none at all.
std::filesystem::path share_folder();

// Of an installed `program` share/lanternfish beside its bin folder; of a built one shared/ in the nearest folder above it, so that a checkout that was
// copied or moved uses its own files. Empty when neither holds arm/arm5e.urdf.
std::filesystem::path share_beside(const std::filesystem::path& program);

// The names of the .yaml files of one of its folders, without their ending, in order.
std::vector<std::string> shipped_in(const std::string& folder);

// Whether a file is one of those, whatever links lead to it: many configurations name it, and it is nobody's to write into.
bool is_shipped(const std::filesystem::path& file);

// `name` as a path: itself when absolute, else in `folder` if it is there, else in the share folder if it is there, else in `folder`.
std::filesystem::path find_file(const std::string& name, const std::filesystem::path& folder);

// The file that a key of `told_in`, a file itself, names. Throws InputError with the key and the folders that were searched when it is nowhere, and when it is a folder.
std::filesystem::path named_file(const std::string& told_in, const char* key, const std::string& name);

}  // namespace lf::config
