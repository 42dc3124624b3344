// Random and mutated bytes for all code that reads from the line. Built with address and undefined
// behaviour sanitizers in every preset, which abort the test at an invalid access.
#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <memory>
#include <vector>

#include "robot/wire/config.hpp"
#include "tests/robot/wire/tally.hpp"

namespace lab::wire {
namespace {

/// Stages settings messages, as a robot does before it checks them.
struct Robot {
  dynamics::CoreSettings settings;
  std::uint64_t invalid = 0;

  void take(const SetProgram& message) { stageAndLook(message); }
  void take(const SetLight& message) { stageAndLook(message); }
  void take(const SetMotion& message) { stageAndLook(message); }
  template <class Message>
  void take(const Message&) {}

 private:
  template <class Message>
  void stageAndLook(const Message& message) {
    stage(message, settings);
    invalid += firstFault(settings) != kNoFault ? 1U : 0U;
    EXPECT_NE(configCrc(settings), 0);
  }
};

/// Reads the frame as every type of message. A message that fits must encode to the same bytes.
class Readers {
 public:
  void read(const Frame& frame) {
    // Each has its own heap block, so that reads beyond its end are detected.
    const auto alone = std::make_unique<Frame>(frame);
    forEachMessage([&](const char* name, auto message) {
      if (!unpack(*alone, message)) return;
      ++messages_;
      robot_.take(message);
      const auto again = std::make_unique<Frame>();
      pack(message, frame.seq, *again);
      ASSERT_TRUE(*again == frame) << name;
    });
  }
  std::uint64_t messages() const { return messages_; }
  std::uint64_t invalid() const { return robot_.invalid; }

 private:
  Robot robot_;
  std::uint64_t messages_ = 0;
};

/// Sequences of all kinds, from pure noise to frames with a single error.
class Sequences {
 public:
  Bytes next() {
    switch (draws_.below(6)) {
      case 0:
        return draws_.bytes(draws_.below(100));
      case 1: {  // more zeros
        Bytes bytes(draws_.below(100));
        for (auto& byte : bytes) byte = draws_.byteOftenZero();
        return bytes;
      }
      case 2:  // any raw bytes behind a CRC that fits
        return sealed(draws_.bytes(draws_.below(60)));
      case 3: {  // a header that fits and any payload
        const std::size_t size = draws_.below(kMaxPayload + 4);
        return sealed(
            Bytes{kProtocolVersion, type(), draws_.byte(), static_cast<std::uint8_t>(size)} +
            draws_.bytes(size));
      }
      case 4: {  // one frame, changed
        Bytes bytes = encoded(frame());
        change(bytes);
        return bytes;
      }
      default: {  // two frames, one cut
        Bytes bytes = encoded(frame());
        bytes.resize(draws_.below(bytes.size() + 1));
        return bytes + encoded(frame());
      }
    }
  }
  /// A frame that the decoder would never return: any type, any length, any bytes.
  Frame impossibleFrame() {
    Frame frame;
    frame.type = type();
    frame.seq = draws_.byte();
    frame.size = static_cast<std::uint8_t>(draws_.below(4) == 0 ? draws_.byte()
                                                                : draws_.below(kMaxPayload + 1));
    for (auto& byte : frame.payload) byte = draws_.byteOftenZero();
    return frame;
  }

 private:
  const Frame& frame() {
    if (used_ == frames_.size()) {
      frames_ = drawnFrames(draws_);
      used_ = 0;
    }
    return frames_[used_++];
  }

  std::uint8_t type() { return draws_.below(3) == 0 ? draws_.byte() : frame().type; }

  void change(Bytes& bytes) {
    for (std::size_t i = draws_.below(5); i > 0 && !bytes.empty(); --i) {
      const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(draws_.below(bytes.size()));
      switch (draws_.below(4)) {
        case 0:
          *at = draws_.byteOftenZero();
          break;
        case 1:
          *at = static_cast<std::uint8_t>(*at ^ (1U << draws_.below(8)));
          break;
        case 2:
          bytes.erase(at);
          break;
        default:
          bytes.insert(at, draws_.byteOftenZero());
          break;
      }
    }
  }

  Draws draws_{31};
  std::vector<Frame> frames_;
  std::size_t used_ = 0;
};

TEST(Fuzz, NoBytesCauseInvalidAccessesInDecoderOrReaders) {
  const auto decoder = std::make_unique<Decoder>();
  Sequences sequences;
  Readers readers;
  std::uint64_t accepted = 0;
  const std::uint64_t tries = triesOr(1000000);
  for (std::uint64_t i = 0; i < tries && !testing::Test::HasFatalFailure(); ++i) {
    for (const std::uint8_t byte : sequences.next()) {
      if (!decoder->push(byte)) continue;
      ++accepted;
      const Frame& frame = decoder->frame();
      ASSERT_LE(frame.size, kMaxPayload);
      readers.read(frame);
      ASSERT_EQ(encoded(frame).size(), static_cast<std::size_t>(frame.size) + kFrameOverhead);
    }
    if (i % 64 == 0) decoder->reset();
    if (i % 4 == 0) readers.read(sequences.impossibleFrame());
  }
  std::cout << tries << " sequences, " << accepted << " frames accepted, " << readers.messages()
            << " messages read, " << readers.invalid() << " settings found invalid\n";
  // Checks that the sequences reach the code that they are made for.
  EXPECT_GT(accepted, tries / 4);
  EXPECT_GT(readers.messages(), tries / 8);
  EXPECT_GT(readers.invalid(), tries / 100);
}

}  // namespace
}  // namespace lab::wire
