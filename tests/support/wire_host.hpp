/// The host side of a robot's serial line, for tests.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/programs/program.hpp"
#include "common/serial/serial.hpp"
#include "robot/wire/config.hpp"
#include "robot/wire/messages.hpp"

namespace lab::sim {

/// A minimal host at the other end of a robot's line.
class WireHost {
 public:
  WireHost(SerialPorts& ports, const std::string& name) : port_(ports.open(name, 38400)) {
    port_->onReadable([this] { take(); });
  }

  template <class Message>
  void send(const Message& message) {
    wire::Frame frame;
    wire::pack(message, ++seq_, frame);
    std::array<std::uint8_t, wire::kMaxFrame> encoded{};
    const std::uint8_t size = wire::encode(frame, encoded.data());
    const std::size_t taken = port_->write(std::span(encoded).first(size));
    if (taken != size) throw SerialError("the line is full");
  }

  /// Loads a program. The robot has it a second later.
  void load(const Program& program) {
    wire::LoadBegin begin;
    begin.hash = program.hash;
    begin.size = static_cast<std::uint8_t>(program.code.size());
    send(begin);
    for (std::size_t at = 0; at < program.code.size(); at += wire::LoadData::kBytes) {
      wire::LoadData data;
      data.offset = static_cast<std::uint8_t>(at);
      const std::size_t end = std::min(at + wire::LoadData::kBytes, program.code.size());
      std::copy(program.code.begin() + static_cast<std::ptrdiff_t>(at),
                program.code.begin() + static_cast<std::ptrdiff_t>(end), data.code);
      send(data);
    }
    wire::LoadEnd load_end;
    load_end.hash = program.hash;
    send(load_end);
  }

  /// Applies settings and seed, and switches on the step log. The robot must have the programs.
  void configure(const dynamics::CoreSettings& settings, std::uint64_t seed) {
    for (std::uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
      send(wire::programMessage(settings, slot));
    }
    send(wire::lightMessage(settings));
    send(wire::motionMessage(settings));
    wire::Apply apply;
    apply.config = wire::configCrc(settings);
    send(apply);
    wire::SetSeed set_seed;
    set_seed.high = static_cast<std::uint32_t>(seed >> 32);
    set_seed.low = static_cast<std::uint32_t>(seed);
    send(set_seed);
    wire::SetParam log;
    log.id = wire::kStepLog;
    log.value = 1;
    send(log);
    order.config = apply.config;
  }

  /// Lets the light select the program, under a lease.
  void run(std::uint32_t lease_ms) {
    order.mode = wire::Order::kTable;
    order.lease_ms = lease_ms;
    send(order);
  }

  /// All messages of a type received so far.
  template <class Message>
  [[nodiscard]] std::vector<Message> all() const {
    std::vector<Message> messages;
    for (const wire::Frame& frame : frames) {
      Message message;
      if (wire::unpack(frame, message)) messages.push_back(message);
    }
    return messages;
  }

  wire::Order order;
  std::vector<wire::Frame> frames;
  std::vector<std::uint8_t> bytes;

 private:
  void take() {
    std::array<std::uint8_t, 256> buffer{};
    while (const std::size_t count = port_->read(buffer)) {
      for (std::size_t i = 0; i < count; ++i) {
        bytes.push_back(buffer[i]);
        if (decoder_.push(buffer[i])) frames.push_back(decoder_.frame());
      }
    }
  }

  std::unique_ptr<SerialPort> port_;
  wire::Decoder decoder_;
  std::uint8_t seq_ = 0;
};

}  // namespace lab::sim
