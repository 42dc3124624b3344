/// One example of every message with its frame. The frames were assembled from the layout in
/// docs/protocol.md by a program of its own, not by the codec under test.
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
  visit(Ping{0x01020304, 0x05060708}, 1, "00 0F 02 01 01 08 04 03 02 01 08 07 06 05 1B B3 00");
  visit(GetInfo{}, 2, "00 04 02 02 02 03 A0 43 00");
  visit(SetProgram{3, 0x89ABCDEF}, 3, "00 0C 02 10 03 05 03 EF CD AB 89 48 71 00");
  visit(SetLight{4, 2, 10, {0, 100, 400, 700}, {100, 400, 700, 1024}, {0, 1, 2, 3}}, 4,
        "00 08 02 11 04 18 04 02 0A 01 01 02 64 01 02 64 0B 90 01 01 90 01 BC 02 "
        "02 BC 02 05 04 03 BB F7 00");
  visit(SetMotion{1, 400000, 100000, 8, 270000, 20, 258, 37500}, 5,
        "00 09 02 12 05 17 01 80 1A 06 04 A0 86 01 02 08 04 B0 1E 04 02 14 05 02 "
        "01 7C 92 01 03 41 CD 00");
  visit(Apply{0xBEEF}, 6, "00 09 02 13 06 02 EF BE D3 9E 00");
  visit(Order{9, Order::kDrive, 0xBEEF, -50000, 50000, 500}, 7,
        "00 0F 02 14 07 10 09 02 EF BE B0 3C FF FF 50 C3 01 03 F4 01 01 03 92 DA "
        "00");
  visit(Stop{3, Stop::kStop}, 8, "00 09 02 15 08 02 03 5A 1A EA 00");
  visit(SetSeed{0xDEADBEEF, 42}, 9, "00 0A 02 16 09 08 EF BE AD DE 2A 01 01 03 DB DB 00");
  visit(SetParam{kGainLeft, 987654}, 10, "00 09 02 17 0A 05 02 06 12 0F 03 4C FE 00");
  visit(GetParam{kUid}, 11, "00 08 02 18 0B 01 01 71 DE 00");
  visit(Commit{}, 12, "00 04 02 19 0C 03 83 75 00");
  visit(LoadBegin{0x89ABCDEF, 176}, 13, "00 0C 02 1A 0D 05 EF CD AB 89 B0 1C 54 00");
  visit(LoadData{64,
                 {0x51, 0x52, 0x53, 0x54, 0x55, 0x56, 0x57, 0x58, 0x59, 0x5A, 0x5B, 0x5C, 0x5D,
                  0x5E, 0x5F, 0x60}},
        14,
        "00 16 02 1B 0E 21 40 51 52 53 54 55 56 57 58 59 5A 5B 5C 5D 5E 5F 60 01 "
        "01 01 01 01 01 01 01 01 01 01 01 01 01 01 03 07 55 00");
  visit(LoadEnd{0x89ABCDEF}, 15, "00 0B 02 1C 0F 04 EF CD AB 89 DE 3D 00");
  visit(GetPrograms{}, 16, "00 04 02 1D 10 03 D3 2A 00");
  visit(SetSenses{200, {65536, -65536, 0, 1, -1, 0x7FFFFFFF, -0x7FFFFFFF, 32768}}, 17,
        "00 06 02 1E 11 21 C8 01 02 01 01 01 03 FF FF 01 01 01 02 01 01 01 0A FF "
        "FF FF FF FF FF FF 7F 01 01 02 80 02 80 01 03 A3 27 00");
  visit(Pong{0x01020304, 0x05060708, 65536, 999}, 1,
        "00 0D 02 81 01 0E 04 03 02 01 08 07 06 05 01 02 01 05 E7 03 06 AE 00");
  visit(Hello{kSchema, 0x0102, 0x89ABCDEF, 0x51000007, 0xC0DE, kResetWatchdog, 1, 255, 86400000,
              38400},
        0,
        "00 03 02 82 0B 19 DE 0F 02 01 EF CD AB 89 07 01 07 51 DE C0 04 01 FF 04 "
        "5C 26 05 02 96 01 03 46 6F 00");
  visit(Ack{Order::kType, kWrongConfig, 2}, 7, "00 0A 02 83 07 03 14 04 02 83 05 00");
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
                  3,
                  77},
        200,
        "00 07 02 90 C8 21 E8 03 01 0E 12 04 FF 04 01 02 A8 F0 FD FF 58 0F 02 01 "
        "02 FF 03 FF 2C 0C 01 FE 01 F1 EF BE 09 03 4D 59 05 00");
  visit(State{5000, 7, 0x12345678, 4000, -1, 1, 2, 4100, 4200, 65535}, 201,
        "00 07 02 91 C9 22 88 13 01 02 07 07 78 56 34 12 A0 0F 01 06 FF FF FF FF "
        "01 01 01 02 02 03 04 10 01 03 68 10 01 04 FF FF EA 01 00");
  visit(Step{123456789, 1000000, 65534, 2, 1, 12345, -12345, 1000, 0x12345678}, 202,
        "00 0C 02 92 CA 1C 15 CD 5B 07 40 42 0F 07 FE FF 02 01 39 30 01 07 C7 CF "
        "FF FF E8 03 01 07 78 56 34 12 5E 1D 00");
  visit(Counters{60000, 30000, 77, 1, 3300, 600, 2, 3, 4, 5, 50}, 203,
        "00 07 02 93 CB 1B 60 EA 01 03 30 75 01 02 4D 01 01 02 01 06 E4 0C 58 02 "
        "02 02 03 02 04 02 05 04 32 FA 0C 00");
  visit(Event{70000, 5, kBooted, kResetWatchdog}, 204,
        "00 08 02 94 CC 0B 70 11 01 02 05 03 01 04 01 01 03 0D 78 00");
  visit(ParamValue{kUid, 0x51000007}, 11, "00 07 02 95 0B 05 01 07 01 04 51 8A 50 00");
  visit(Programs{{0x89ABCDEF, 0, 1, 0xFFFFFFFF, 0x01020304}, 0x01020304}, 16,
        "00 09 02 96 10 18 EF CD AB 89 01 01 01 02 01 01 01 0F FF FF FF FF 04 03 "
        "02 01 04 03 02 01 CC 1A 00");
}

}  // namespace lab::wire
