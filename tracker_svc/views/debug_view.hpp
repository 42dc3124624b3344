/// An HTTP server with the picture that the tracker sees: http://127.0.0.1:PORT/.
#pragma once

#include <functional>
#include <memory>

#include "light/optics/rgb_image.hpp"

namespace lab::tracker {

/// Serves a page, its motion JPEG (/stream.mjpg) and stills (/frame.png, /frame.jpg) to programs on
/// this host, at most eight at once.
///
/// Painting, encoding and sending happen on other threads than the caller's. After a viewer has
/// received a picture it gets the newest one; the pictures in between are skipped. A viewer that
/// does not read for ten seconds is disconnected.
class DebugView {
 public:
  /// @param port 0: any free one
  /// @throws std::runtime_error if the port cannot be used; the text names it and says why
  explicit DebugView(int port);
  ~DebugView();
  DebugView(const DebugView&) = delete;
  DebugView& operator=(const DebugView&) = delete;

  /// The port it listens on.
  [[nodiscard]] int port() const;

  /// Whether a viewer waits for a picture, at most 20 times per second. Cheap enough to be called
  /// for every frame.
  [[nodiscard]] bool wanted() const;

  /// Passes on the function that paints the next picture, and returns at once. Does nothing unless
  /// a picture is wanted. `paint` is called on another thread and must own what it draws from.
  void show(std::function<optics::RgbImage()> paint);

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace lab::tracker
