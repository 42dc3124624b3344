/// The films of a run as its clip shows them: some of their frames, of all cameras together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "common/camera/run_film.hpp"
#include "tracker_svc/film_reader.hpp"

namespace lab::runner {

/// A film of the run, and which of its frames are shown.
struct ClipFilm {
  std::filesystem::path movie;
  FilmFacts facts;
  std::vector<FilmFrame> table;  ///< not empty
  std::int64_t stride = 1;

  [[nodiscard]] std::int64_t frames() const { return static_cast<std::int64_t>(table.size()); }
  [[nodiscard]] std::int64_t utimeOf(std::int64_t frame) const {
    return facts.first_utime + table[static_cast<std::size_t>(frame)].camera_utime -
           table.front().camera_utime;
  }
  [[nodiscard]] std::int64_t duration() const {
    return table.back().camera_utime - table.front().camera_utime;
  }
};

/// The films of the cameras since one start of the tracker.
using ClipStart = std::vector<ClipFilm>;

/// The film whose frames are the pictures of the clip: the others are shown beside them.
[[nodiscard]] const ClipFilm& leadingFilm(const ClipStart& start);

/// Chooses at most 240 frames of each camera, evenly over all starts.
/// @throws CameraError, ExperimentError if facts or table of a film cannot be read
[[nodiscard]] std::vector<ClipStart> clipStarts(const std::filesystem::path& run);

/// The film of a camera, up to a moment.
class FilmPlayer {
 public:
  /// @param film must outlive the player
  /// @param slack_us so much later a frame may be than the moment
  /// @param scratch folder for a copy of the frames that are shown
  /// @throws CameraError, std::runtime_error if the movie cannot be read
  FilmPlayer(const ClipFilm& film, std::int64_t slack_us, const std::filesystem::path& scratch);

  /// Goes to the last frame that is not later than this.
  void play(std::int64_t utime);

  /// The time of that frame; empty: there is none, or it is too old to show what is there.
  [[nodiscard]] std::optional<std::int64_t> at(std::int64_t utime) const;

  [[nodiscard]] const optics::GreyView& picture() const { return frame_.grey; }

 private:
  const ClipFilm& film_;
  std::int64_t slack_us_;
  std::unique_ptr<FilmReader> reader_;
  CameraFrame frame_;
  std::int64_t next_ = 0;  ///< position in the film
  std::optional<std::int64_t> at_;
  bool readable_ = true;
};

}  // namespace lab::runner
