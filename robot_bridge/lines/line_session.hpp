/// One open serial line: identifies the robot and decodes its frames.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robot/wire/frame.hpp"
#include "robot/wire/messages.hpp"

namespace lab::bridge {

/// Identifies the robot on a line that was just opened, and decodes the bytes into frames.
///
/// Opening a line resets many boards, and bytes sent to their bootloader would keep them in it.
/// Therefore the session sends nothing until HELLO comes or 2.5 s have passed; then it asks for
/// HELLO. Any other frame shows that the robot's program runs, and the session asks at once.
class LineSession {
 public:
  explicit LineSession(std::int64_t now) : opened_utime_(now) {}

  enum class Verdict {
    kWaiting,         ///< no HELLO yet
    kRobot,           ///< hello() identifies it
    kForeignVersion,  ///< frames have another protocol version
    kForeignSchema,   ///< HELLO has another message schema
    kNoRobot,         ///< no HELLO came in time
  };

  /// Decodes bytes and calls `handle(frame)` for each frame after the robot is identified, starting
  /// with its HELLO.
  template <class Handle>
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now, const Handle& handle) {
    bytes_ += static_cast<std::int64_t>(bytes.size());
    for (const std::uint8_t byte : bytes) {
      if (decoder_.push(byte) && isForRobot(decoder_.frame(), now)) handle(decoder_.frame());
    }
    checkVersion();
    countErrors();
  }

  /// Handles timeouts: asks for HELLO, then gives up.
  void tick(std::int64_t now);

  [[nodiscard]] Verdict verdict() const { return verdict_; }
  /// Why there is no usable robot on the line, for the user; empty if there is one or it is not yet
  /// known.
  [[nodiscard]] std::string reason(int baud) const;
  /// The last HELLO.
  [[nodiscard]] const std::optional<wire::Hello>& hello() const { return hello_; }
  /// Number of damaged frames received.
  [[nodiscard]] std::int64_t errors() const { return errors_; }
  [[nodiscard]] std::vector<std::uint8_t>& outgoing() { return outgoing_; }

 private:
  bool isForRobot(const wire::Frame& frame, std::int64_t now);
  void checkVersion();
  void countErrors();
  void ask(std::int64_t now);

  std::int64_t opened_utime_;
  std::int64_t asked_utime_ = 0;
  std::int64_t bytes_ = 0;
  std::int64_t errors_ = 0;
  std::uint16_t errors_counted_ = 0;
  wire::Decoder decoder_;
  Verdict verdict_ = Verdict::kWaiting;
  std::optional<wire::Hello> hello_;
  std::vector<std::uint8_t> outgoing_;
};

}  // namespace lab::bridge
