#include "robot_bridge/lines/line_session.hpp"

#include <fmt/format.h>

#include "common/process/installation.hpp"

namespace lab::bridge {
namespace {

constexpr std::int64_t kBootloaderWait_us = 2'500'000;
constexpr std::int64_t kAskPeriod_us = 300'000;
constexpr std::int64_t kHelloTimeout_us = 6'000'000;

}  // namespace

void LineSession::ask(std::int64_t now) {
  if (now - asked_utime_ < kAskPeriod_us) return;
  asked_utime_ = now;
  wire::Frame frame;
  wire::pack(wire::GetInfo(), 0, frame);
  std::uint8_t bytes[wire::kMaxFrame];
  const std::uint8_t size = wire::encode(frame, bytes);
  outgoing_.insert(outgoing_.end(), bytes, bytes + size);
}

void LineSession::tick(std::int64_t now) {
  if (verdict_ != Verdict::kWaiting) return;
  if (now - opened_utime_ >= kHelloTimeout_us) {
    verdict_ = Verdict::kNoRobot;
  } else if (now - opened_utime_ >= kBootloaderWait_us) {
    ask(now);
  }
}

bool LineSession::isForRobot(const wire::Frame& frame, std::int64_t now) {
  wire::Hello hello;
  if (wire::unpack(frame, hello)) {
    hello_ = hello;
    verdict_ = hello.schema == wire::kSchema ? Verdict::kRobot : Verdict::kForeignSchema;
  } else if (verdict_ == Verdict::kWaiting) {
    // A HELLO of another length has another schema. Every HELLO starts with the schema number.
    if (frame.type == wire::Hello::kType && frame.size >= 4) {
      hello_.emplace();
      hello_->schema = static_cast<std::uint16_t>(frame.payload[0] | frame.payload[1] << 8);
      hello_->firmware = static_cast<std::uint16_t>(frame.payload[2] | frame.payload[3] << 8);
      verdict_ = Verdict::kForeignSchema;
    } else {
      ask(now);
    }
  }
  return verdict_ == Verdict::kRobot;
}

void LineSession::checkVersion() {
  if (verdict_ == Verdict::kWaiting && decoder_.foreignVersion() != 0) {
    verdict_ = Verdict::kForeignVersion;
  }
}

void LineSession::countErrors() {
  const wire::DecoderCounts& counts = decoder_.counts();
  const auto all = static_cast<std::uint16_t>(counts.crc + counts.malformed + counts.version);
  errors_ += static_cast<std::uint16_t>(all - errors_counted_);
  errors_counted_ = all;
}

std::string LineSession::reason(int baud) const {
  const std::string update =
      "; update what is older: " + installation().command + " flash, or the lab itself";
  switch (verdict_) {
    case Verdict::kForeignVersion:
      return fmt::format("a robot with protocol version {}, this lab has version {}{}",
                         decoder_.foreignVersion(), wire::kProtocolVersion, update);
    case Verdict::kForeignSchema:
      return fmt::format(
          "a robot with messages of schema {:04x} (firmware {}.{}), this lab has schema {:04x}{}",
          hello_->schema, hello_->firmware >> 8, hello_->firmware & 0xFF, wire::kSchema, update);
    case Verdict::kNoRobot:
      if (bytes_ == 0) {
        return "no robot answers; is it switched on, and is this its line?";
      }
      return fmt::format(
          "{} bytes received, but none from a robot; is this another device, or is its speed not "
          "{} baud?",
          bytes_, baud);
    case Verdict::kWaiting:
    case Verdict::kRobot:
      break;
  }
  return {};
}

}  // namespace lab::bridge
