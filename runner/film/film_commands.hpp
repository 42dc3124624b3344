/// The commands `track` and `preview`. Both throw UserError for what the user can correct.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/command_line/command_main.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {

struct PreviewOptions {
  std::filesystem::path file;
  std::filesystem::path out = ".";  ///< folder of the pictures
  std::vector<std::string> set;     ///< key=value
};
ExitCode preview(const PreviewOptions& options);

struct TrackOptions {
  std::string source;                 ///< a folder or pattern of pictures, a movie, or a run
  std::filesystem::path calibration;  ///< of the camera
  std::filesystem::path out;          ///< the file of poses
  std::filesystem::path overlay;      ///< picture, movie or folder with what was found; empty: none
  std::int64_t every = 1;             ///< only each so many-th frame
  double fps = 0;                     ///< [1/s] of pictures without times, 0: 30, and it is said
  std::size_t robots = 0;             ///< how many there are at most, 0: not known
  bool force = false;                 ///< replaces files that are there
  std::vector<std::string> set;       ///< key=value: of the experiment of a run
  std::string marker = "caps";        ///< "caps", "blobs" or "tags"
  double cm_per_px = 0;               ///< [cm] of a pixel, in place of a calibration; 0: none
  std::optional<double> height_cm;    ///< [cm] of the markers above the floor
  std::string blob_tone;              ///< "dark" or "bright"; empty: dark
  std::vector<double> diameters_cm;   ///< [cm] smallest and largest diameter of a blob
  double max_speed_cm_s = 0;          ///< [cm/s] no blob is faster; 0: not known
  std::string tag_family;             ///< empty: tag36h11
  double tag_size_cm = 0;             ///< [cm] side of a tag
};
ExitCode track(const TrackOptions& options);

/// As track(), for the film of a run (docs/films.md).
ExitCode trackRun(const TrackOptions& options);

void addPreview(CLI::App& app, Chosen& chosen);
void addTrack(CLI::App& app, Chosen& chosen);

}  // namespace lab::runner
