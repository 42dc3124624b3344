/// What the page shows, newest state by topic, between the lab's loop and those who look.
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

/// State, not events: each topic holds its newest text. A reader is given every topic that changed
/// since it last looked, once, in the order of the changes; what changed twice meanwhile comes
/// once. A slow reader therefore skips, and no reader costs the publisher memory. A text is made
/// once, however many read it. Safe to use from any thread.
///
/// A topic whose name begins with a dot is not sent to the page by itself, which has to ask:
/// ".light", the raster of topic `light` as bytes (GET /api/light).
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

  /// The same for what nobody is to be woken for: it is seen with the next change or by newest().
  void publishQuietly(std::string_view topic, std::string text);

  /// Forgets a topic: who has seen it is told the text `null` once, late comers nothing.
  void remove(std::string_view topic);

  /// The newest text of a topic; null: there is none.
  [[nodiscard]] Text newest(std::string_view topic) const;

  /// What changed after `seen`, which is set to the newest version. Waits for a change for at most
  /// `patience`; empty: nothing changed, or the hub is closed. A reader that begins with seen = 0
  /// is given everything.
  [[nodiscard]] std::vector<Change> changesSince(std::uint64_t& seen,
                                                 std::chrono::milliseconds patience) const;

  /// Wakes all readers for good.
  void close();
  [[nodiscard]] bool closed() const;

 private:
  struct Topic {
    Text text;
    std::uint64_t version = 0;
    bool removed = false;
  };

  /// Those that are remembered for readers who have not been told yet.
  static constexpr std::ptrdiff_t kMostRemoved = 200;

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::map<std::string, Topic, std::less<>> topics_;
  std::uint64_t version_ = 0;
  bool closed_ = false;
};

}  // namespace lab::dashboard
