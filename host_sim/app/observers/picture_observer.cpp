#include "host_sim/app/observers/picture_observer.hpp"

#include <array>
#include <cstdio>
#include <iterator>
#include <utility>

#include "hal/vision/codecs/codecs_file.hpp"

namespace lf::app {

namespace {

constexpr std::uint32_t frames_a_picture = 20;  // a sweep has about 230 stripes
constexpr std::uint32_t frames_a_report_picture = 60;
constexpr std::size_t most_in_report = 12;  // some 100 kB each: the report stays within 5 MB

std::string formatted(const char* format, double value) {
  char text[160];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

ImageView view_of(const optics::Frame& frame) { return {frame.pixels.data(), frame.width, frame.height, frame.width}; }

}  // namespace

PictureObserver::PictureObserver(RunFiles& files) : files_(files) {
  if (files.wanted()) (void)vision::picture_codecs_file();
}

void PictureObserver::on_telemetry(const Telemetry& telemetry) {
  for (const Event& event : telemetry.events) outside_.on_event(event);
}

void PictureObserver::on_panel_request(const PanelRequest& request, ImageView still, std::span<const CloudPoint>) {
  still_.reset();
  still_answered_ = false;
  if (!files_.wanted() || !request.has_still || !still.valid()) return;
  still_ = record::rgb_from_grey(still);
  still_time_ = request.still_time;
}

void PictureObserver::on_panel_result(const PanelResult& result) {
  answered_ = result;
  still_answered_ = true;
}

void PictureObserver::after_control() {
  if (still_ && still_answered_) keep_still();
}

void PictureObserver::keep_still() {
  for (const MarkerObservation& marker : answered_.markers) {
    std::array<record::PixelPoint, 4> corners;
    for (std::size_t i = 0; i < corners.size(); ++i)
      corners[i] = {static_cast<float>(marker.corners_px[i].x()), static_cast<float>(marker.corners_px[i].y())};
    record::draw_outline(*still_, corners, {255, 40, 40});
  }
  keep(formatted("images/still_%07.2fs.png", still_time_.s()), formatted("Still image at %.2f s", still_time_.s()),
       answered_.markers.empty()       ? "No marker was found in it."
       : answered_.markers.size() == 1 ? "The marker as it was found, in red."
                                       : "The markers as they were found, in red.",
       *still_, true);
  still_.reset();
}

void PictureObserver::on_peaks(const optics::Frame& frame, Time start, std::span<const scan::Peak> peaks) {
  const std::uint32_t number = laser_frames_++;
  if (number % frames_a_picture != 0 || !files_.wanted()) return;
  std::vector<record::PixelPoint> points;
  for (const scan::Peak& peak : peaks) points.push_back({peak.u_px, peak.v_px});
  keep(formatted("images/stripe_%07.2fs.png", start.s()), formatted("Stripe at %.2f s", start.s()),
       formatted("%.0f peaks, red over the image.", static_cast<double>(points.size())),
       record::overlay_peaks(view_of(frame), points, 2.0f), number % frames_a_report_picture == 0);
}

void PictureObserver::keep(const std::string& name, const std::string& title, const std::string& caption, const record::RgbImage& image,
                           bool in_report) {
  if (!files_.wanted()) return;
  files_.write(name, record::encode_png(image));
  if (in_report && pictures_.size() < most_in_report) pictures_.push_back({title, caption, record::encode_jpeg(image)});
}

void PictureObserver::draw_outside(const optics::OpticsConfig& optics, int threads) {
  if (!files_.wanted()) return;
  std::vector<record::ReportPicture> camera = std::exchange(pictures_, {});
  for (const OutsidePictures::Picture& picture : outside_.draw(optics, threads)) {
    keep("images/" + picture.name + ".png", picture.title, "Drawn after the run from its poses; the core never sees it.", picture.image,
         true);
  }
  std::move(camera.begin(), camera.end(), std::back_inserter(pictures_));
}

}  // namespace lf::app
