/// Writes the file of poses of `lab track`.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "tracker_svc/film_tracking.hpp"

namespace lab::runner {

/// Writes the rows to a file that appears when it is complete.
class PoseWriter {
 public:
  /// @throws UserError if the file exists, unless it may be replaced, or cannot be written
  PoseWriter(std::filesystem::path path, detector::MarkerKind kind, bool may_replace);

  /// @throws std::runtime_error if they cannot be written
  void write(const std::vector<tracker::FilmRow>& rows);
  void finish();

 private:
  [[noreturn]] void fail() const;

  AtomicFile file_;
  detector::MarkerKind kind_;
  std::ofstream stream_;
};

}  // namespace lab::runner
