#include "host_sim/record/folder_in_writing.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

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

}  // namespace

FolderInWriting::FolderInWriting(const fs::path& place, const Experiment& experiment)
    : place_(beside(place, "")), aside_(beside(place, ".writing")) {
  refuse_other(place_, experiment);
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
