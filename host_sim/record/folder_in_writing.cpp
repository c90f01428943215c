#include "host_sim/record/folder_in_writing.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <system_error>

#include "shared/input_error.hpp"

namespace lf::record {
namespace {

namespace fs = std::filesystem;

fs::path beside(fs::path place, const char* ending) {
  if (!place.has_filename()) place = place.parent_path();  // "runs/a/"
  place += ending;
  return place;
}

constexpr std::array<const char*, 9> run_files{"can0.log",         "cloud.pcd",   "experiment.json", "joints.csv",   "log.jsonl",
                                               "raw/images.jsonl", "report.html", "result.json",     "scenario.yaml"};

// Pictures by their folder and ending. A file that the scenario uses is copied to where it stands from the scenario, with its name.
bool a_run_writes(const fs::path& file, const Experiment& experiment) {
  if (std::find(run_files.begin(), run_files.end(), file.generic_string()) != run_files.end()) return true;
  const fs::path folder = file.parent_path();
  if (file.extension() == ".png" && (folder == "images" || folder == "raw")) return true;
  if (folder == "scene" && (file.filename() == "scene.yaml" || file.stem().string().starts_with("mesh_"))) return true;
  return std::any_of(experiment.begin(), experiment.end(), [&](const auto& entry) {
    return entry.first.starts_with("file ") && fs::path(entry.first.substr(5)).filename() == file.filename();
  });
}

// What would be lost with the earlier run: its user's own notes beside it.
void refuse_own_files(const fs::path& place, const Experiment& experiment) {
  std::error_code ignored;
  if (!fs::is_directory(place, ignored)) return;
  for (const auto& entry : fs::recursive_directory_iterator(place)) {
    const bool folder = entry.is_directory(ignored) && !entry.is_symlink(ignored);
    if (folder && !fs::is_empty(entry.path(), ignored)) continue;
    const fs::path file = entry.path().lexically_relative(place);
    if (folder && (file == "images" || file == "raw")) continue;
    if (folder || !a_run_writes(file, experiment))
      throw InputError(
          place.string(), 0,
          "holds " + file.string() + ", which no run writes: it would be removed with the earlier run. Move it, or give another folder");
  }
}

}  // namespace

FolderInWriting::FolderInWriting(const fs::path& place, const Experiment& experiment)
    : place_(beside(place, "")), aside_(beside(place, ".writing")) {
  refuse_other(place_, experiment);
  refuse_own_files(place_, experiment);
  folder_.emplace(aside_);
  lock_ = ::open(aside_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0 || ::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    if (lock_ >= 0) ::close(lock_);
    throw InputError(place_.string(), 0, "another run is writing there");
  }
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(aside_)) fs::remove_all(entry.path(), ignored);  // of a run that was killed
  try {
    folder_->write(experiment_file, experiment_json(experiment));
  } catch (const RecordError&) {
    ::close(lock_);
    fs::remove_all(aside_, ignored);
    throw;
  }
}

FolderInWriting::~FolderInWriting() {
  std::error_code ignored;
  if (folder_) fs::remove_all(aside_, ignored);
  ::close(lock_);
}

bool FolderInWriting::place_is_taken() const {
  std::error_code ignored;
  return fs::exists(place_, ignored) && !fs::is_empty(place_, ignored);
}

void FolderInWriting::publish() {
  const fs::path old = beside(place_, ".old");
  std::error_code error, ignored;
  fs::remove_all(old, ignored);
  if (fs::exists(place_, ignored)) fs::rename(place_, old, error);
  if (!error) fs::rename(aside_, place_, error);
  if (error) throw RecordError(place_.string() + ": " + error.message());
  fs::remove_all(old, ignored);
  folder_.reset();
}

}  // namespace lf::record
