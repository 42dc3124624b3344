#pragma once

#include <cstdint>
#include <type_traits>

#include "robot/wire/crc16.hpp"
#include "robot/wire/messages.hpp"

// For the host only: a list of all messages, and the hash of their fields.

namespace lab {
namespace wire {

/// To be incremented when a field keeps its width but changes its meaning (unit, range, numbers of
/// an enum), because schema() only covers widths, order and types.
constexpr uint8_t kMeaning = 1;

/// Calls visit(name, message) with a default message of every type, in the order of the types.
/// Names are those of docs/protocol.md.
template <class Visit>
void forEachMessage(Visit&& visit) {
  visit("PING", Ping{});
  visit("GET_INFO", GetInfo{});
  visit("SET_PROGRAM", SetProgram{});
  visit("SET_LIGHT", SetLight{});
  visit("SET_MOTION", SetMotion{});
  visit("APPLY", Apply{});
  visit("ORDER", Order{});
  visit("STOP", Stop{});
  visit("SET_SEED", SetSeed{});
  visit("SET_PARAM", SetParam{});
  visit("GET_PARAM", GetParam{});
  visit("COMMIT", Commit{});
  visit("LOAD_BEGIN", LoadBegin{});
  visit("LOAD_DATA", LoadData{});
  visit("LOAD_END", LoadEnd{});
  visit("GET_PROGRAMS", GetPrograms{});
  visit("SET_SENSES", SetSenses{});
  visit("PONG", Pong{});
  visit("HELLO", Hello{});
  visit("ACK", Ack{});
  visit("TELEMETRY", Telemetry{});
  visit("STATE", State{});
  visit("STEP", Step{});
  visit("COUNTERS", Counters{});
  visit("EVENT", Event{});
  visit("PARAM", ParamValue{});
  visit("PROGRAMS", Programs{});
}

/// Computes a CRC over one byte per field: the width in bytes, plus 128 if signed. An array of
/// 10-bit counts gives two bytes: 10 and the number of values.
class FieldSchema {
 public:
  explicit FieldSchema(Crc16& crc) : crc_(crc) {}

  void operator()(const uint8_t&) { crc_.add(1); }
  void operator()(const uint16_t&) { crc_.add(2); }
  void operator()(const uint32_t&) { crc_.add(4); }
  void operator()(const int32_t&) { crc_.add(128 + 4); }
  template <uint8_t N>
  void counts10(const uint16_t (&)[N]) {
    crc_.add(10);
    crc_.add(N);
  }

 private:
  Crc16& crc_;
};

/// The value that kSchema must have: CRC-16 over the protocol version, kMeaning, and for each
/// message its type, its fields and its payload size.
inline uint16_t schema() {
  Crc16 crc;
  crc.add(kProtocolVersion);
  crc.add(kMeaning);
  forEachMessage([&crc](const char*, const auto& message) {
    using Message = std::remove_cvref_t<decltype(message)>;
    crc.add(Message::kType);
    FieldSchema fields(crc);
    Message::fields(message, fields);
    crc.add(payloadSize<Message>());
  });
  return crc.value();
}

}  // namespace wire
}  // namespace lab
