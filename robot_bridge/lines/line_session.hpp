/// What comes and goes on one open line: bytes on one side, a robot's frames on the other.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robot/wire/frame.hpp"
#include "robot/wire/messages.hpp"

namespace lab::bridge {

/// Finds out who is on a line that was just opened, and cuts the bytes into frames.
///
/// Opening a line resets many boards, and their bootloader must not be talked to: the session is
/// silent until HELLO comes or 2.5 s have passed, then asks for it. Any other frame shows that the
/// robot's program runs, and it is asked at once.
class LineSession {
 public:
  explicit LineSession(std::int64_t now) : opened_utime_(now) {}

  enum class Verdict {
    kWaiting,         ///< nobody has said HELLO yet
    kRobot,           ///< hello() says which
    kForeignVersion,  ///< frames of another protocol version come
    kForeignSchema,   ///< HELLO is of a robot with other messages
    kNoRobot,         ///< nobody says HELLO
  };

  /// Takes bytes and calls `take(frame)` for each frame of a robot that is known by then, the first
  /// of them its HELLO.
  template <class Take>
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now, const Take& take) {
    bytes_ += static_cast<std::int64_t>(bytes.size());
    for (const std::uint8_t byte : bytes) {
      if (decoder_.push(byte) && isForRobot(decoder_.frame(), now)) take(decoder_.frame());
    }
    judgeVersion();
    countErrors();
  }

  /// Asks and gives up.
  void tick(std::int64_t now);

  [[nodiscard]] Verdict verdict() const { return verdict_; }
  /// Why it is no robot to be driven: what was found, what was expected, and the way out.
  [[nodiscard]] std::string reason(int baud) const;
  /// Who said HELLO last.
  [[nodiscard]] const std::optional<wire::Hello>& hello() const { return hello_; }
  /// Frames that came damaged.
  [[nodiscard]] std::int64_t errors() const { return errors_; }
  [[nodiscard]] std::vector<std::uint8_t>& outgoing() { return outgoing_; }

 private:
  bool isForRobot(const wire::Frame& frame, std::int64_t now);
  void judgeVersion();
  void countErrors();
  void ask(std::int64_t now);

  std::int64_t opened_utime_;
  std::int64_t asked_utime_ = 0;
  std::int64_t bytes_ = 0;
  std::int64_t errors_ = 0;
  std::uint16_t errors_seen_ = 0;
  wire::Decoder decoder_;
  Verdict verdict_ = Verdict::kWaiting;
  std::optional<wire::Hello> hello_;
  std::vector<std::uint8_t> outgoing_;
};

}  // namespace lab::bridge
