#include "runner/export/film_pictures.hpp"

#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/camera/run_film.hpp"
#include "runner/film/named_files.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr std::array<std::string_view, 4> kMovies{".mkv", ".mp4", ".avi", ".mov"};
constexpr int kQuality = 90;

std::vector<std::uint8_t> jpegOf(const optics::GreyView& grey) {
  const std::unique_ptr<void, int (*)(tjhandle)> compressor(tjInitCompress(), &tjDestroy);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  const int failed =
      tjCompress2(compressor.get(), grey.data, grey.width, static_cast<int>(grey.stride),
                  grey.height, TJPF_GRAY, &data, &size, TJSAMP_GRAY, kQuality, 0);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owned(data, &tjFree);
  if (failed != 0) throw std::runtime_error("a picture of the film cannot be made a JPEG");
  return {data, data + size};
}

}  // namespace

std::string filmOfRun(const fs::path& folder) {
  std::error_code error;
  const fs::path film = folder / film_files::kFolder / film_files::kMovie;
  if (fs::is_regular_file(film, error)) return film.string();
  std::vector<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (!entry.is_regular_file()) continue;
    if (std::ranges::find(kMovies, entry.path().extension().string()) != kMovies.end()) {
      found.push_back(entry.path().string());
    } else if (entry.path().filename() == "frames.csv") {
      found.push_back(entry.path().parent_path().string());
    }
  }
  return found.size() == 1 ? found.front() : "";
}

std::vector<fs::path> camerasFilms(const fs::path& folder) {
  std::vector<fs::path> films = filmFolders(folder);
  std::erase_if(films, [](const fs::path& film) {
    return readFilmFacts(film / film_files::kFacts).camera.empty();
  });
  return films;
}

std::function<std::optional<FilmPicture>()> camerasPictures(const std::vector<fs::path>& folders) {
  struct Film {
    std::string camera;
    std::function<std::optional<FilmPicture>()> read;
    std::optional<FilmPicture> next;
  };
  const auto films = std::make_shared<std::vector<Film>>();
  for (const fs::path& folder : folders) {
    const FilmFacts facts = readFilmFacts(folder / film_files::kFacts);
    Film& film = films->emplace_back();
    film.camera = facts.camera;
    film.read = filmPictures((folder / film_files::kMovie).string(), facts.first_utime);
    film.next = film.read();
  }
  return [films]() -> std::optional<FilmPicture> {
    Film* first = nullptr;
    for (Film& film : *films) {
      if (film.next && (first == nullptr || film.next->utime < first->next->utime)) first = &film;
    }
    if (first == nullptr) return std::nullopt;
    std::optional<FilmPicture> picture = std::exchange(first->next, first->read());
    picture->camera = first->camera;
    return picture;
  };
}

std::function<std::optional<FilmPicture>()> filmPictures(const std::string& source,
                                                         std::int64_t begin_utime) {
  const std::shared_ptr<FilmReader> film = openFilm(source);
  return [film, begin_utime]() -> std::optional<FilmPicture> {
    CameraFrame frame;
    if (!film->next(frame)) return std::nullopt;
    return FilmPicture{begin_utime + frame.utime, jpegOf(frame.grey)};
  };
}

}  // namespace lab::runner
