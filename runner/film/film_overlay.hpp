/// Draws the detections of the tracker into the pictures of a film: as a contact sheet, a movie, or
/// one file per picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "tracker_svc/film_tracking.hpp"

namespace lab::runner {

/// One picture and what is drawn into it.
struct OverlayFrame {
  std::int64_t number = 0;
  double time = 0;  ///< [s]
  optics::GreyView picture;
  std::span<const tracker::FilmRow> rows;
  std::span<const detector::Rejection> rejected;
};

struct OverlaySettings {
  std::filesystem::path path;  ///< .png: contact sheet; .mp4, .mkv, .avi: movie; otherwise a folder
  bool force = false;          ///< replaces an existing file
  double fps = 30;             ///< [1/s] frame rate of a movie
  optics::CameraModel camera;
  optics::CapGeometry cap;
};

/// Output of `lab track --overlay`.
class FilmOverlay {
 public:
  FilmOverlay() = default;
  FilmOverlay(const FilmOverlay&) = delete;
  FilmOverlay& operator=(const FilmOverlay&) = delete;
  virtual ~FilmOverlay() = default;

  /// Chooses the kind of output by the extension of the path.
  /// @throws UserError if the file exists, cannot be written, or needs ffmpeg and it is not
  ///   installed
  [[nodiscard]] static std::unique_ptr<FilmOverlay> open(const OverlaySettings& settings);

  /// Whether the next frame is drawn. For a frame that is not drawn, OverlayFrame::rejected may be
  /// empty.
  [[nodiscard]] virtual bool wantsNext() const = 0;

  /// Adds the next frame; must be called for every frame. @throws std::runtime_error if it cannot
  /// be written
  virtual void add(const OverlayFrame& frame) = 0;

  /// Completes the output. Without this call no contact sheet or movie remains.
  /// @throws std::runtime_error
  virtual void finish() = 0;
};

}  // namespace lab::runner
