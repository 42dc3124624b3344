/// One command at a time, until it is answered.
#pragma once

#include <cstdint>
#include <optional>

#include "robot/wire/frame.hpp"

namespace lab::bridge {

/// Keeps a command until its answer comes: has it sent again with the same number, so that the
/// robot knows it for the same; gives it up after three tries.
class CommandSender {
 public:
  /// @param timeout_us for one try
  void begin(const wire::Frame& command, std::int64_t now, std::int64_t timeout_us);

  [[nodiscard]] bool isWaiting() const { return command_.has_value(); }

  /// The command that the answer `seq` belongs to, which is then done, also when it was given up
  /// and the answer comes late; nothing when it belongs to none.
  [[nodiscard]] std::optional<wire::Frame> answer(std::uint8_t type, std::uint8_t seq);

  enum class Due { kNothing, kSendAgain, kGivenUp };
  [[nodiscard]] Due check(std::int64_t now);

  /// The command to be sent again, while one is waiting.
  [[nodiscard]] wire::Frame& command() { return *command_; }

  void forget() {
    command_.reset();
    given_up_.reset();
  }

 private:
  std::optional<wire::Frame> command_;
  std::optional<wire::Frame> given_up_;  ///< the last of them
  int tries_ = 0;
  std::int64_t timeout_us_ = 0;
  std::int64_t due_ = 0;
};

}  // namespace lab::bridge
