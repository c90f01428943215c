// Solids whose measures have closed forms, and meshes as the text or bytes of a file.
#pragma once

#include <bit>
#include <cmath>
#include <cstdio>
#include <string>

#include "shared/mesh/mesh.hpp"

namespace lf::mesh::test {

// Corner i has x from bit 0 of i, y from bit 1, z from bit 2.
inline Mesh box(const Vec3& size_m) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices_m.push_back(size_m.cwiseProduct(Vec3(i & 1, i >> 1 & 1, i >> 2 & 1)));
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

inline Mesh tetrahedron() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}}; }

// Of `n` meridians and `n` zones of latitude.
inline Mesh sphere(double radius_m, std::uint32_t n) {
  Mesh mesh;
  mesh.vertices_m.emplace_back(0, 0, radius_m);
  for (std::uint32_t i = 1; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      const double polar = pi * i / n, azimuth = 2 * pi * k / n;
      mesh.vertices_m.push_back(radius_m * Vec3(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)));
    }
  mesh.vertices_m.emplace_back(0, 0, -radius_m);
  const auto at = [n](std::uint32_t i, std::uint32_t k) { return 1 + (i - 1) * n + k % n; };
  const auto south = static_cast<std::uint32_t>(mesh.vertices_m.size() - 1);
  for (std::uint32_t k = 0; k < n; ++k) {
    mesh.triangles.push_back({0, at(1, k), at(1, k + 1)});
    for (std::uint32_t i = 1; i + 1 < n; ++i) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
    mesh.triangles.push_back({at(n - 1, k), south, at(n - 1, k + 1)});
  }
  return mesh;
}

// About z; `n` steps around each circle.
inline Mesh torus(double ring_m, double tube_m, std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      const double around = 2 * pi * i / n, across = 2 * pi * k / n, distance_m = ring_m + tube_m * std::cos(across);
      mesh.vertices_m.emplace_back(distance_m * std::cos(around), distance_m * std::sin(around), tube_m * std::sin(across));
    }
  const auto at = [n](std::uint32_t i, std::uint32_t k) { return i % n * n + k % n; };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  return mesh;
}

// Both in one.
inline Mesh joined(Mesh a, const Mesh& b, const Vec3& moved_m = Vec3::Zero()) {
  const auto first = static_cast<std::uint32_t>(a.vertices_m.size());
  for (const Vec3& vertex : b.vertices_m) a.vertices_m.push_back(vertex + moved_m);
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}
inline Mesh inside_out(Mesh mesh) {
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

// Numbers that read back as they are.
inline std::string exact(const Vec3& v) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%.17g %.17g %.17g", v.x(), v.y(), v.z());
  return text.data();
}

inline std::string obj_of(const Mesh& mesh) {
  std::string text;
  for (const Vec3& v : mesh.vertices_m) text += "v " + exact(v) + "\n";
  for (const Triangle& t : mesh.triangles)
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  return text;
}

inline std::string text_stl_of(const Mesh& mesh) {
  std::string text = "solid made\n";
  for (const Triangle& t : mesh.triangles) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (const std::uint32_t corner : t) text += "  vertex " + exact(mesh.vertices_m[corner]) + "\n";
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid made\n";
}

// The bytes of a number, in one order or the other.
template <class Number>
std::string bytes_of(Number number, bool is_big_endian = false) {
  const auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  std::string result(bytes.begin(), bytes.end());
  if (is_big_endian == (std::endian::native == std::endian::little)) result = {result.rbegin(), result.rend()};
  return result;
}

inline std::string binary_stl_of(const Mesh& mesh, std::string header = "made") {
  header.resize(80, ' ');
  std::string bytes = header + bytes_of(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) bytes += bytes_of(0.f);
    for (const std::uint32_t corner : t)
      for (const double value : mesh.vertices_m[corner]) bytes += bytes_of(static_cast<float>(value));
    bytes += std::string(2, '\0');
  }
  return bytes;
}

inline std::string ply_header(const std::string& format, std::size_t vertices, std::size_t faces) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(vertices) +
         "\nproperty double x\nproperty double y\nproperty double z\nelement face " + std::to_string(faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}
inline std::string text_ply_of(const Mesh& mesh) {
  std::string text = ply_header("ascii", mesh.vertices_m.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices_m) text += exact(v) + "\n";
  for (const Triangle& t : mesh.triangles)
    text += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
  return text;
}
inline std::string binary_ply_of(const Mesh& mesh, bool is_big_endian) {
  std::string bytes =
      ply_header(is_big_endian ? "binary_big_endian" : "binary_little_endian", mesh.vertices_m.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices_m)
    for (const double value : v) bytes += bytes_of(value, is_big_endian);
  for (const Triangle& t : mesh.triangles) {
    bytes += '\3';
    for (const std::uint32_t corner : t) bytes += bytes_of(static_cast<std::int32_t>(corner), is_big_endian);
  }
  return bytes;
}

}  // namespace lf::mesh::test
