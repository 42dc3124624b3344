/// What the tracker sees, in a browser: http://127.0.0.1:PORT/.
#pragma once

#include <functional>
#include <memory>

#include "light/optics/rgb_image.hpp"

namespace lab::tracker {

/// A small HTTP server with a page, its moving picture (/stream.mjpg) and a still (/frame.png,
/// /frame.jpg). It can be reached from this machine alone.
///
/// It has a thread of its own: painting, encoding, and viewers who read slowly or not at all, cost
/// the caller nothing. A viewer gets the newest picture once the one before has gone out; all
/// others are skipped. Who does not read for ten seconds is dropped.
class DebugView {
 public:
  /// @param port 0: a free one
  /// @throws std::runtime_error that names the port and says why it cannot be had.
  explicit DebugView(int port);
  ~DebugView();
  DebugView(const DebugView&) = delete;
  DebugView& operator=(const DebugView&) = delete;

  /// The port it listens on.
  [[nodiscard]] int port() const;

  /// Whether somebody waits for a picture now. Cheap: to be asked at every frame before drawing.
  /// At most 20 times a second, however many watch.
  [[nodiscard]] bool wanted() const;

  /// Hands over what paints the next picture and returns at once; does nothing when none is wanted.
  /// `paint` is called on the view's own thread: what it draws from must be its own.
  void show(std::function<RgbImage()> paint);

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace lab::tracker
