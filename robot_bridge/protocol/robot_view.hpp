/// Combines the messages of one robot into snapshots of its state.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "robot/wire/messages.hpp"
#include "robot_bridge/protocol/clock_estimate.hpp"

namespace lab::bridge {

/// b - a [ms] on a robot's clock, which wraps around.
[[nodiscard]] constexpr std::int32_t msBetween(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::int32_t>(b - a);
}

/// A 32-bit count of which the robot reports the low 16 bits.
class UnwrappedCount {
 public:
  void update(std::uint16_t low) { value_ += static_cast<std::uint16_t>(low - value_); }
  [[nodiscard]] std::uint32_t value() const { return value_; }

 private:
  std::uint32_t value_ = 0;
};

/// A TELEMETRY together with the STATE that belongs to it.
struct RobotSnapshot {
  wire::Telemetry telemetry;
  wire::State state;
  std::uint32_t program_epoch = 0;
  std::uint32_t reversal_count = 0;
  std::uint32_t tumble_count = 0;
  std::uint32_t saturation_count = 0;
  double run_time_ms = 0;  ///< time in the first phase of programs, on the robot's clock
  double battery = 0;      ///< [V]
};

/// Combines the robot's messages. A TELEMETRY that does not match the last STATE, because a message
/// was lost, gives no snapshot; the next STATE comes within 250 ms.
class RobotView {
 public:
  /// The robot has restarted, or it is another one. Counts of lost messages are kept.
  void reset();

  void update(const wire::Telemetry& telemetry, std::uint8_t seq);
  void update(const wire::State& state);
  void update(const wire::Counters& counters);
  void update(const wire::Step& step);

  /// The last snapshot.
  [[nodiscard]] const std::optional<RobotSnapshot>& snapshot() const { return snapshot_; }

  /// Whether there is a new snapshot since the last call.
  [[nodiscard]] bool takeUpdateFlag();

  /// A step and its unwrapped epoch.
  struct UnwrappedStep {
    wire::Step step;
    std::uint32_t program_epoch;
  };
  /// The steps since the last call.
  [[nodiscard]] std::vector<UnwrappedStep> takeSteps();

  /// Messages that the robot sent and that did not arrive.
  [[nodiscard]] std::int64_t telemetryLost() const { return telemetry_lost_; }
  [[nodiscard]] std::int64_t stepsLost() const { return steps_lost_; }
  /// Damaged frames that the robot received, over all its restarts.
  [[nodiscard]] std::uint32_t framesBad() const { return frames_bad_before_ + frames_bad_.value(); }

 private:
  [[nodiscard]] bool fits(const wire::Telemetry& telemetry) const;
  [[nodiscard]] bool inRun(const wire::Telemetry& telemetry) const;
  void countRunTime(const wire::Telemetry& telemetry);

  std::optional<wire::Telemetry> last_;
  std::optional<wire::State> state_;
  std::optional<RobotSnapshot> snapshot_;
  bool updated_ = false;
  std::vector<UnwrappedStep> steps_;
  std::uint8_t telemetry_seq_ = 0;
  std::optional<std::uint32_t> draw_count_;

  UnwrappedCount program_epoch_;
  UnwrappedCount reversal_count_;
  UnwrappedCount tumble_count_;
  UnwrappedCount saturation_count_;
  UnwrappedCount frames_bad_;
  std::uint32_t tumbles_reported_ = 0;  ///< in telemetry since the last STATE
  double run_time_ms_ = 0;
  double battery_ = 0;
  std::int64_t telemetry_lost_ = 0;
  std::int64_t steps_lost_ = 0;
  std::uint32_t frames_bad_before_ = 0;
};

}  // namespace lab::bridge
