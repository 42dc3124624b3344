/// The films of a run, from the tracker's frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tracker_svc/cameras/film_recorder.hpp"

namespace lab::cameras {

/// Begins the film of a camera with its first frame, when its format is known. Never throws. What
/// goes wrong with a film costs the others nothing.
class RunFilmer {
 public:
  /// @param run the folder of the run
  /// @param start_utime, may_wait as FilmRecording
  /// @param cameras names of several; each has a film in a folder of its name. Empty: one camera
  RunFilmer(std::filesystem::path run, const FilmSpec& film, std::int64_t start_utime,
            bool may_wait, const std::vector<std::string>& cameras = {});
  /// Completes all films at the same time.
  ~RunFilmer();
  RunFilmer(const RunFilmer&) = delete;
  RunFilmer& operator=(const RunFilmer&) = delete;

  /// As FilmRecorder::add(). @param format of the camera @param camera its place in `cameras`
  void add(const FilmFrame& frame, std::int64_t utime, const optics::GreyView& picture,
           CameraFormat format, std::size_t camera = 0);

  /// As FilmRecorder::news(), of all films.
  [[nodiscard]] std::string news();

 private:
  struct Film {
    std::string camera;
    bool begun = false;
    std::string problem;  ///< why there is none
    std::unique_ptr<FilmRecorder> recorder;
  };

  [[nodiscard]] std::filesystem::path makeFolder(const Film& film);

  std::filesystem::path run_;
  FilmSpec spec_;
  std::int64_t start_utime_;
  bool may_wait_;
  std::shared_ptr<SharedBounds> bounds_ = std::make_shared<SharedBounds>();
  std::filesystem::path folder_;  ///< of the films; empty: none has begun
  std::vector<Film> films_;
};

}  // namespace lab::cameras
