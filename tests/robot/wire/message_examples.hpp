/// One example of every message with its frame. The frames were assembled by hand from the layout
/// in docs/protocol.md, not by the codec under test.
#pragma once

#include <cstdint>
#include <sstream>
#include <string>

#include "robot/wire/schema.hpp"
#include "tests/robot/wire/frames.hpp"

namespace lab::wire {

/// "00 1F ..." as bytes.
inline Bytes hexBytes(const std::string& text) {
  std::istringstream in(text);
  Bytes bytes;
  unsigned value = 0;
  while (in >> std::hex >> value) bytes.push_back(static_cast<std::uint8_t>(value));
  return bytes;
}

/// Calls visit(message, seq, frame in hex) for an example of every message, in the order of the
/// types.
template <class Visit>
void forEachExample(Visit&& visit) {
  visit(Ping{0x01020304, 0x05060708}, 1, "00 0F 01 01 01 08 04 03 02 01 08 07 06 05 F5 34 00");
  visit(GetInfo{}, 2, "00 04 01 02 02 03 6D 66 00");
  visit(SetProgram{3, 4, 50000, -100000, 1000, 333333, 500, 235619, -270000, 270000}, 3,
        "00 09 01 10 03 22 03 04 50 C3 01 07 60 79 FE FF E8 03 01 04 15 16 05 03 F4 "
        "01 01 04 63 98 03 08 50 E1 FB FF B0 1E 04 03 55 D6 00");
  visit(SetLight{4, 2, 10, {0, 100, 400, 700}, {100, 400, 700, 1024}, {0, 1, 2, 3}}, 4,
        "00 08 01 11 04 18 04 02 0A 01 01 02 64 01 02 64 0B 90 01 01 90 01 BC 02 02 "
        "BC 02 05 04 03 88 AD 00");
  visit(SetMotion{1, 400000, 100000, 8, 270000, 20}, 5,
        "00 09 01 12 05 11 01 80 1A 06 04 A0 86 01 02 08 04 B0 1E 04 02 14 03 FD 95 00");
  visit(Apply{0xBEEF}, 6, "00 09 01 13 06 02 EF BE AE 92 00");
  visit(Order{9, Order::kDrive, 0xBEEF, -50000, 50000, 500}, 7,
        "00 0F 01 14 07 10 09 02 EF BE B0 3C FF FF 50 C3 01 03 F4 01 01 03 79 B3 00");
  visit(Stop{3, Stop::kStop}, 8, "00 09 01 15 08 02 03 5A 67 E6 00");
  visit(SetSeed{0xDEADBEEF, 42}, 9, "00 0A 01 16 09 08 EF BE AD DE 2A 01 01 03 35 5C 00");
  visit(SetParam{kGainLeft, 987654}, 10, "00 09 01 17 0A 05 02 06 12 0F 03 4B 28 00");
  visit(GetParam{kUid}, 11, "00 08 01 18 0B 01 01 BD C3 00");
  visit(Commit{}, 12, "00 04 01 19 0C 03 4E 50 00");
  visit(Pong{0x01020304, 0x05060708, 65536, 999}, 1,
        "00 0D 01 81 01 0E 04 03 02 01 08 07 06 05 01 02 01 05 E7 03 3E AF 00");
  visit(Hello{0xD336, 0x0102, 0x89ABCDEF, 0x51000007, 0xC0DE, kResetWatchdog, 1, 255, 86400000,
              38400},
        0,
        "00 03 01 82 0B 19 36 D3 02 01 EF CD AB 89 07 01 07 51 DE C0 04 01 FF 04 5C "
        "26 05 02 96 01 03 43 68 00");
  visit(Ack{Order::kType, kWrongConfig, 2}, 7, "00 0A 01 83 07 03 14 04 02 ED AD 00");
  visit(Telemetry{1000,
                  0x0412,
                  255,
                  4,
                  513,
                  -135000,
                  135000,
                  {0, 1023, 512, 255, 256, 1, 1022, 769},
                  0xBEEF,
                  9,
                  3},
        200,
        "00 07 01 90 C8 20 E8 03 01 0E 12 04 FF 04 01 02 A8 F0 FD FF 58 0F 02 01 02 "
        "FF 03 FF 2C 0B 01 FE 01 F1 EF BE 09 03 3C 02 00");
  visit(State{5000, 7, 4000, -1, 1, 2, 4100, 4200, 65535}, 201,
        "00 07 01 91 C9 1E 88 13 01 02 07 03 A0 0F 01 06 FF FF FF FF 01 01 01 02 02 "
        "03 04 10 01 03 68 10 01 05 FF FF 99 72 00");
  visit(Step{123456789, 1000000, 65534, 2, 1, 12345, -12345, 1000, 0x12345678}, 202,
        "00 0C 01 92 CA 1C 15 CD 5B 07 40 42 0F 07 FE FF 02 01 39 30 01 07 C7 CF FF "
        "FF E8 03 01 07 78 56 34 12 F8 84 00");
  visit(Counters{60000, 30000, 77, 1, 3300, 600, 2, 3, 4, 5, 50}, 203,
        "00 07 01 93 CB 1B 60 EA 01 03 30 75 01 02 4D 01 01 02 01 06 E4 0C 58 02 02 "
        "02 03 02 04 02 05 04 32 B7 4B 00");
  visit(Event{70000, 5, kBooted, kResetWatchdog}, 204,
        "00 08 01 94 CC 0B 70 11 01 02 05 03 01 04 01 01 03 73 A0 00");
  visit(ParamValue{kUid, 0x51000007}, 11, "00 07 01 95 0B 05 01 07 01 04 51 8D 86 00");
}

}  // namespace lab::wire
