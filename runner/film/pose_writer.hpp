/// Writes the file of poses of `lab track`.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "tracker_svc/film_tracking.hpp"

namespace lab::runner {

/// Writes the rows to NAME.part and renames the file when it is complete.
class PoseWriter {
 public:
  /// @throws UserError if the file exists, unless it may be replaced, or cannot be written
  PoseWriter(std::filesystem::path path, detector::MarkerKind kind, bool may_replace);
  ~PoseWriter();
  PoseWriter(const PoseWriter&) = delete;
  PoseWriter& operator=(const PoseWriter&) = delete;

  /// @throws std::runtime_error if they cannot be written
  void write(const std::vector<tracker::FilmRow>& rows);
  void finish();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  std::filesystem::path part_;
  detector::MarkerKind kind_;
  std::ofstream file_;
};

}  // namespace lab::runner
