#include "host_sim/app/reach_picture.hpp"

#include <cctype>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "hal/vision/codecs/picture_codecs.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace {

constexpr int margin_px = 40;
constexpr int header_px = 70;
constexpr int footer_px = 150;
constexpr double px_per_m = 1000;

const cv::Scalar ink(40, 40, 40);
const cv::Scalar faint(120, 120, 120);
const cv::Scalar paper(252, 252, 252);
const cv::Scalar out_of_reach(225, 225, 225);

struct Band {
  double up_to_deg;
  cv::Scalar colour;  // BGR
  const char* name;
};
const std::array<Band, 5> bands{Band{5, {90, 160, 40}, "5 deg"}, Band{10, {120, 200, 110}, "10 deg"}, Band{15, {130, 220, 200}, "15 deg"},
                                Band{20, {110, 190, 245}, "20 deg"}, Band{90, {130, 130, 235}, "more"}};

cv::Vec3b colour_of(float tilt_rad) {
  if (std::isnan(tilt_rad)) return {225, 225, 225};
  for (const Band& band : bands) {
    if (deg_from_rad(double(tilt_rad)) <= band.up_to_deg) {
      return {cv::saturate_cast<uchar>(band.colour[0]), cv::saturate_cast<uchar>(band.colour[1]), cv::saturate_cast<uchar>(band.colour[2])};
    }
  }
  return {225, 225, 225};
}

void write(cv::Mat& picture, const std::string& text, cv::Point at, double size = 0.5, const cv::Scalar& colour = ink) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
}

std::string formatted(const char* format, double a, double b = 0) {
  char text[128];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

// One height's map with its upper left corner at `corner`.
class Map {
 public:
  Map(cv::Mat& picture, cv::Point corner, const PanelLayout& layout) : picture_(picture), corner_(corner), layout_(layout) {}

  cv::Point at(const Vec2& panel_m) const {
    return corner_ + cv::Point(static_cast<int>(std::lround((panel_m.x() - layout_.plate_min_m.x()) * px_per_m)),
                               static_cast<int>(std::lround((layout_.plate_max_m.y() - panel_m.y()) * px_per_m)));
  }

  void fill(const ReachGrid& grid) {
    const int cell = static_cast<int>(std::lround(ReachGrid::step_m * px_per_m));
    for (int row = 0; row < grid.rows; ++row) {
      for (int column = 0; column < grid.columns; ++column) {
        const cv::Vec3b colour = colour_of(
            grid.tilt_rad[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column)]);
        picture_(cv::Rect(corner_.x + column * cell, corner_.y + row * cell, cell, cell)).setTo(colour);
      }
    }
  }

  void outlines() {
    cv::rectangle(picture_, at(Vec2(layout_.plate_min_m.x(), layout_.plate_max_m.y())),
                  at(Vec2(layout_.plate_max_m.x(), layout_.plate_min_m.y())), ink, 1);
    for (const PanelLayout::Marker& marker : layout_.markers) {
      for (const double half : {0.5 * marker.plate_m, 0.5 * marker.size_m}) {
        cv::rectangle(picture_, at(marker.centre_m + Vec2(-half, half)), at(marker.centre_m + Vec2(half, -half)), ink, 1, cv::LINE_AA);
      }
    }
    for (const PanelLayout::Button& button : layout_.buttons) {
      cv::circle(picture_, at(button.at_m), static_cast<int>(0.5 * button.width_m * px_per_m), ink, 1, cv::LINE_AA);
      cv::drawMarker(picture_, at(button.at_m), ink, cv::MARKER_CROSS, 8, 1, cv::LINE_AA);
    }
    for (const PanelLayout::Valve& valve : layout_.valves) {
      const Vec2 half_bar(0.5 * valve.handle_thickness_m, 0.5 * valve.handle_length_m);
      cv::rectangle(picture_, at(valve.at_m + Vec2(-half_bar.x(), half_bar.y())), at(valve.at_m + Vec2(half_bar.x(), -half_bar.y())), ink,
                    1, cv::LINE_AA);
      cv::circle(picture_, at(valve.at_m), static_cast<int>(half_bar.y() * px_per_m), ink, 1, cv::LINE_AA);
    }
  }

 private:
  cv::Mat& picture_;
  cv::Point corner_;
  const PanelLayout& layout_;
};

void legend(cv::Mat& picture, cv::Point at) {
  write(picture, "tilt of the tool to the panel's normal, up to", at + cv::Point(0, 12), 0.45);
  int x = at.x + 340;
  for (const Band& band : bands) {
    cv::rectangle(picture, cv::Rect(x, at.y, 18, 14), band.colour, cv::FILLED);
    write(picture, band.name, {x + 24, at.y + 12}, 0.45);
    x += 88;
  }
  cv::rectangle(picture, cv::Rect(x, at.y, 18, 14), out_of_reach, cv::FILLED);
  write(picture, "out of reach", {x + 24, at.y + 12}, 0.45);
}

std::string target_line(const ReachTarget& target) {
  char text[200];
  if (target.nominal.outcome != arm::IkOutcome::ok) {
    std::snprintf(text, sizeof text, "%-14s out of reach: %s", target.name.c_str(), arm::name(target.nominal.outcome));
  } else {
    std::snprintf(text, sizeof text, "%-14s tilt %.1f deg; over the docking error: %.2f %% within reach, tilt %.1f deg at worst",
                  target.name.c_str(), deg_from_rad(target.nominal.tilt_rad), 100.0 * target.reached / target.draws,
                  deg_from_rad(target.worst_tilt_rad));
  }
  std::string line = text;
  if (std::isfinite(target.handle_clearance_m)) line += formatted(", %.0f mm clear of the handle", 1e3 * target.handle_clearance_m);
  return line;
}

}  // namespace

std::string picture_format(const std::filesystem::path& name) {
  std::string ending = name.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending.empty() || ending == ".png") return ".png";
  if (ending == ".jpg" || ending == ".jpeg") return ".jpg";
  throw InputError(name.string() + ": the picture is written as .png or .jpg");
}

std::vector<std::uint8_t> draw_reach(const scenario::Scenario& scenario, const std::vector<ReachGrid>& grids,
                                     const std::vector<ReachTarget>& targets, const std::string& format) {
  const PanelLayout& layout = scenario.panel;
  const Vec2 size_px = (layout.plate_max_m - layout.plate_min_m) * px_per_m;
  const int width = static_cast<int>(size_px.x()), height = static_cast<int>(size_px.y());
  const int maps = static_cast<int>(grids.size());
  cv::Mat picture(header_px + height + footer_px, margin_px + maps * (width + margin_px), CV_8UC3, paper);
  write(picture, "Where the tool can work on the panel, scenario " + scenario.name, {margin_px, 30}, 0.75);
  for (int i = 0; i < maps; ++i) {
    const cv::Point corner(margin_px + i * (width + margin_px), header_px);
    Map map(picture, corner, layout);
    map.fill(grids[static_cast<std::size_t>(i)]);
    map.outlines();
    write(picture, formatted("tool %.0f mm over the panel", 1e3 * grids[static_cast<std::size_t>(i)].height_m), corner + cv::Point(0, -10),
          0.5, faint);
  }
  legend(picture, {margin_px, header_px + height + 18});
  int y = header_px + height + 60;
  for (const ReachTarget& target : targets) {
    write(picture, target_line(target), {margin_px, y}, 0.5);
    y += 22;
  }
  std::vector<std::uint8_t> bytes;
  vision::picture_codecs().encode(format, picture, bytes, {});
  return bytes;
}

}  // namespace lf::app
