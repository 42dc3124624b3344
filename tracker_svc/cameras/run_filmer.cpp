#include "tracker_svc/cameras/run_filmer.hpp"

#include <exception>
#include <thread>
#include <utility>

namespace lab::cameras {

namespace fs = std::filesystem;

RunFilmer::RunFilmer(fs::path run, const FilmSpec& film, std::int64_t start_utime, bool may_wait,
                     const std::vector<std::string>& cameras)
    : run_(std::move(run)), spec_(film), start_utime_(start_utime), may_wait_(may_wait) {
  for (const std::string& camera : cameras) films_.emplace_back().camera = camera;
  if (films_.empty()) films_.emplace_back();
  bounds_->films = films_.size();
}

RunFilmer::~RunFilmer() {
  std::vector<std::thread> closing;
  for (Film& film : films_) closing.emplace_back([&film] { film.recorder.reset(); });
  for (std::thread& one : closing) one.join();
}

fs::path RunFilmer::makeFolder(const Film& film) {
  if (folder_.empty()) folder_ = makeFilmFolder(run_);
  if (film.camera.empty()) return folder_;
  fs::create_directory(folder_ / film.camera);
  return folder_ / film.camera;
}

void RunFilmer::add(const FilmFrame& frame, std::int64_t utime, const optics::GreyView& picture,
                    CameraFormat format, std::size_t camera) {
  Film& film = films_[camera];
  if (!std::exchange(film.begun, true)) {
    format.width = picture.width;
    format.height = picture.height;
    try {
      film.recorder = std::make_unique<FilmRecorder>(FilmRecording{
          makeFolder(film), spec_, format, start_utime_, may_wait_, film.camera, bounds_});
    } catch (const std::exception& error) {
      film.problem = (film.camera.empty() ? "film" : "film of camera " + film.camera) +
                     ": there is none: " + error.what() + "; the run goes on";
    }
  }
  if (film.recorder) film.recorder->add(frame, utime, picture);
}

std::string RunFilmer::news() {
  std::string all;
  for (Film& film : films_) {
    const std::string news =
        film.recorder ? film.recorder->news() : std::exchange(film.problem, {});
    if (!news.empty()) all += (all.empty() ? "" : "; ") + news;
  }
  return all;
}

}  // namespace lab::cameras
