// Frames on the serial line, in both directions: the host's link with one robot, or the firmware.
#include <array>
#include <cstdint>
#include <lab/motor_calibration_t.hpp>
#include <lab/robot_order_t.hpp>
#include <lab/robot_state_t.hpp>
#include <span>

#include "robot/firmware/device.hpp"
#include "robot/wire/frame.hpp"
#include "robot_bridge/lines/line_session.hpp"
#include "robot_bridge/protocol/robot_link.hpp"
#include "robot_bridge/protocol/robot_messages.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/fuzz/messages.hpp"

namespace lab::fuzz {
namespace {

class Board final : public firmware::Board {
 public:
  void setMotors(std::int16_t /*left*/, std::int16_t /*right*/) override {}
  bool send(const std::uint8_t* /*bytes*/, std::uint8_t /*size*/) override { return line_free; }
  [[nodiscard]] bool lineIdle() const override { return line_free; }
  [[nodiscard]] std::uint8_t readStore(std::uint16_t address) const override {
    return store.at(address);
  }
  void writeStore(std::uint16_t address, std::uint8_t byte) override { store.at(address) = byte; }
  [[nodiscard]] std::uint16_t stackLeft() const override { return 300; }

  std::array<std::uint8_t, 1024> store{};
  bool line_free = true;
};

/// One step of the line: bytes as they are, or a frame with a correct CRC, so that the fuzzer gets
/// behind it.
std::span<const std::uint8_t> nextBytes(Input& input, std::array<std::uint8_t, 255>& bytes) {
  const auto form = input.number<std::uint8_t>();
  if (form % 2 == 0) return input.take(form / 2U);
  wire::Frame frame;
  frame.type = input.number<std::uint8_t>();
  frame.seq = input.number<std::uint8_t>();
  for (const std::uint8_t byte : input.take((form / 2U) % (wire::kMaxPayload + 1U))) {
    frame.payload[frame.size++] = byte;
  }
  return std::span(bytes).first(wire::encode(frame, bytes.data()));
}

void runDevice(Input& input) {
  Board board;
  firmware::BootFacts facts;
  facts.baud = 38400;
  const bool stored = input.number<std::uint8_t>() % 2 != 0;
  board.store.fill(0xFF);
  if (stored) {
    for (std::uint8_t& byte : board.store) byte = input.number<std::uint8_t>();
  }
  firmware::Device device(board, facts);
  auto now_ms = input.number<std::uint32_t>();
  device.boot(now_ms);
  std::array<std::uint8_t, 255> bytes{};
  for (int steps = 0; steps < 200 && !input.empty(); ++steps) {
    for (const std::uint8_t byte : nextBytes(input, bytes)) {
      device.receive(now_ms, static_cast<std::uint16_t>(now_ms * 1000U), byte);
    }
    const auto wait = input.number<std::uint8_t>();
    board.line_free = wait % 8 != 7;
    if (wait == 0) now_ms += input.number<std::uint16_t>();  // the program was held up
    for (int ms = 0; ms < wait; ++ms) {
      ++now_ms;
      if (device.scanDue(now_ms)) {
        dynamics::Sensors sensors;
        sensors.light_front = input.number<std::uint16_t>() % 1024U;
        sensors.light_back = input.number<std::uint16_t>() % 1024U;
        device.sense(now_ms, sensors);
      }
      device.tick(now_ms);
    }
  }
}

void runHost(Input& input) {
  std::int64_t now = 946'684'800'000'000;
  bridge::LineSession session(now);
  bridge::LinkSettings settings;
  settings.id = 1;
  bridge::RobotLink link(settings);
  bridge::ReportHistory reported;
  std::array<std::uint8_t, 255> bytes{};
  for (int steps = 0; steps < 200 && !input.empty(); ++steps) {
    session.receive(nextBytes(input, bytes), now, [&](const wire::Frame& frame) {
      if (!link.isPlugged()) link.plug(*session.hello(), now);
      link.receive(frame, now);
    });
    const auto next = input.number<std::uint8_t>();
    if (next % 8 == 1) {
      robot_order_t order{};
      read(input, order);
      link.command(input.number<std::int8_t>(), 1, input.number<std::int32_t>(), order, now);
    }
    if (next % 8 == 2) link.stop(input.number<std::int8_t>(), next / 8 % 2 != 0, now);
    if (next % 8 == 3) {
      motor_calibration_t calibration{};
      read(input, calibration);
      link.calibrate(input.number<std::int8_t>(), 1, calibration, now);
    }
    if (next % 32 == 4) link.unplug();
    now += 1000 * next;
    session.tick(now);
    link.tick(now);
    session.outgoing().clear();
    link.outgoing().clear();
    static_cast<void>(link.takeNotes());
    static_cast<void>(session.reason(settings.baud));
    static_cast<void>(bridge::statusOf(link, robot_state_t::SIM, reported));
    for (const auto& step : link.view().takeSteps()) static_cast<void>(bridge::stepOf(link, step));
  }
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  lab::fuzz::Input input(bytes, size);
  if (input.number<std::uint8_t>() % 2 == 0) {
    lab::fuzz::runDevice(input);
  } else {
    lab::fuzz::runHost(input);
  }
  return 0;
}
