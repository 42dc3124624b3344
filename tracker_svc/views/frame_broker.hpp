/// Passes painted pictures from the tracker to the viewers that wait for one.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "light/optics/rgb_image.hpp"

namespace lab::tracker {

/// Paints and encodes a picture on a thread of its own, once for all viewers that wait for it, so
/// that the caller of show() never waits for a viewer. Thread-safe.
class FrameBroker {
 public:
  using Clock = std::chrono::steady_clock;
  using Picture = std::shared_ptr<const std::string>;

  enum class Format { kJpeg, kPng };

  FrameBroker();
  ~FrameBroker();
  FrameBroker(const FrameBroker&) = delete;
  FrameBroker& operator=(const FrameBroker&) = delete;

  /// Whether a viewer waits for a picture. At most 20 times per second.
  [[nodiscard]] bool wanted() const { return wanted_; }

  /// Passes on the function that paints the next picture. Does nothing unless one is wanted.
  void show(std::function<optics::RgbImage()> paint);

  /// Waits for the next picture.
  /// @param is_viewer_there asked four times per second; the wait ends when it returns false
  /// @return null if none comes before the deadline, the viewer has gone, painting fails or the
  ///         broker is closed
  [[nodiscard]] Picture next(Format format, Clock::time_point deadline,
                             const std::function<bool()>& is_viewer_there);

  /// Ends all waits now and from now on.
  void close();
  [[nodiscard]] bool closed() const { return closed_; }

 private:
  struct Waiter {
    Format format;
    bool served = false;
    Picture picture;
  };
  using Waiters = std::vector<std::shared_ptr<Waiter>>;

  void run();
  void updateWanted();

  std::mutex mutex_;
  std::condition_variable changed_;
  Waiters waiters_;
  std::function<optics::RgbImage()> paint_;  ///< empty: no new picture was shown
  Clock::time_point not_before_{};           ///< until then no picture is wanted
  std::atomic<bool> wanted_ = false;
  std::atomic<bool> closed_ = false;
  std::thread thread_;
};

}  // namespace lab::tracker
