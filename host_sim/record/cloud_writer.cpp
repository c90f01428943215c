#include <array>
#include <cstdio>
#include <cstring>

#include "host_sim/record/cloud_file.hpp"

namespace lf::record {
namespace {

std::array<float, 4> row_of(const CloudPoint& point) { return {point.p_m.x(), point.p_m.y(), point.p_m.z(), point.amplitude}; }

std::string rows(std::span<const CloudPoint> points, CloudEncoding encoding) {
  std::string text;
  for (const CloudPoint& point : points) {
    const std::array<float, 4> row = row_of(point);
    std::array<char, 96> line{};
    int size = sizeof row;
    if (encoding == CloudEncoding::binary) {
      std::memcpy(line.data(), row.data(), sizeof row);
    } else {
      size = std::snprintf(line.data(), line.size(), "%.9g %.9g %.9g %.9g\n", static_cast<double>(row[0]), static_cast<double>(row[1]),
                           static_cast<double>(row[2]), static_cast<double>(row[3]));
    }
    text.append(line.data(), static_cast<std::size_t>(size));
  }
  return text;
}

}  // namespace

std::string pcd_bytes(std::span<const CloudPoint> points, CloudEncoding encoding) {
  const std::string count = std::to_string(points.size());
  std::string text =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n";
  text += "WIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA ";
  text += encoding == CloudEncoding::ascii ? "ascii\n" : "binary\n";
  return text + rows(points, encoding);
}

std::string ply_bytes(std::span<const CloudPoint> points, CloudEncoding encoding) {
  std::string text = "ply\nformat ";
  text += encoding == CloudEncoding::ascii ? "ascii" : "binary_little_endian";
  text += " 1.0\ncomment metres, base frame\nelement vertex " + std::to_string(points.size()) +
          "\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\nend_header\n";
  return text + rows(points, encoding);
}

}  // namespace lf::record
