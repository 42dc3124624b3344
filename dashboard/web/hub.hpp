/// The newest text of each topic, written by the lab's loop and read by the threads of the viewers.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace lab::dashboard {

/// Holds state, not events: only the newest text of a topic. A reader receives every topic that
/// changed since its last call, once, in the order of the changes. A slow reader therefore skips
/// texts, and readers cost no memory. All readers share one text. Thread-safe.
///
/// A topic whose name begins with a dot is not part of the event stream; the page requests it:
/// ".light" holds the raster of topic `light` as bytes (GET /api/light).
class Hub {
 public:
  using Text = std::shared_ptr<const std::string>;

  struct Change {
    std::string topic;
    Text text;
    std::uint64_t version = 0;
  };

  /// Replaces a topic's text and wakes the readers.
  void publish(std::string_view topic, std::string text);

  /// Replaces a topic's text without waking the readers. They see it with the next change.
  void publishQuietly(std::string_view topic, std::string text);

  /// Removes a topic. Readers that have seen it receive the text `null` once, new readers nothing.
  void remove(std::string_view topic);

  /// The newest text of a topic; null if there is none.
  [[nodiscard]] Text newest(std::string_view topic) const;

  /// The topics that changed after version `seen`, which is then set to the newest version. Waits
  /// for a change at most until the timeout. A reader that begins with seen = 0 receives all
  /// topics.
  /// @return empty if nothing changed or the hub is closed
  [[nodiscard]] std::vector<Change> changesSince(std::uint64_t& seen,
                                                 std::chrono::milliseconds timeout) const;

  /// Wakes all readers; from now on they receive nothing.
  void close();
  [[nodiscard]] bool closed() const;

 private:
  struct Topic {
    Text text;
    std::uint64_t version = 0;
    bool removed = false;
  };

  /// Removed topics that are remembered for readers that have not received `null` yet.
  static constexpr std::ptrdiff_t kMaxRemoved = 200;

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::map<std::string, Topic, std::less<>> topics_;
  std::uint64_t version_ = 0;
  bool closed_ = false;
};

}  // namespace lab::dashboard
