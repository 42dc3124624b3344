#include "runner/film/film_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "common/math/units.hpp"
#include "tracker_svc/cap_spacings.hpp"

namespace lab::runner {
namespace {

using units::kCm;
using units::kPercents;

constexpr double kSpacingTolerance =
    0.005;  // largest relative error of the spacing without a warning
constexpr double kSpreadTolerance = 0.008;  // relative; dim or compressed films have 0.3 %

/// Settings for one check over the whole film.
calibration::SpacingSettings wholeFilm(const CameraCalibration& calibration) {
  calibration::SpacingSettings settings = tracker::spacingSettings(calibration);
  settings.window = std::numeric_limits<double>::infinity();
  return settings;
}

}  // namespace

void printFilmSummary(const tracker::FilmSummary& film, const CameraCalibration& calibration,
                      const detector::MarkerSettings& markers, std::int64_t dropped,
                      double seconds) {
  const bool blobs = markers.kind == detector::MarkerKind::kBlobs;
  const bool tags = markers.kind == detector::MarkerKind::kTags;
  fmt::print(
      "{} frames ({} dropped), {} to {} {} in each, {} tracks, {} poses ({} {}), "
      "mean confidence {:.2f}, {:.0f} frames/s",
      film.frames, dropped, film.fewest, film.most,
      blobs  ? "blobs"
      : tags ? "tags"
             : "robots",
      film.ids, film.rows, blobs ? film.merged : film.degraded, blobs ? "merged" : "degraded",
      film.confidence, static_cast<double>(film.frames) / std::max(seconds, 1e-9));
  const double expected = calibration.cap.spacing();
  const double off = film.spacing > 0 ? film.spacing / expected - 1 : 0;
  if (film.spacing > 0) {
    fmt::print(", circles {:.4f} cm apart ({:+.2f} %, spread {:.2f} %)", film.spacing * kCm,
               off * kPercents, film.spacing_spread / expected * kPercents);
  }
  fmt::print("\n");
  if (blobs || tags) {
    fmt::print("note     markers are taken to be {:g} cm above the floor\n",
               markers.height(calibration.cap) * kCm);
  }
  if (blobs) {
    fmt::print(
        "note     identities come from motion alone: {:.2g} swaps are expected in all; {} poses "
        "have a probability of a swap above {:g} % (column swap)\n",
        film.swaps, film.doubtful, tracker::FilmTracking::kDoubtful * kPercents);
  }
  if (film.surplus > 0) {
    constexpr auto kMost = std::int64_t{tracker::FilmTracking::kMostDetections};
    fmt::print(
        "note     {} of {} frames showed more {} than {}; {} poses were left out, those with the "
        "lowest confidence\n",
        film.crowded, film.frames,
        blobs  ? "blobs"
        : tags ? "tags"
               : "caps",
        film.most < kMost ? "--robots says" : std::to_string(kMost), film.surplus);
  }
  if (film.rows == 0) {
    fmt::print("note     no {} was found; --overlay NAME.png shows what was rejected and why\n",
               blobs  ? "blob"
               : tags ? "tag"
                      : "robot");
  }
}

CalibrationVerdict::CalibrationVerdict(const CameraCalibration& calibration)
    : calibration_(calibration), spacing_(wholeFilm(calibration)) {}

void CalibrationVerdict::add(const tracker::FilmRow& row) {
  const detector::Detection& pose = row.pose;
  tracker::addSpacing(spacing_, row.time, pose, calibration_.cap.spacing());
  const double out = std::max(
      {-pose.x, pose.x - calibration_.arena_width, -pose.y, pose.y - calibration_.arena_height});
  if (out <= calibration_.cap.robot_radius) return;
  ++outside_;
  farthest_ = std::max(farthest_, out);
}

void CalibrationVerdict::print(const tracker::FilmSummary& film) const {
  const calibration::SpacingReport spacing = spacing_.whole();
  const double expected = calibration_.cap.spacing();
  if (!spacing.fits) {
    fmt::print("warning  {}\n", spacing.text);
  } else if (film.spacing > 0 && std::abs(film.spacing / expected - 1) > kSpacingTolerance) {
    fmt::print(
        "warning  the circles of a cap are {:.4f} cm apart, the calibration says {:.4f} cm: was "
        "the camera moved, or its zoom? Calibrate it again (docs/calibration.md)\n",
        film.spacing * kCm, expected * kCm);
  }
  // The error is too large for a linear fit, or the poses are in too few places for one.
  if (spacing.fits && film.spacing_spread > kSpreadTolerance * expected) {
    fmt::print(
        "warning  the distance of the circles varies by {:.2f} %, up to 0.3 % is usual: are the "
        "pictures turned, or R or cx and cy wrong, or are the pictures very noisy? Calibrate the "
        "camera again (docs/calibration.md)\n",
        film.spacing_spread / expected * kPercents);
  }
  if (outside_ > 0) {
    fmt::print(
        "warning  {:.1f} % of the poses are outside the arena of {:g} x {:g} cm, by up to {:.1f} "
        "cm: was the camera moved after its calibration, or is the arena another one (size, "
        "corner, "
        "axes)?\n",
        kPercents * static_cast<double>(outside_) / static_cast<double>(film.rows),
        calibration_.arena_width * kCm, calibration_.arena_height * kCm, farthest_ * kCm);
  }
}

}  // namespace lab::runner
