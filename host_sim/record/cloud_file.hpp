// Clouds in files: PCD and PLY written, PCD, PLY, CSV and XYZ read. Metres. Points have x, y, z and an intensity (the peak's amplitude).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "shared/messages/panel_vision.hpp"

namespace lf::record {

enum class CloudEncoding { ascii, binary };

// PCD 0.7 and PLY 1.0 (little endian), float32. ASCII has 9 significant digits: every float comes back the same.
std::string pcd_bytes(std::span<const CloudPoint> points, CloudEncoding encoding = CloudEncoding::binary);
std::string ply_bytes(std::span<const CloudPoint> points, CloudEncoding encoding = CloudEncoding::binary);

struct CloudFile {
  std::vector<CloudPoint> points;  // finite, in the order of the file
  std::uint64_t skipped = 0;       // points with a coordinate that is not a finite number
};

// By the name's ending, whatever its case: .pcd (ascii, binary, binary_compressed), .ply (ascii, binary of either byte order), .csv (columns x, y, z by a
// header line, else the first three; separated by commas, semicolons, tabs or blanks; # starts a comment), .xyz (rows of x y z; a fourth column alone is the
// intensity, others are left; # and // start comments; a first line with one whole number states how many points follow).
// Numeric fields of any type and order are taken; without `intensity` the amplitude is 0.
// Throws InputError (with the line in text) for another ending and for an unreadable, malformed or truncated file, or one without x, y, z.
CloudFile read_cloud_file(const std::filesystem::path& path);

}  // namespace lf::record
