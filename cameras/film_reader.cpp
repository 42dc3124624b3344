#include "cameras/film_reader.hpp"

#include "cameras/movie_reader.hpp"
#include "cameras/picture_reader.hpp"

namespace lab {

std::unique_ptr<FilmReader> FilmReader::open(const std::string& source, double fps) {
  return cameras::namesPictures(source) ? cameras::openPictures(source, fps)
                                        : cameras::openMovie(source, fps);
}

}  // namespace lab
