// Clouds written by us and read by PCL, written by PCL and read by us, and files of every wrong kind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <cmath>
#include <limits>
#include <random>

#include "host_sim/record/cloud_file.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::record {
namespace {

using lf::test::message_of;
using lf::test::TemporaryFolder;
using testing::HasSubstr;

std::vector<CloudPoint> random_cloud(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-2, 2);
  std::vector<CloudPoint> cloud;
  for (std::size_t i = 0; i < count; ++i) {
    cloud.push_back({Eigen::Vector3f(place(random), place(random), place(random)), 50 * place(random)});
  }
  return cloud;
}

pcl::PointCloud<pcl::PointXYZI> as_pcl(const std::vector<CloudPoint>& cloud) {
  pcl::PointCloud<pcl::PointXYZI> points;
  for (const CloudPoint& p : cloud) {
    pcl::PointXYZI point;
    point.getVector3fMap() = p.p_m;
    point.intensity = p.amplitude;
    points.push_back(point);
  }
  return points;
}

void expect_same(const std::vector<CloudPoint>& cloud, const pcl::PointCloud<pcl::PointXYZI>& points) {
  ASSERT_EQ(cloud.size(), points.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(cloud[i].p_m, points[i].getVector3fMap()) << i;
    EXPECT_EQ(cloud[i].amplitude, points[i].intensity) << i;
  }
}

TEST(CloudFile, PclReadsBothOurEncodingsBitForBit) {
  const TemporaryFolder folder;
  const auto cloud = random_cloud(500);
  for (const CloudEncoding encoding : {CloudEncoding::ascii, CloudEncoding::binary}) {
    pcl::PointCloud<pcl::PointXYZI> pcd, ply;
    ASSERT_EQ(pcl::io::loadPCDFile(folder.write("c.pcd", pcd_bytes(cloud, encoding)), pcd), 0);
    ASSERT_EQ(pcl::io::loadPLYFile(folder.write("c.ply", ply_bytes(cloud, encoding)), ply), 0);
    expect_same(cloud, pcd);
    expect_same(cloud, ply);
  }
}

TEST(CloudFile, ReadsWhatPclWritesInEveryEncoding) {
  const TemporaryFolder folder;
  const auto cloud = random_cloud(3000);
  const auto points = as_pcl(cloud);
  pcl::io::savePCDFileASCII(folder.path() / "ascii.pcd", points);
  pcl::io::savePCDFileBinary(folder.path() / "binary.pcd", points);
  pcl::io::savePCDFileBinaryCompressed(folder.path() / "compressed.pcd", points);
  pcl::io::savePLYFileBinary(folder.path() / "binary.ply", points);
  for (const char* name : {"binary.pcd", "compressed.pcd", "binary.ply"}) {
    SCOPED_TRACE(name);
    expect_same(read_cloud_file(folder.path() / name).points, points);
  }
  const CloudFile ascii = read_cloud_file(folder.path() / "ascii.pcd");  // PCL writes 8 digits
  ASSERT_EQ(ascii.points.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) EXPECT_TRUE(ascii.points[i].p_m.isApprox(cloud[i].p_m, 1e-6f));
}

// Long runs and repeats: every kind of LZF token.
TEST(CloudFile, ReadsCompressedBlocksThatRepeatThemselves) {
  const TemporaryFolder folder;
  std::vector<CloudPoint> cloud(5000, CloudPoint{Eigen::Vector3f(1, 2, 3), 4});
  for (std::size_t i = 0; i < cloud.size(); i += 7) cloud[i].p_m.x() = static_cast<float>(i % 11);
  pcl::io::savePCDFileBinaryCompressed(folder.path() / "c.pcd", as_pcl(cloud));
  expect_same(read_cloud_file(folder.path() / "c.pcd").points, as_pcl(cloud));
}

TEST(CloudFile, SkipsAndCountsPointsThatAreNotFinite) {
  const TemporaryFolder folder;
  auto cloud = random_cloud(10);
  cloud[3].p_m.y() = std::numeric_limits<float>::quiet_NaN();
  cloud[8].p_m.z() = std::numeric_limits<float>::infinity();
  for (const CloudEncoding encoding : {CloudEncoding::ascii, CloudEncoding::binary}) {
    const CloudFile read = read_cloud_file(folder.write("c.pcd", pcd_bytes(cloud, encoding)));
    EXPECT_EQ(read.points.size(), 8u);
    EXPECT_EQ(read.skipped, 2u);
  }
}

TEST(CloudFile, ReadsCsvByItsHeaderOrByItsFirstThreeColumns) {
  const TemporaryFolder folder;
  const auto by_header = read_cloud_file(folder.write("a.csv", "# of a scanner\nid;Z;X;Y\n7; 3 ;1;2\n8;6;4;5 # last\n"));
  ASSERT_EQ(by_header.points.size(), 2u);
  EXPECT_EQ(by_header.points[1].p_m, Eigen::Vector3f(4, 5, 6));
  const auto bare = read_cloud_file(folder.write("b.CSV", "1e-1, 2, +3, 9\r\n4, nan, 6, 9\r\n"));
  ASSERT_EQ(bare.points.size(), 1u);
  EXPECT_EQ(bare.points[0].p_m, Eigen::Vector3f(0.1f, 2, 3));
  EXPECT_EQ(bare.skipped, 1u);
  EXPECT_EQ(read_cloud_file(folder.write("c.csv", "1   2\t3\n")).points.size(), 1u);
}

TEST(CloudFile, ReadsXyzWithWhateverStandsBesideThePoints) {
  const TemporaryFolder folder;
  const auto bare = read_cloud_file(folder.write("a.xyz", "1 2 3\n4\t5  6.5\r\n\n"));
  ASSERT_EQ(bare.points.size(), 2u);
  EXPECT_EQ(bare.points[1].p_m, Eigen::Vector3f(4, 5, 6.5f));
  EXPECT_EQ(bare.points[1].amplitude, 0);
  const auto intensity = read_cloud_file(folder.write("b.XYZ", "//X Y Z Intensity\n2\n1 2 3 40\nnan 2 3 40\n"));
  ASSERT_EQ(intensity.points.size(), 1u);
  EXPECT_EQ(intensity.points[0].amplitude, 40);
  EXPECT_EQ(intensity.skipped, 1u);
  const auto colours = read_cloud_file(folder.write("c.xyz", "# r g b\n1,2,3,255,0,0\n"));
  EXPECT_EQ(colours.points.at(0).p_m, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(colours.points.at(0).amplitude, 0) << "a colour is no intensity";
}

struct BadFile {
  const char* name;
  std::string bytes;
  const char* message;
};

TEST(CloudFile, RefusesBadFilesInOneLineWithTheLineWhereThereIsOne) {
  const std::string header = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n";
  const std::vector<BadFile> files{
      {"a.pcd", "", "no PCD header"},
      {"b.pcd", "hello\n", "b.pcd:1: is no line of a PCD header"},
      {"c.pcd", header + "DATA ascii\n1 2 3\n", "is truncated: 1 of 2 points"},
      {"d.pcd", header + "DATA ascii\n1 2 3\n4 x 6\n", "d.pcd:11: 'x' is not a number"},
      {"e.pcd", header + "DATA ascii\n1 2\n3 4 5\n", "e.pcd:10: has 2 numbers, not 3"},
      {"f.pcd", header + "DATA binary\n0123456789", "is truncated: 0 of 2 points"},
      {"g.pcd", header + "DATA binary_compressed\n", "is truncated"},
      {"h.pcd", header + std::string("DATA binary_compressed\n\x08\0\0\0\x18\0\0\0\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF", 39), "damaged"},
      {"i.pcd", header + std::string("DATA binary_compressed\n\xFF\0\0\0\x18\0\0\0zz", 33), "truncated within its compressed block"},
      {"j.pcd", "FIELDS x y\nSIZE 4 4\nTYPE F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2\n", "no fields x, y and z"},
      {"k.pcd", "FIELDS x y z\nSIZE 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n", "do not go together"},
      {"l.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 99999999999999\nDATA ascii\n", "out of range"},
      {"m.ply", "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n",
       "truncated: 1 of 2"},
      {"n.ply", "ply\nformat ascii 1.0\nelement face 2\n", "n.ply:3: its first element is not vertex"},
      {"o.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n", "o.ply:4: a vertex property"},
      {"p.ply", "plx\n", "p.ply:1: is no PLY file"},
      {"q.csv", "1,2,3\n1,2\n", "q.csv:2: has 2 columns, not 3"},
      {"r.csv", "1,2,3\n1,,3\n", "r.csv:2: '' is not a number"},
      {"s.csv", "u,v,w\n", "s.csv:1: is neither numbers nor a header"},
      {"t.csv", "# nothing\n", "is empty"},
      {"u.txt", "1 2 3\n", ".pcd, .ply, .csv or .xyz is read"},
      {"v.xyz", "", "is empty"},
      {"w.xyz", "3\n", "is empty"},
      {"x.xyz", "1 2 3\n1 2\n", "x.xyz:2: has fewer than three columns"},
      {"y.xyz", "1 2 3 4\n1 2 3\n", "y.xyz:2: has 3 columns, not 4"},
      {"z.xyz", "1 2 far\n", "z.xyz:1: 'far' is not a number"},
      {"0.xyz", "3\n1 2 3\n4 5 6\n", "has 2 points, not the 3 that its first line says"},
  };
  const TemporaryFolder folder;
  for (const BadFile& file : files) {
    const auto path = folder.write(file.name, file.bytes);
    const std::string message = message_of<InputError>([&] { read_cloud_file(path); });
    EXPECT_THAT(message, HasSubstr(file.message)) << file.name;
    EXPECT_EQ(message.find('\n'), std::string::npos) << file.name;
  }
  EXPECT_THAT(message_of<InputError>([&] { read_cloud_file(folder.path() / "missing.pcd"); }), HasSubstr("there is no such file"));
}

// Every prefix of a file, and every byte of it changed, is either read or refused: nothing else happens.
TEST(CloudFile, SurvivesEveryTruncationAndDamageOfAFile) {
  const TemporaryFolder folder;
  const auto cloud = random_cloud(20);
  pcl::io::savePCDFileBinaryCompressed(folder.path() / "c.pcd", as_pcl(cloud));
  const std::string files[] = {folder.read("c.pcd"), pcd_bytes(cloud), pcd_bytes(cloud, CloudEncoding::ascii), ply_bytes(cloud)};
  const char* names[] = {"c.pcd", "b.pcd", "a.pcd", "p.ply"};
  for (std::size_t kind = 0; kind < std::size(files); ++kind) {
    const auto outcome = [&](const std::string& bytes) {
      try {
        return static_cast<int>(read_cloud_file(folder.write(names[kind], bytes)).points.size());
      } catch (const InputError&) {
        return -1;
      }
    };
    EXPECT_EQ(outcome(files[kind]), 20);
    for (std::size_t size = 0; size + 30 < files[kind].size(); size += 13)
      EXPECT_EQ(outcome(files[kind].substr(0, size)), -1) << names[kind] << size;
    for (std::size_t at = 0; at < files[kind].size(); at += 19) {
      std::string damaged = files[kind];
      damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
      EXPECT_LE(outcome(damaged), 20) << names[kind] << at;
    }
  }
}

}  // namespace
}  // namespace lf::record
