/// Stop-and-wait transmission of commands.
#pragma once

#include <cstdint>
#include <optional>

#include "robot/wire/frame.hpp"

namespace lab::bridge {

/// Holds one command until it is answered. A command is sent at most three times, always with the
/// same seq, so that the robot recognises a repetition. Then it is given up.
class CommandSender {
 public:
  /// @param timeout_us for one attempt
  void begin(const wire::Frame& command, std::int64_t now, std::int64_t timeout_us);

  [[nodiscard]] bool isWaiting() const { return command_.has_value(); }

  /// Finds the command that an answer belongs to: the waiting one, or the last one given up, whose
  /// answer is late. That command is then done. Empty if the answer belongs to neither.
  [[nodiscard]] std::optional<wire::Frame> answer(std::uint8_t type, std::uint8_t seq);

  enum class Due { kNothing, kSendAgain, kGivenUp };
  [[nodiscard]] Due check(std::int64_t now);

  /// The waiting command; isWaiting() must be true.
  [[nodiscard]] wire::Frame& command() { return *command_; }

  void forget() {
    command_.reset();
    given_up_.reset();
  }

 private:
  std::optional<wire::Frame> command_;
  std::optional<wire::Frame> given_up_;  ///< the last one
  int tries_ = 0;
  std::int64_t timeout_us_ = 0;
  std::int64_t due_ = 0;
};

}  // namespace lab::bridge
