#include "tracker_svc/film_reader.hpp"

#include "tracker_svc/cameras/movie_reader.hpp"
#include "tracker_svc/cameras/picture_reader.hpp"

namespace lab {

std::unique_ptr<FilmReader> FilmReader::open(const std::string& source, double fps) {
  return cameras::isPictureSource(source) ? cameras::openPictures(source, fps)
                                          : cameras::openMovie(source, fps);
}

std::vector<std::string> movieInput(const std::string& file) { return cameras::inputOfMovie(file); }

}  // namespace lab
