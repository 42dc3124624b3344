#include "robot/wire/messages.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "robot/wire/schema.hpp"
#include "tests/robot/wire/message_examples.hpp"

namespace lab::wire {
namespace {

/// Sets every field to one end of its range.
struct SetAll {
  bool highest;
  template <class Integer>
  void operator()(Integer& value) const {
    value = highest ? std::numeric_limits<Integer>::max() : std::numeric_limits<Integer>::min();
  }
  template <std::uint8_t N>
  void counts10(std::uint16_t (&values)[N]) const {
    for (auto& value : values) value = highest ? 1023 : 0;
  }
};

/// Sets all fields to different values, so that exchanged fields are detected.
struct SetDifferent {
  std::uint32_t last = 0x9E3779B9U;
  template <class Integer>
  void operator()(Integer& value) {
    last = last * 1664525U + 1013904223U;
    value = static_cast<Integer>(last >> 7);
  }
  template <std::uint8_t N>
  void counts10(std::uint16_t (&values)[N]) {
    for (auto& value : values) {
      (*this)(value);
      value &= 1023U;
    }
  }
};

/// The values of all fields, converted to one wide type.
struct Values {
  std::vector<std::int64_t> all;
  template <class Integer>
  void operator()(const Integer& value) {
    all.push_back(static_cast<std::int64_t>(value));
  }
  template <std::uint8_t N>
  void counts10(const std::uint16_t (&values)[N]) {
    for (const auto& value : values) (*this)(value);
  }
};

template <class Message>
std::vector<std::int64_t> valuesOf(const Message& message) {
  Values values;
  Message::fields(message, values);
  return values.all;
}

/// Encodes a message into a frame, decodes the bytes, and reads the message.
template <class Message>
void expectToComeBack(const char* name, const Message& message) {
  Frame sent;
  pack(message, 42, sent);
  Decoder decoder;
  const auto frames = received(decoder, encoded(sent));
  ASSERT_EQ(frames.size(), 1U) << name;
  EXPECT_EQ(frames[0].seq, 42);
  Message back;
  ASSERT_TRUE(unpack(frames[0], back)) << name;
  EXPECT_EQ(valuesOf(back), valuesOf(message)) << name;
}

TEST(Messages, KeepTheirValuesOverTheLine) {
  forEachMessage([](const char* name, auto message) {
    using Message = decltype(message);
    expectToComeBack(name, message);
    for (const bool highest : {false, true}) {
      SetAll extreme{highest};
      Message::fields(message, extreme);
      expectToComeBack(name, message);
    }
    SetDifferent different;
    Message::fields(message, different);
    expectToComeBack(name, message);
  });
}

TEST(Messages, EqualTheFramesAssembledByHand) {
  std::vector<int> types;
  forEachExample([&](const auto& message, int seq, const std::string& hex) {
    Frame frame;
    pack(message, static_cast<std::uint8_t>(seq), frame);
    EXPECT_EQ(encoded(frame), hexBytes(hex)) << hex;
    Decoder decoder;
    const auto frames = received(decoder, hexBytes(hex));
    ASSERT_EQ(frames.size(), 1U) << hex;
    EXPECT_TRUE(frames[0] == frame) << hex;
    types.push_back(frame.type);
  });
  std::vector<int> all;
  forEachMessage([&](const char*, const auto& message) { all.push_back(message.kType); });
  EXPECT_EQ(types, all) << "an example of every message";
}

TEST(Messages, HaveTheDocumentedSizes) {
  std::vector<int> sizes;
  forEachMessage([&](const char*, const auto& message) {
    sizes.push_back(payloadSize<std::remove_cvref_t<decltype(message)>>());
  });
  EXPECT_EQ(sizes, (std::vector<int>{8,  0,  5, 24, 23, 2,  16, 2,  8, 5, 1, 0, 5, 33, 4, 0, 33,  //
                                     14, 25, 3, 33, 34, 28, 27, 11, 5, 24}));
}

TEST(Messages, HaveUniqueTypesThatShowTheDirection) {
  std::set<int> types;
  std::set<std::string> names;
  forEachMessage([&](const char* name, const auto& message) {
    EXPECT_TRUE(types.insert(message.kType).second) << name;
    EXPECT_TRUE(names.insert(name).second) << name;
  });
  EXPECT_FALSE(types.contains(0));
  // The high bit means robot to host: 17 commands without it, 10 answers and reports with it.
  EXPECT_EQ(std::distance(types.begin(), types.lower_bound(0x80)), 17);
  EXPECT_EQ(std::distance(types.lower_bound(0x80), types.end()), 10);
}

TEST(Messages, AreAllKnownToForEachMessage) {
  std::ifstream source(LAB_WIRE_DIRECTORY "/messages.hpp");
  ASSERT_TRUE(source);
  int declared = 0;
  for (std::string line; std::getline(source, line);) {
    declared += line.find("constexpr uint8_t kType") != std::string::npos ? 1 : 0;
  }
  int visited = 0;
  forEachMessage([&](const char*, const auto&) { ++visited; });
  EXPECT_EQ(visited, declared)
      << "a message of robot/wire/messages.hpp is missing in robot/wire/schema.hpp";
}

TEST(Messages, AreRefusedWithAnotherLengthOrType) {
  forEachMessage([](const char* name, auto message) {
    using Message = decltype(message);
    Frame frame;
    pack(message, 0, frame);
    for (int size = 0; size < 256; ++size) {
      frame.size = static_cast<std::uint8_t>(size);
      EXPECT_EQ(unpack(frame, message), size == payloadSize<Message>()) << name << " " << size;
    }
    frame.size = payloadSize<Message>();
    for (int type = 0; type < 256; ++type) {
      frame.type = static_cast<std::uint8_t>(type);
      EXPECT_EQ(unpack(frame, message), type == Message::kType) << name << " " << type;
    }
  });
}

TEST(Messages, TruncateCountsToTenBits) {
  Telemetry telemetry;
  for (auto& each : telemetry.sensors) each = 0;
  telemetry.sensors[1] = 0xFFFF;
  Frame frame;
  pack(telemetry, 0, frame);
  Telemetry back;
  ASSERT_TRUE(unpack(frame, back));
  EXPECT_EQ(back.sensors[0], 0);
  EXPECT_EQ(back.sensors[1], 1023);
  EXPECT_EQ(back.sensors[2], 0);
}

/// Whether the fields lie in memory in the order in which they are visited.
struct MemoryOrder {
  const void* last = nullptr;
  bool ascends = true;
  template <class Field>
  void operator()(const Field& field) {
    ascends = ascends && std::less<const void*>()(last, &field);
    last = &field;
  }
  template <std::uint8_t N>
  void counts10(const std::uint16_t (&values)[N]) {
    (*this)(values[0]);
  }
};

// The chip copies messages whole unless they are declared as reordered.
TEST(Messages, HaveTheirFieldsInMemoryInTheOrderOfTheWire) {
  forEachMessage([](const char* name, const auto& message) {
    using Message = std::remove_cvref_t<decltype(message)>;
    MemoryOrder order;
    Message::fields(message, order);
    EXPECT_EQ(order.ascends, !Reordered<Message>::kValue) << name;
  });
}

}  // namespace
}  // namespace lab::wire
