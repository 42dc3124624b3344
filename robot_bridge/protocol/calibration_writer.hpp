/// Stores a motor calibration on a robot and reads back what the robot holds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <lab/motor_calibration_t.hpp>
#include <optional>

#include "robot/wire/messages.hpp"

namespace lab::bridge {

/// The sequence of commands for one request: five SET_PARAM, COMMIT, five GET_PARAM. A request with
/// a gain of 0 only reads: five GET_PARAM. The caller sends the commands and reports their results.
/// After a failure the sequence starts again when the request is repeated.
class CalibrationWriter {
 public:
  /// Starts a request, unless it is a repetition of the last one.
  void request(std::int64_t seq, std::int64_t instance, const motor_calibration_t& requested);

  /// The robot has restarted, and values that it had not stored are lost.
  void restart();

  /// The next command, without its seq; empty if there is nothing to do.
  [[nodiscard]] std::optional<wire::Frame> next() const;

  /// Reports the result of a command. Other commands than the current one are ignored.
  void finish(const wire::Frame& command, const wire::Ack& ack);
  void finish(const wire::ParamValue& value);

  /// The values read from the robot, once the last request is complete.
  [[nodiscard]] std::optional<motor_calibration_t> held() const;

  /// The answer that made the last request fail; empty if it did not fail.
  [[nodiscard]] const std::optional<wire::Ack>& failure() const { return failure_; }

 private:
  static constexpr std::size_t kParams = 5;
  static constexpr std::size_t kCommit = kParams;
  static constexpr std::size_t kRead = kParams + 1;
  static constexpr std::size_t kDone = kRead + kParams;

  std::int64_t seq_ = 0;
  std::int64_t instance_ = 0;
  std::int32_t robot_id_ = 0;
  std::array<std::int32_t, kParams> requested_{};
  std::array<std::int32_t, kParams> held_{};
  std::size_t begin_ = 0;
  std::size_t step_ = kDone;
  bool fulfilled_ = false;
  std::optional<wire::Ack> failure_;
};

}  // namespace lab::bridge
