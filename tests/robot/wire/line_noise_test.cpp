// A line with random bit errors in all ten bits of a character, including start and stop bit, so
// that the receiver may lose synchronisation.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <vector>

#include "tests/robot/wire/tally.hpp"

namespace lab::wire {
namespace {

/// Flips bits independently with a given probability.
class NoisyLine {
 public:
  NoisyLine(double rate, std::uint64_t seed) : rate_(rate), draws_(seed) { drawGap(); }

  bool carry(bool bit) {
    ++bits_;
    if (gap_ > 0) {
      --gap_;
      return bit;
    }
    drawGap();
    ++flips_;
    return !bit;
  }
  std::uint64_t bits() const { return bits_; }
  std::uint64_t flips() const { return flips_; }

 private:
  /// Number of bits before the next flip: geometrically distributed.
  void drawGap() {
    const double u = (static_cast<double>(draws_.bits() >> 11) + 0.5) * 0x1p-53;
    gap_ = static_cast<std::uint64_t>(std::log(u) / std::log1p(-rate_));
  }

  double rate_;
  Draws draws_;
  std::uint64_t gap_ = 0;
  std::uint64_t bits_ = 0;
  std::uint64_t flips_ = 0;
};

/// A receiver of 8 data bits, no parity, 1 stop bit: it waits for a start bit (0) and then counts.
class Receiver {
 public:
  /// Takes the next bit. Returns true if it completes a character. A stop bit of 0 is a framing
  /// error; the character is still accepted, and the search for a start bit continues after it.
  bool take(bool bit) {
    if (left_ == 0) {
      if (!bit) left_ = 9;
      return false;
    }
    if (--left_ == 0) return true;
    byte_ = static_cast<std::uint8_t>((byte_ >> 1) | (bit ? 0x80U : 0U));
    return false;
  }
  std::uint8_t byte() const { return byte_; }

 private:
  int left_ = 0;
  std::uint8_t byte_ = 0;
};

struct StreamResult {
  Tally tally;
  std::uint64_t hit = 0;             ///< frames with a wrong bit
  std::uint64_t lost = 0;            ///< frames that did not arrive
  std::uint64_t whole_but_lost = 0;  ///< lost frames without a wrong bit of their own
};

/// Frames of all types, back to back, over a line of this bit error rate.
class Stream {
 public:
  Stream(double rate, std::uint64_t seed) : draws_(seed), line_(rate, seed + 1) {}

  StreamResult run(std::uint64_t count) {
    std::vector<Frame> frames;
    for (std::uint64_t i = 0; i < count; ++i) {
      if (frames.empty()) frames = drawnFrames(draws_);
      send(frames.back());
      frames.pop_back();
    }
    finish(older_);
    finish(newer_);
    return result_;
  }

 private:
  void send(const Frame& frame) {
    finish(older_);
    older_ = newer_;
    newer_ = Sent{frame, true, false, false};
    const std::uint64_t flips = line_.flips();
    for (const std::uint8_t byte : encoded(frame)) {
      take(line_.carry(false));
      for (int bit = 0; bit < 8; ++bit) take(line_.carry(((byte >> bit) & 1) != 0));
      take(line_.carry(true));
    }
    newer_.hit = line_.flips() != flips;
    ++result_.tally.tried;
  }

  void take(bool bit) {
    if (!receiver_.take(bit)) return;
    const std::uint16_t before = crcChecks(decoder_);
    const bool complete = decoder_.push(receiver_.byte());
    bool right = false;
    if (complete) {
      // A frame may only be completed by its own last byte or by the first byte of the next frame.
      for (Sent* sent : {&newer_, &older_}) {
        if (!right && sent->used && !sent->arrived && decoder_.frame() == sent->frame) {
          sent->arrived = right = true;
        }
      }
      if (!right) ++result_.tally.wrong;
    }
    result_.tally.checked +=
        static_cast<std::uint16_t>(crcChecks(decoder_) - before - (right ? 1 : 0));
  }

  struct Sent {
    Frame frame;
    bool used = false;
    bool arrived = false;
    bool hit = false;
  };

  /// Counts the frame before the last one, which can no longer arrive.
  void finish(const Sent& sent) {
    if (!sent.used) return;
    result_.hit += sent.hit ? 1U : 0U;
    result_.lost += sent.arrived ? 0U : 1U;
    result_.whole_but_lost += !sent.arrived && !sent.hit ? 1U : 0U;
  }

  Draws draws_;
  NoisyLine line_;
  Receiver receiver_;
  Decoder decoder_;
  Sent older_;
  Sent newer_;
  StreamResult result_;
};

TEST(LineNoise, WithoutErrorsNothingIsLost) {
  const StreamResult result = Stream(1e-15, 21).run(20000);
  EXPECT_EQ(result.lost, 0U);
  EXPECT_EQ(result.tally.wrong, 0U);
  EXPECT_EQ(result.tally.checked, 0U);
}

TEST(LineNoise, LosesDamagedFramesAndAcceptsOnlyTheShareOfTheCrc) {
  struct Level {
    double rate;
    const char* name;
  };
  for (const Level level : {Level{1e-5, "noise 1e-5"}, Level{1e-4, "noise 1e-4"},
                            Level{1e-3, "noise 1e-3"}, Level{1e-2, "noise 1e-2"}}) {
    const StreamResult result = Stream(level.rate, 22).run(triesOr(1000000));
    result.tally.print(level.name);
    const auto tried = static_cast<double>(result.tally.tried);
    std::cout << std::setprecision(2) << "    hit " << 100 * static_cast<double>(result.hit) / tried
              << " %, lost " << 100 * static_cast<double>(result.lost) / tried
              << " %, lost though whole "
              << 100 * static_cast<double>(result.whole_but_lost) / tried << " %\n";
    EXPECT_LE(result.tally.wrong, result.tally.limit()) << level.name;
    EXPECT_GT(result.hit, result.tally.tried / 1000) << level.name;
    // After a wrong start bit the receiver is out of step, and the next frame may be lost too. This
    // is rare, because the two 0 between frames resynchronise it.
    EXPECT_LE(result.whole_but_lost, result.hit / 10) << level.name;
  }
}

}  // namespace
}  // namespace lab::wire
