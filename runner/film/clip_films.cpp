#include "runner/film/clip_films.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/math/units.hpp"
#include "common/process/child_process.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostPictures = 240;
constexpr double kLongestGap = 1;  // [s] without pictures for longer, nothing is shown

/// Copies the frames that are shown into a small movie, without decoding the others.
fs::path shortened(const ClipFilm& part, const fs::path& folder) {
  if (part.stride == 1) return part.movie;
  const std::string& camera = part.facts.camera;
  fs::path out = folder / (camera.empty() ? "shown.mkv" : "shown_" + camera + ".mkv");
  std::vector<std::string> command{"ffmpeg", "-hide_banner", "-loglevel",
                                   "fatal",  "-nostdin",     "-y"};
  const auto add = [&](const std::vector<std::string>& words) {
    command.insert(command.end(), words.begin(), words.end());
  };
  add(movieInput(part.movie.string()));
  add({"-map", "0:v:0", "-c", "copy", "-bsf:v",
       fmt::format("noise=amount=0:drop='mod(n,{})'", part.stride), "file:" + out.string()});
  fs::remove(out);  // of an earlier start
  ChildProcess copy({.arguments = command});
  copy.wait();
  // The end of a film of a killed run is damaged; what could be copied is shown.
  if (!fs::exists(out)) {
    throw std::runtime_error(part.movie.string() +
                             ": ffmpeg cannot copy its frames, expected a film of lab run: lists "
                             "of other files are not followed");
  }
  return out;
}

}  // namespace

const ClipFilm& leadingFilm(const ClipStart& start) {
  return *std::ranges::max_element(start, {}, &ClipFilm::duration);
}

std::vector<ClipStart> clipStarts(const fs::path& run) {
  std::vector<ClipStart> starts;
  std::int64_t frames = 0;
  for (const std::vector<fs::path>& folders : filmStarts(run)) {
    ClipStart start;
    for (const fs::path& folder : folders) {
      ClipFilm part{folder / film_files::kMovie, readFilmFacts(folder / film_files::kFacts), {}, 1};
      part.table = readFilmTable(filmTableOf(part.movie));
      // The facts of a film that was cut off are those of a moment before.
      if (part.table.empty() || part.facts.first_utime == 0) continue;
      start.push_back(std::move(part));
    }
    if (start.empty()) continue;
    frames += std::ranges::max(start, {}, &ClipFilm::frames).frames();
    starts.push_back(std::move(start));
  }
  for (ClipStart& start : starts) {
    for (ClipFilm& film : start) {
      film.stride = std::max<std::int64_t>(1, (frames + kMostPictures - 1) / kMostPictures);
      if (film.facts.lossless()) continue;
      // Only every so many-th frame can be read without those before it (encodeCommand()).
      const auto group = std::max<std::int64_t>(1, std::llround(film.facts.format.fps));
      film.stride = (film.stride + group - 1) / group * group;
    }
  }
  return starts;
}

FilmPlayer::FilmPlayer(const ClipFilm& film, std::int64_t slack_us, const fs::path& scratch)
    : film_(film),
      slack_us_(slack_us),
      reader_(FilmReader::open(shortened(film, scratch).string())) {}

void FilmPlayer::play(std::int64_t utime) {
  while (readable_ && next_ < film_.frames() && film_.utimeOf(next_) <= utime + slack_us_) {
    readable_ = reader_->next(frame_);
    if (!readable_) return;
    at_ = film_.utimeOf(next_);
    next_ += film_.stride;
  }
}

std::optional<std::int64_t> FilmPlayer::at(std::int64_t utime) const {
  const double fps = film_.facts.format.fps > 0 ? film_.facts.format.fps : kAssumedFps;
  const double kept = kLongestGap + 2 * static_cast<double>(film_.stride) / fps;
  const std::int64_t oldest = utime - (readable_ ? units::microseconds(kept) : slack_us_);
  return at_ && *at_ >= oldest ? at_ : std::nullopt;
}

}  // namespace lab::runner
