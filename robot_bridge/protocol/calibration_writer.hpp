/// Stores a motor calibration on a robot and reads back what the robot holds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <lab/motor_calibration_t.hpp>
#include <optional>

#include "robot/wire/messages.hpp"

namespace lab::bridge {

/// The commands of one request, one after the other: five SET_PARAM, COMMIT, five GET_PARAM. A
/// request with a gain of 0 only asks: it is the five GET_PARAM alone.
/// Whoever sends them says how they ended. What fails is tried again from the start with the next
/// repeat of the request.
class CalibrationWriter {
 public:
  /// A request, possibly one that is known.
  void ask(std::int64_t seq, std::int64_t instance, const motor_calibration_t& wanted);

  /// The robot has restarted: what it had not stored is lost.
  void restart();

  /// The next command, without its number; nothing when there is nothing to do.
  [[nodiscard]] std::optional<wire::Frame> next() const;

  /// Whether it is this errand's command, and then what became of it.
  void finish(const wire::Frame& command, const wire::Ack& ack);
  void finish(const wire::ParamValue& value);

  /// What the robot holds, once the last request is fulfilled.
  [[nodiscard]] std::optional<motor_calibration_t> held() const;

  /// Why the last request failed: the answer to what; nothing when it has not.
  [[nodiscard]] const std::optional<wire::Ack>& failure() const { return failure_; }

 private:
  static constexpr std::size_t kParams = 5;
  static constexpr std::size_t kCommit = kParams;
  static constexpr std::size_t kRead = kParams + 1;
  static constexpr std::size_t kDone = kRead + kParams;

  std::int64_t seq_ = 0;
  std::int64_t instance_ = 0;
  std::int32_t robot_id_ = 0;
  std::array<std::int32_t, kParams> wanted_{};
  std::array<std::int32_t, kParams> held_{};
  std::size_t begin_ = 0;
  std::size_t step_ = kDone;
  bool fulfilled_ = false;
  std::optional<wire::Ack> failure_;
};

}  // namespace lab::bridge
