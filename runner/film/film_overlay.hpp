/// Pictures of a film with what the tracker made of them: a contact sheet, a movie, or one file
/// each.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "tracker_svc/film_tracking.hpp"

namespace lab::runner {

/// One picture with all that is drawn on it.
struct OverlayFrame {
  std::int64_t number = 0;
  double time = 0;  ///< [s]
  optics::GreyView picture;
  std::span<const tracker::FilmRow> rows;
  std::span<const detector::Rejection> rejected;
};

struct OverlaySettings {
  std::filesystem::path path;  ///< .png: a contact sheet; .mp4, .mkv, .avi: a movie; else a folder
  bool force = false;          ///< replaces what is there
  double fps = 30;             ///< [1/s] of a movie
  optics::CameraModel camera;
  optics::CapGeometry cap;
};

class FilmOverlay {
 public:
  FilmOverlay() = default;
  FilmOverlay(const FilmOverlay&) = delete;
  FilmOverlay& operator=(const FilmOverlay&) = delete;
  virtual ~FilmOverlay() = default;

  /// By the ending of the path. @throws UserError when it is there already, cannot be written, or
  /// needs ffmpeg and there is none.
  [[nodiscard]] static std::unique_ptr<FilmOverlay> open(const OverlaySettings& settings);

  /// Whether the next frame goes into it: others need not be drawn, nor their rejections collected.
  [[nodiscard]] virtual bool wantsNext() const = 0;

  /// The next frame, whether wanted or not. @throws std::runtime_error when it cannot be written.
  virtual void add(const OverlayFrame& frame) = 0;

  /// Puts the whole of it in place. Without it nothing is left. @throws std::runtime_error
  virtual void finish() = 0;
};

}  // namespace lab::runner
