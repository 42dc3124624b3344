/// What the tracker sees, for somebody to look at.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/loop/loop.hpp"
#include "tracker_svc/detector.hpp"
#include "tracker_svc/tracking/cap_tracker.hpp"

namespace lab::tracker {

/// The debug view of a tracker: pictures with detections and with what was refused, and why.
class DebugOutput {
 public:
  DebugOutput() = default;
  DebugOutput(const DebugOutput&) = delete;
  DebugOutput& operator=(const DebugOutput&) = delete;
  virtual ~DebugOutput() = default;

  /// Whether anybody looks: else there is no need to draw.
  [[nodiscard]] virtual bool wanted() const = 0;

  virtual void show(const optics::GreyView& picture, std::span<const Track> tracks,
                    std::span<const detector::Rejection> rejected, const std::string& caption) = 0;
};

/// On http://127.0.0.1:port/, where the loop is a live one; null where it is virtual or the port 0.
/// Painting, encoding and sending happen on a thread of its own. `camera` and `cap` are needed to
/// draw outlines where the caps are.
/// @throws CameraError when the port is taken.
[[nodiscard]] std::unique_ptr<DebugOutput> openDebugOutput(Loop& loop, int port,
                                                           const optics::CameraModel& camera,
                                                           const optics::CapGeometry& cap);

}  // namespace lab::tracker
