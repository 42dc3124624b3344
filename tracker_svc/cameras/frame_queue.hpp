/// Queue from a thread that waits for frames to the loop that handles them.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "common/process/event_descriptor.hpp"
#include "light/optics/grey_image.hpp"

namespace lab::cameras {

/// A short queue. Its descriptor is readable while it is not empty.
class FrameQueue {
 public:
  /// A frame, a change of the error text, or the end.
  struct Item {
    enum class Kind { kFrame, kTrouble, kEnd };
    Kind kind = Kind::kFrame;
    std::int64_t number = 0;
    std::int64_t utime = 0;
    std::int64_t dropped = 0;  ///< total dropped by the recording so far
    optics::GreyImage image;
    std::string text;
  };

  /// Maximum number of waiting frames.
  static constexpr std::size_t kCapacity = 4;

  /// Adds an item; blocks while full. @return false if the queue is closed: the thread should end
  bool push(Item item);

  /// Adds a frame, replacing the oldest if full. @return as push()
  bool pushDroppingOldest(Item item);

  /// An image to fill for the next item; reuses the memory of a consumed one.
  [[nodiscard]] optics::GreyImage blank(int width, int height);

  /// Sleeps, unless the queue is closed before. @return whether it is still open
  bool pause(std::int64_t microseconds);

  /// Wakes the thread from all waits.
  void close();

  [[nodiscard]] bool isOpen();
  [[nodiscard]] int descriptor() const { return ready_.get(); }
  [[nodiscard]] std::optional<Item> pop();
  void recycle(optics::GreyImage image);

 private:
  bool add(Item item);  // under the lock: pop() clears the event under the same lock

  EventDescriptor ready_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = true;
  std::deque<Item> items_;
  std::deque<optics::GreyImage> spare_;
};

}  // namespace lab::cameras
