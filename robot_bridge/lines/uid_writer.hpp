/// Stores a uid in a robot: robot_bridge --set-uid.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/loop/loop.hpp"
#include "common/serial/serial.hpp"
#include "robot_bridge/lines/line_session.hpp"
#include "robot_bridge/protocol/command_sender.hpp"

namespace lab::bridge {

/// Waits for the robot's HELLO, sets the uid, has it stored, and reads it back.
class UidWriter {
 public:
  /// @throws SerialError when the line cannot be opened.
  UidWriter(Loop& loop, SerialPorts& ports, const std::string& path, int baud, std::uint32_t uid);

  /// To be called about every 20 ms. @return whether it has finished or failed
  bool tick();

  /// Why it failed; empty if it did not.
  [[nodiscard]] const std::string& failure() const { return failure_; }

 private:
  enum class Step { kHello, kSet, kStore, kVerify, kDone };

  void read();
  void handle(const wire::Frame& frame);
  void start(Step step);
  void fail(const std::string& why);
  void write(const wire::Frame& frame);
  template <class Message>
  void command(const Message& message, std::int64_t timeout_us);

  Loop& loop_;
  std::string path_;
  int baud_;
  std::uint32_t uid_;
  std::unique_ptr<SerialPort> port_;
  LineSession session_;
  CommandSender sender_;
  std::uint8_t seq_ = 0;
  Step step_ = Step::kHello;
  std::string failure_;
};

}  // namespace lab::bridge
