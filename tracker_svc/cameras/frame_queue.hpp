/// From a thread that waits for frames to the loop that handles them.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "common/process/file_descriptor.hpp"
#include "light/optics/grey_image.hpp"

namespace lab::cameras {

/// A short queue. Its descriptor is readable while something waits in it.
class FrameQueue {
 public:
  /// One of the three: a frame, a change of the trouble, the end.
  struct Item {
    enum class Kind { kFrame, kTrouble, kEnd };
    Kind kind = Kind::kFrame;
    std::int64_t number = 0;
    std::int64_t utime = 0;
    std::int64_t dropped = 0;  ///< by the recording, so far
    optics::GreyImage image;
    std::string text;
  };

  /// @throws CameraError when the system has no descriptor for it.
  FrameQueue();

  /// So many frames may wait.
  static constexpr std::size_t kCapacity = 4;

  /// Adds an item, waiting for room. @return false: the feed is closed, the thread should end.
  bool push(Item item);

  /// Adds a frame in place of the oldest when there is no room. @return as push()
  bool pushDroppingOldest(Item item);

  /// An image to fill for the next item, with the memory of one that was taken back.
  [[nodiscard]] optics::GreyImage blank(int width, int height);

  /// Waits, unless the feed is closed before. @return whether it is still open.
  bool pause(std::int64_t microseconds);

  /// Ends all waiting of the thread.
  void close();

  [[nodiscard]] bool isOpen();
  [[nodiscard]] int descriptor() const { return ready_.get(); }
  [[nodiscard]] std::optional<Item> pop();
  void recycle(optics::GreyImage image);

 private:
  bool add(Item item);  // under the lock, as pop() clears the event under it

  FileDescriptor ready_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = true;
  std::deque<Item> items_;
  std::deque<optics::GreyImage> spare_;
};

}  // namespace lab::cameras
