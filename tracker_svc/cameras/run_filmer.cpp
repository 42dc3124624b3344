#include "tracker_svc/cameras/run_filmer.hpp"

#include <exception>
#include <utility>

namespace lab::cameras {

void RunFilmer::add(const FilmFrame& frame, std::int64_t utime, const optics::GreyView& picture,
                    CameraFormat format) {
  if (!std::exchange(begun_, true)) {
    format.width = picture.width;
    format.height = picture.height;
    try {
      recorder_ = std::make_unique<FilmRecorder>(
          FilmRecording{makeFilmFolder(run_), film_, format, start_utime_, may_wait_});
    } catch (const std::exception& error) {
      problem_ = std::string("film: there is none: ") + error.what() + "; the run goes on";
    }
  }
  if (recorder_) recorder_->add(frame, utime, picture);
}

std::string RunFilmer::news() {
  return recorder_ ? recorder_->news() : std::exchange(problem_, {});
}

}  // namespace lab::cameras
