/// The debug view of the tracker as the service uses it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/loop/loop.hpp"
#include "tracker_svc/detector.hpp"
#include "tracker_svc/tracking/cap_tracker.hpp"

namespace lab::tracker {

/// Shows camera pictures with detections, and with rejected candidates and the reasons.
class DebugOutput {
 public:
  DebugOutput() = default;
  DebugOutput(const DebugOutput&) = delete;
  DebugOutput& operator=(const DebugOutput&) = delete;
  virtual ~DebugOutput() = default;

  /// Whether a viewer waits for a picture.
  [[nodiscard]] virtual bool wanted() const = 0;

  /// Shows a picture. Does nothing unless one is wanted.
  virtual void show(const optics::GreyView& picture, std::span<const Track> tracks,
                    std::span<const detector::Rejection> rejected, const std::string& caption) = 0;
};

/// Opens the debug view on http://127.0.0.1:port/. `camera` and `cap` give the outlines of the
/// caps.
/// @return null if the loop runs in virtual time or the port is 0
/// @throws std::runtime_error if the port cannot be used
[[nodiscard]] std::unique_ptr<DebugOutput> openDebugOutput(Loop& loop, int port,
                                                           const optics::CameraModel& camera,
                                                           const optics::CapGeometry& cap);

}  // namespace lab::tracker
