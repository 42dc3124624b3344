#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace lab::analysis {

/// A frame of one robot. Slots count frame periods; SI units.
struct Fix {
  std::int64_t slot = -1;
  double time = 0;
  double x = 0;
  double y = 0;
  double theta = 0;
};

/// Longest gap, in frame periods, across which poses are interpolated: at most one lost frame.
inline constexpr double kBracket = 2.2;

/// The newest frames of one robot, in consecutive slots: kHistory slots, some of which may lack
/// their frames, and then a collection without lost frames. Positions count slots from the oldest
/// one; the collection begins at kHistory.
class FrameHistory {
 public:
  static constexpr std::size_t kHistory = 80;
  static constexpr std::size_t kCollection = 64;
  using Values = std::array<double, kHistory + kCollection>;

  /// Adds a frame to the collection, which must not be full; its slot is ignored.
  void push(const Fix& fix) {
    const std::size_t at = end();
    time_[at] = fix.time;
    x_[at] = fix.x;
    y_[at] = fix.y;
    theta_[at] = fix.theta;
    ++count_;
  }

  /// Ends the collection and begins an empty one after it.
  void retire();

  /// Marks the frames of the next slots as lost. The collection must be empty.
  void lose(std::int64_t slots);

  /// Discards all frames. The collection must be empty.
  void forget();

  [[nodiscard]] std::size_t count() const { return count_; }  ///< Frames in the collection.
  [[nodiscard]] bool full() const { return count_ == kCollection; }
  [[nodiscard]] std::int64_t first() const {
    return first_;
  }                                            ///< Slot of its first frame, or of the next one.
  [[nodiscard]] std::int64_t newest() const {  ///< Slot of its last frame.
    return first_ + static_cast<std::int64_t>(count_) - 1;
  }
  [[nodiscard]] std::size_t end() const {
    return kHistory + count_;
  }  ///< Position behind the last frame.

  // By position. The time of a lost frame is nan.
  [[nodiscard]] const Values& time() const { return time_; }
  [[nodiscard]] const Values& x() const { return x_; }
  [[nodiscard]] const Values& y() const { return y_; }
  [[nodiscard]] const Values& theta() const { return theta_; }

  [[nodiscard]] Fix at(std::size_t position) const {
    return {first_ + static_cast<std::int64_t>(position) - static_cast<std::int64_t>(kHistory),
            time_[position], x_[position], y_[position], theta_[position]};
  }

  /// The frame of a slot of the collection. The collection must have the slot.
  [[nodiscard]] Fix collected(std::int64_t slot) const {
    return at(kHistory + static_cast<std::size_t>(slot - first_));
  }

  /// The frame of any slot; nullopt: lost, too old or in the future.
  [[nodiscard]] std::optional<Fix> find(std::int64_t slot) const;

  /// The pose at a time near the slot `guess`, interpolated between two frames at most kBracket
  /// periods apart. Its slot is that of the earlier frame. nullopt if there are no such frames.
  /// Times in s.
  [[nodiscard]] std::optional<Fix> interpolated(double time, std::int64_t guess,
                                                double period) const;

 private:
  void shift(std::size_t slots);  ///< Drops the oldest slots.

  Values time_{};
  Values x_{};
  Values y_{};
  Values theta_{};
  std::size_t count_ = 0;
  std::int64_t first_ = 0;
};

}  // namespace lab::analysis
