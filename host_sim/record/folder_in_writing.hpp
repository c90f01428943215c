// A run's folder while it is written: aside, locked, and put in its place as a whole.
#pragma once

#include <filesystem>
#include <optional>

#include "host_sim/record/experiment.hpp"
#include "host_sim/record/run_folder.hpp"

namespace lf::record {

class FolderInWriting {
 public:
  // Writes into "PLACE.writing" first. Throws InputError when `place` holds another experiment or files that no run writes, when another run writes there now, or when nothing can
  // be written there; RecordError when the disk is full.
  FolderInWriting(const std::filesystem::path& place, const Experiment& experiment);
  // What was not published is removed.
  ~FolderInWriting();
  FolderInWriting(const FolderInWriting&) = delete;
  FolderInWriting& operator=(const FolderInWriting&) = delete;

  const RunFolder& folder() const { return *folder_; }
  // Whether an earlier run of this experiment stands in the place.
  bool place_is_taken() const;
  // Takes the place, and removes what stood there. Throws RecordError.
  void publish();

 private:
  std::filesystem::path place_, aside_;
  int lock_ = -1;
  std::optional<RunFolder> folder_;
};

}  // namespace lf::record
