/// The film of a run, from the tracker's frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "tracker_svc/cameras/film_recorder.hpp"

namespace lab::cameras {

/// Begins the film with the first frame, when the camera's format is known. Never throws.
class RunFilmer {
 public:
  /// @param run the folder of the run
  /// @param start_utime, may_wait as FilmRecording
  RunFilmer(std::filesystem::path run, const FilmSpec& film, std::int64_t start_utime,
            bool may_wait)
      : run_(std::move(run)), film_(film), start_utime_(start_utime), may_wait_(may_wait) {}

  /// As FilmRecorder::add(). @param format of the camera
  void add(const FilmFrame& frame, std::int64_t utime, const optics::GreyView& picture,
           CameraFormat format);

  /// As FilmRecorder::news()
  [[nodiscard]] std::string news();

 private:
  std::filesystem::path run_;
  FilmSpec film_;
  std::int64_t start_utime_;
  bool may_wait_;
  bool begun_ = false;
  std::string problem_;  ///< why there is no film
  std::unique_ptr<FilmRecorder> recorder_;
};

}  // namespace lab::cameras
