#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

#include "common/experiment/experiment_file.hpp"
#include "common/files/atomic_file.hpp"
#include "light/field/image.hpp"
#include "runner/film/film_commands.hpp"
#include "runner/film/light_preview.hpp"
#include "runner/film/movie_writer.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostTiles = 200;
constexpr int kTilesAcross = 4;
constexpr int kTileWidth = 320;   // [px]
constexpr int kMovieWidth = 480;  // [px]
constexpr double kFps = 25;
constexpr double kShortestView = 2;   // [s] per step
constexpr double kLongestView = 20;   // [s]
constexpr double kLongestMovie = 60;  // [s]

/// @return number of steps in the sheet
std::size_t writeSheet(LightPreview& preview, const fs::path& path) {
  std::vector<optics::RgbImage> tiles;
  std::size_t step = 0;
  for (; step < preview.steps() && tiles.size() < kMostTiles; ++step) {
    for (const double time : preview.moments(step)) {
      tiles.push_back(preview.picture(step, time, kTileWidth));
    }
  }
  const int across = std::min(kTilesAcross, static_cast<int>(tiles.size()));
  replaceFile(path, optics::pngBytes(optics::contactSheet(tiles, across)));
  return step;
}

/// Shows each step in real time, long enough to see its motion.
void writeMovie(LightPreview& preview, const Experiment& experiment, const fs::path& path) {
  std::optional<MovieWriter> movie;
  double shown = 0;
  for (std::size_t step = 0; step < preview.steps() && shown < kLongestMovie; ++step) {
    const double view = experiment.light.steps[step].ramp +
                        std::clamp(2 * preview.span(step), kShortestView, kLongestView);
    const double seconds = std::min({view, preview.length(step), kLongestMovie - shown});
    const int frames = std::max(1, static_cast<int>(std::lround(seconds * kFps)));
    for (int frame = 0; frame < frames; ++frame) {
      const optics::RgbImage picture = preview.picture(step, frame / kFps, kMovieWidth);
      if (!movie) movie.emplace(path, picture.width, picture.height, kFps);
      movie->write(picture);
    }
    shown += seconds;
  }
  movie->finish();
}

}  // namespace

ExitCode preview(const PreviewOptions& options) {
  const Experiment experiment = loadExperiment(options.file, options.set);
  const ExperimentImages images = loadImages(experiment, options.file.parent_path());
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error)
    throw UserError(options.out.string() + ": cannot create this folder: " + error.message());
  const fs::path sheet = options.out / (experiment.name + "_light.png");
  const fs::path movie = options.out / (experiment.name + "_light.mp4");
  LightPreview sheet_preview(experiment, images);
  const std::size_t steps = writeSheet(sheet_preview, sheet);
  fmt::print("{}\n", sheet.string());
  if (steps < sheet_preview.steps()) {
    fmt::print("  the first {} of {} steps\n", steps, sheet_preview.steps());
  }
  if (!isInstalled("ffmpeg")) {
    fmt::print("no animation: it needs the program ffmpeg: apt-get install ffmpeg\n");
    return kDone;
  }
  LightPreview movie_preview(experiment, images);
  writeMovie(movie_preview, experiment, movie);
  fmt::print("{}\n", movie.string());
  return kDone;
}

}  // namespace lab::runner
