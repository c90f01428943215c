#include "hal/vision/calibration_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "shared/input_error.hpp"
#include "shared/unreadable_file.hpp"

namespace lf::vision {
namespace {

// OpenCV writes "%YAML:1.0" where YAML has "%YAML 1.0"; the line stays so that line numbers hold.
std::string read_text(const std::string& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) throw unreadable(path);
  std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (content.starts_with("%YAML:")) content[5] = ' ';
  return content;
}

class CalibrationReader {
 public:
  explicit CalibrationReader(const std::string& path) : path_(path) {
    try {
      root_ = YAML::Load(read_text(path));
    } catch (const YAML::Exception& error) {
      throw InputError(path, error.mark.line + 1, error.msg);
    }
    if (!root_.IsMap()) throw InputError(path, 1, "is no calibration: camera_matrix and distortion_coefficients are expected");
  }

  CameraIntrinsics read() const {
    CameraIntrinsics camera;
    camera.width = size("image_width");
    camera.height = size("image_height");
    read_matrix(camera);
    read_model();
    read_distortion(camera);
    return camera;
  }

 private:
  [[noreturn]] void refuse(const YAML::Node& at, const std::string& message) const { throw InputError(path_, at.Mark().line + 1, message); }

  double number(const YAML::Node& node, const std::string& of) const {
    double value = 0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value)) refuse(node, of + " is not a number");
    if (!std::isfinite(value)) refuse(node, of + " is not finite");
    return value;
  }

  std::size_t count(const YAML::Node& node, const std::string& of) const {
    const double value = number(node, of);
    if (value < 0 || value > 65535 || value != std::floor(value)) refuse(node, of + " must be 0 to 65535");
    return static_cast<std::size_t>(value);
  }

  int size(const std::string& key) const {
    const YAML::Node node = root_[key];
    if (!node) return 0;
    const double value = number(node, key);
    if (value < 1 || value > 65535 || value != std::floor(value)) refuse(node, key + " must be 1 to 65535");
    return static_cast<int>(value);
  }

  // {rows, cols, data}, as both tools write it.
  std::vector<double> matrix(const std::string& key, std::size_t& rows, std::size_t& columns, int& line) const {
    const YAML::Node node = root_[key];
    if (!node) throw InputError(path_, 0, key + " is missing");
    line = node.Mark().line + 1;
    if (!node.IsMap() || !node["rows"] || !node["cols"] || !node["data"] || !node["data"].IsSequence()) {
      refuse(node, key + " needs rows, cols and data");
    }
    rows = count(node["rows"], key + ".rows");
    columns = count(node["cols"], key + ".cols");
    std::vector<double> values;
    for (const YAML::Node& element : node["data"]) values.push_back(number(element, "a number of " + key));
    if (values.size() != rows * columns) {
      refuse(node, key + " has " + std::to_string(values.size()) + " numbers, not rows x cols = " + std::to_string(rows * columns));
    }
    return values;
  }

  void read_matrix(CameraIntrinsics& camera) const {
    std::size_t rows = 0, columns = 0;
    int line = 0;
    const std::vector<double> k = matrix("camera_matrix", rows, columns, line);
    if (rows != 3 || columns != 3) throw InputError(path_, line, "camera_matrix is not 3 x 3");
    if (k[1] != 0 || k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1) {
      throw InputError(path_, line, "camera_matrix is not [fx 0 cx; 0 fy cy; 0 0 1]");
    }
    if (!(k[0] > 0 && k[4] > 0)) throw InputError(path_, line, "focal lengths must be positive");
    camera.fx = k[0];
    camera.cx = k[2];
    camera.fy = k[4];
    camera.cy = k[5];
  }

  void read_model() const {
    const YAML::Node node = root_["distortion_model"];
    if (!node) return;
    const std::string model = node.IsScalar() ? node.Scalar() : "";
    if (model != "plumb_bob" && model != "rational_polynomial") {
      refuse(node, "unknown distortion_model '" + model + "': plumb_bob is read");
    }
  }

  void read_distortion(CameraIntrinsics& camera) const {
    std::size_t rows = 0, columns = 0;
    int line = 0;
    const std::vector<double> d = matrix("distortion_coefficients", rows, columns, line);
    if (rows > 1 && columns > 1) throw InputError(path_, line, "distortion_coefficients is neither a row nor a column");
    if (!d.empty() && d.size() < 4) throw InputError(path_, line, "distortion_coefficients has fewer than 4 numbers: k1 k2 p1 p2 [k3]");
    for (std::size_t i = 0; i < d.size(); ++i) {
      if (i < camera.distortion.size()) {
        camera.distortion[i] = d[i];
      } else if (d[i] != 0) {
        throw InputError(path_, line, "distortion_coefficients beyond k1 k2 p1 p2 k3 must be zero: plumb_bob is read");
      }
    }
  }

  std::string path_;
  YAML::Node root_;
};

}  // namespace

CameraIntrinsics read_camera_calibration(const std::string& path) { return CalibrationReader(path).read(); }

}  // namespace lf::vision
