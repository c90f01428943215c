#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hal/config/nearest.hpp"
#include "hal/vision/calibration_file.hpp"
#include "hal/vision/marker_files.hpp"
#include "host_sim/app/checks.hpp"
#include "host_sim/app/command.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace {

struct Options {
  std::vector<std::string> files;
  std::string family = "36h11";
  std::string channel = "grey";
  std::string camera;
  double size_m = 0;
  double decimate = vision::MarkerDetectorConfig{}.decimate;
  double min_margin = vision::MarkerDetectorConfig{}.min_margin;
  std::string overlay;
  bool json = false;
};

void tell(const std::vector<vision::MarkerFrame>& frames) {
  for (const vision::MarkerFrame& frame : frames) {
    for (const vision::MarkerInFrame& found : frame.markers) {
      const vision::DetectedMarker& marker = found.marker;
      print("%s frame %lld: id %d at %.2f %.2f, margin %.0f", frame.source.c_str(), static_cast<long long>(frame.frame), marker.id,
            marker.centre_px.x(), marker.centre_px.y(), marker.margin);
      if (found.pose) {
        const Vec3 t = found.pose->camera_from_tag.translation();
        print(", %.4f %.4f %.4f m", t.x(), t.y(), t.z());
      }
      print("\n");
    }
  }
}

// Of a file's doubts the first, and how many there are: a video has one a frame.
bool tell_doubtful_poses(const std::vector<vision::MarkerFrame>& frames) {
  std::map<std::string, std::vector<std::string>> by_file;
  for (const vision::MarkerFrame& frame : frames) {
    for (const vision::MarkerInFrame& found : frame.markers) {
      if (std::string doubt = vision::doubt_of(found); !doubt.empty())
        by_file[frame.source].push_back("frame " + std::to_string(frame.frame) + ": " + doubt);
    }
  }
  for (auto& [file, doubts] : by_file) {
    if (doubts.size() > 1) doubts[0] += "; and " + std::to_string(doubts.size() - 1) + " more such";
    tell_doubts(file, {doubts[0]});
  }
  return !by_file.empty();
}

int markers(const Options& options) {
  vision::MarkerFilesOptions asked;
  asked.detector.family = options.family;
  asked.detector.decimate = options.decimate;
  asked.detector.min_margin = options.min_margin;
  config::check_names({options.channel}, {"grey", "red", "green", "blue", "r", "g", "b", "red-excess", "green-excess", "blue-excess"},
                      "--channel");
  asked.channel = vision::channel_from_name(options.channel);
  asked.size_m = options.size_m;
  asked.overlay_path = options.overlay;
  if (!options.camera.empty() && options.size_m <= 0) throw InputError("--camera needs --size-m, the side of the markers' black square");
  if (options.camera.empty() && options.size_m > 0) throw InputError("--size-m needs --camera, a calibration file");
  if (!options.camera.empty()) asked.camera = vision::read_camera_calibration(options.camera);
  const std::vector<vision::MarkerFrame> frames = vision::find_markers_in_files(options.files, asked);
  std::size_t found = 0;
  for (const vision::MarkerFrame& frame : frames) found += frame.markers.size();
  if (options.json) {
    print("%s\n", vision::marker_frames_json(frames).c_str());
  } else {
    tell(frames);
    print("%s in %s\n", count_of(found, "marker").c_str(), count_of(frames.size(), "frame").c_str());
  }
  const bool doubtful = tell_doubtful_poses(frames);
  if (found > 0) return doubtful ? failed : done;
  const char* other = options.decimate > 1 ? "small markers with --decimate 1" : "large or noisy ones with --decimate 1.5 or 2";
  std::fprintf(stderr,
               "lanternfish: no marker of family %s with a margin of %g or more. Check --family, lower --margin, and search %s (now %g)\n",
               options.family.c_str(), options.min_margin, other, options.decimate);
  return failed;
}

}  // namespace

void add_markers(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("markers", "AprilTag markers in images and videos");
  auto options = std::make_shared<Options>();
  command->add_option("FILE", options->files, "Images or videos")->required();
  command->add_option("--family", options->family, "36h11, 25h9, 16h5 ...")->capture_default_str();
  command->add_option("--channel", options->channel, vision::channel_names)->capture_default_str();
  command->add_option("--camera", options->camera, "Calibration (YAML of OpenCV or ROS): gives poses; needs --size-m");
  command->add_option("--size-m", options->size_m, "Side of the black square, m")->check(within(1e-4, 100));
  command->add_option("--decimate", options->decimate, "Search on an image so many times smaller")->check(within(1, 8))->capture_default_str();
  command->add_option("--margin", options->min_margin, "Smallest decision margin")->check(within(0, 1000))->capture_default_str();
  command->add_option("--overlay", options->overlay, "Write the first frame with a marker to this PNG, markers drawn in")->check(check_png);
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &action] { action = [options] { return markers(*options); }; });
}

}  // namespace lf::app
