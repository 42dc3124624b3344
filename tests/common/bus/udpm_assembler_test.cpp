// Datagrams become messages, and no bytes do harm.
#include "common/bus/udpm_assembler.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/random.hpp"
#include "tests/common/bus/udpm_datagrams.hpp"

namespace lab::udpm_test {
namespace {

using namespace std::string_view_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr DatagramSource kSource{0x0a00'0005, 7667};
constexpr DatagramSource kOther{0x0a00'0006, 7667};

class Assembler : public testing::Test {
 protected:
  /// @return "CHANNEL:data" of the message that the datagram completed, else ""
  std::string take(const Datagram& datagram, const DatagramSource& source = kSource) {
    // In memory of exactly this size, so that a sanitizer notices a read beyond the end.
    const Datagram exact(datagram);
    const auto message = dut_.take(source, exact, now_);
    if (!message) return "";
    return message->channel + ":" +
           std::string(reinterpret_cast<const char*>(message->data.get()), message->size);
  }
  [[nodiscard]] std::int64_t refused(Refusal reason) const {
    return dut_.refused().of(reason).datagrams;
  }
  [[nodiscard]] std::int64_t refused() const {
    std::int64_t all = 0;
    for (std::size_t i = 0; i < kRefusals; ++i) all += refused(static_cast<Refusal>(i));
    return all;
  }

  std::vector<std::string> unwanted_;
  UdpmAssembler dut_{[this](std::string_view channel) {
    return std::find(unwanted_.begin(), unwanted_.end(), channel) == unwanted_.end();
  }};
  std::int64_t now_ = 1'000'000;
};

TEST_F(Assembler, TakesAWholeMessage) {
  EXPECT_EQ(take(whole("A", "data")), "A:data");
  EXPECT_EQ(take(whole("A", "")), "A:");
  EXPECT_EQ(take(whole(std::string(63, 'X'), "x")), std::string(63, 'X') + ":x");
  EXPECT_EQ(refused(), 0);
}

TEST_F(Assembler, DropsMessagesThatNobodyWantsWithoutCountingThem) {
  unwanted_ = {"A"};
  EXPECT_EQ(take(whole("A", "data")), "");
  EXPECT_EQ(take(fragment({.message_size = 1}, "A\0x"sv)), "");
  EXPECT_EQ(take(whole("B", "data")), "B:data");
  EXPECT_EQ(refused(), 0);
}

TEST_F(Assembler, RefusesWhatIsNotLcm) {
  const Datagram message = whole("A", "data");
  for (std::size_t size = 0; size < 8; ++size) {
    take(Datagram(message.begin(), message.begin() + static_cast<std::ptrdiff_t>(size)));
  }
  Datagram other_magic = message;
  other_magic[3] = '4';
  take(other_magic);
  EXPECT_EQ(refused(Refusal::kNotLcm), 9);
  EXPECT_EQ(refused(), 9);
}

TEST_F(Assembler, RefusesAFragmentWithoutAWholeHeader) {
  const Datagram piece = fragment({.message_size = 1}, "A\0x"sv);
  for (std::ptrdiff_t size = 8; size < 20; ++size) {
    take(Datagram(piece.begin(), piece.begin() + size));
  }
  EXPECT_EQ(refused(Refusal::kNotLcm), 12);
}

TEST_F(Assembler, RefusesAChannelThatDoesNotEndOrIsTooLong) {
  Datagram open_end = whole("A", "");
  open_end.pop_back();
  EXPECT_EQ(take(open_end), "");
  EXPECT_EQ(take(whole(std::string(64, 'X'), "data")), "");
  EXPECT_EQ(take(fragment({.message_size = 5}, "CHANNEL"sv)), "");
  EXPECT_EQ(take(fragment({.message_size = 5}, ""sv)), "");
  EXPECT_EQ(refused(Refusal::kBadChannel), 4);
  EXPECT_EQ(dut_.openMessages(), 0U);
}

TEST_F(Assembler, JoinsFragmentsInAnyOrder) {
  std::array<Datagram, 4> pieces{
      fragment({.message_size = 10, .offset = 0, .number = 0, .fragments = 4}, "CH\0abc"sv),
      fragment({.message_size = 10, .offset = 3, .number = 1, .fragments = 4}, "def"sv),
      fragment({.message_size = 10, .offset = 6, .number = 2, .fragments = 4}, "ghi"sv),
      fragment({.message_size = 10, .offset = 9, .number = 3, .fragments = 4}, "j"sv)};
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  do {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(take(pieces[order[i]]), "");
    EXPECT_EQ(take(pieces[order[3]]), "CH:abcdefghij");
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(refused(), 0);
  EXPECT_EQ(dut_.openMessages(), 0U);
  EXPECT_EQ(dut_.openBytes(), 0U);
}

TEST_F(Assembler, KeepsMessagesOfSeveralSourcesApart) {
  const FragmentHeader first{.message_size = 4, .offset = 0, .number = 0, .fragments = 2};
  const FragmentHeader last{.message_size = 4, .offset = 2, .number = 1, .fragments = 2};
  take(fragment(first, "A\0ab"sv), kSource);
  take(fragment(first, "B\0xy"sv), kOther);
  EXPECT_EQ(take(fragment(last, "cd"sv), kSource), "A:abcd");
  EXPECT_EQ(take(fragment(last, "zz"sv), kOther), "B:xyzz");
}

TEST_F(Assembler, RefusesTheFragmentsThatMakeLiblcmWriteOutOfBounds) {
  // offset + size is 2^32 + 84 and 2^32: below the size of the message in 32 bits.
  take(fragment({.message_size = 100, .offset = 0, .number = 0, .fragments = 3}, "A\0abc"sv));
  for (const std::uint32_t offset : {0xffff'fff0U, 0xffff'ff9cU}) {
    EXPECT_EQ(take(fragment({.message_size = 100, .offset = offset, .number = 1, .fragments = 3},
                            std::string(100, 'x'))),
              "");
  }
  EXPECT_EQ(refused(Refusal::kBadFragment), 2);
  EXPECT_EQ(refused(), 2);
}

TEST_F(Assembler, RefusesFragmentsOutsideOfTheirMessage) {
  const auto refuses = [this](const FragmentHeader& header, std::string_view content) {
    const std::int64_t before = refused(Refusal::kBadFragment);
    EXPECT_EQ(take(fragment(header, content)), "");
    return refused(Refusal::kBadFragment) == before + 1;
  };
  EXPECT_TRUE(refuses({.message_size = 4, .offset = 0, .number = 0, .fragments = 1}, "A\0abcde"sv));
  EXPECT_TRUE(refuses({.message_size = 4, .offset = 3, .number = 1, .fragments = 2}, "ab"sv));
  EXPECT_TRUE(refuses({.message_size = 4, .offset = 5, .number = 1, .fragments = 2}, "a"sv));
  EXPECT_TRUE(refuses({.message_size = 4, .offset = 0, .number = 2, .fragments = 2}, "a"sv));
  EXPECT_TRUE(refuses({.message_size = 4, .offset = 0, .number = 0, .fragments = 0}, "A\0a"sv));
  EXPECT_TRUE(refuses({.message_size = 4, .offset = 1, .number = 1, .fragments = 2}, ""sv));
  EXPECT_EQ(dut_.openMessages(), 0U);
}

TEST_F(Assembler, RefusesRepeatedAndOverlappingFragments) {
  const FragmentHeader first{.message_size = 6, .offset = 0, .number = 0, .fragments = 3};
  const FragmentHeader second{.message_size = 6, .offset = 2, .number = 1, .fragments = 3};
  take(fragment(first, "A\0ab"sv));
  take(fragment(first, "B\0xx"sv));  // repeated
  take(fragment({.message_size = 6, .offset = 1, .number = 2, .fragments = 3}, "xxxx"sv));
  EXPECT_EQ(take(fragment(second, "cd"sv)), "");
  take(fragment({.message_size = 6, .offset = 3, .number = 2, .fragments = 3}, "xxx"sv));
  EXPECT_EQ(take(fragment({.message_size = 6, .offset = 4, .number = 2, .fragments = 3}, "ef"sv)),
            "A:abcdef");
  EXPECT_EQ(refused(Refusal::kBadFragment), 3);
}

TEST_F(Assembler, RefusesToReserveMemoryForAGiant) {
  take(fragment({.message_size = 0xffff'ffff, .offset = 0, .number = 0, .fragments = 65535},
                "A\0abc"sv));
  take(fragment({.message_size = UdpmAssembler::kLongestMessage + 1, .fragments = 300}, "A\0a"sv));
  EXPECT_EQ(refused(Refusal::kTooLong), 2);
  EXPECT_EQ(dut_.openBytes(), 0U);
}

TEST_F(Assembler, TakesTheLongestMessage) {
  const std::string data(UdpmAssembler::kLongestMessage, 'x');
  constexpr std::uint32_t kPiece = 65'000;
  const std::uint32_t fragments = (UdpmAssembler::kLongestMessage + kPiece - 1) / kPiece;
  std::string result;
  for (std::uint32_t i = 0; i < fragments; ++i) {
    std::string content = data.substr(i * kPiece, kPiece);
    if (i == 0) content.insert(0, "A\0"sv);
    result = take(fragment({.message_size = UdpmAssembler::kLongestMessage,
                            .offset = i * kPiece,
                            .number = i,
                            .fragments = fragments},
                           content));
  }
  EXPECT_EQ(result, "A:" + data);
}

TEST_F(Assembler, BoundsWhatManySourcesBegin) {
  for (std::uint32_t i = 0; i < 200; ++i) {
    take(fragment({.message_size = UdpmAssembler::kLongestMessage, .fragments = 300}, "A\0a"sv),
         {i, 1});
    ASSERT_LE(dut_.openBytes(), UdpmAssembler::kMostOpenBytes);
  }
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    take(fragment({.message_size = 100, .fragments = 300}, "A\0a"sv), {i, 1});
    ASSERT_LE(dut_.openMessages(), UdpmAssembler::kMostOpen);
  }
  EXPECT_EQ(refused(Refusal::kIncomplete),
            10'200 - static_cast<std::int64_t>(UdpmAssembler::kMostOpen));
}

TEST_F(Assembler, OneSourceDoesNotPushOutTheMessageOfAnother) {
  take(fragment({.message_size = 2, .offset = 0, .number = 0, .fragments = 2}, "A\0a"sv), kOther);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    take(fragment({.sequence = i, .message_size = 100, .fragments = 300}, "A\0a"sv), kSource);
  }
  EXPECT_EQ(
      take(fragment({.message_size = 2, .offset = 1, .number = 1, .fragments = 2}, "b"sv), kOther),
      "A:ab");
}

TEST_F(Assembler, GivesUpAMessageOfManyGaps) {
  constexpr std::uint32_t kSize = 2000;
  for (std::uint32_t i = 0; i < kSize / 2 && refused() == 0; ++i) {
    take(fragment({.message_size = kSize, .offset = 2 * i, .number = 1 + i, .fragments = 65535},
                  "x"sv));
  }
  EXPECT_EQ(refused(Refusal::kIncomplete), 1);
  EXPECT_EQ(dut_.openMessages(), 0U);
}

TEST_F(Assembler, GivesUpAMessageThatDoesNotGoOn) {
  take(fragment({.message_size = 2, .offset = 0, .number = 0, .fragments = 2}, "A\0a"sv));
  now_ += UdpmAssembler::kLongestWait_us;
  take(whole("B", ""));
  EXPECT_EQ(dut_.openMessages(), 1U);
  now_ += 1;
  take(whole("B", ""), kOther);
  EXPECT_EQ(dut_.openMessages(), 0U);
  EXPECT_EQ(refused(Refusal::kIncomplete), 1);
  EXPECT_EQ(dut_.refused().of(Refusal::kIncomplete).last, kSource);
}

TEST_F(Assembler, BeginsAnewWhenAnotherProcessHasTheSourcesPort) {
  take(fragment({.message_size = 9, .offset = 0, .number = 0, .fragments = 2}, "OLD\0a"sv));
  take(fragment({.message_size = 2, .offset = 0, .number = 0, .fragments = 2}, "NEW\0a"sv));
  EXPECT_EQ(take(fragment({.message_size = 2, .offset = 1, .number = 1, .fragments = 2}, "b"sv)),
            "NEW:ab");
  EXPECT_EQ(refused(Refusal::kIncomplete), 1);
}

TEST_F(Assembler, SurvivesAnyBytes) {
  Random random(1);
  const auto below = [&random](double end) {
    return static_cast<std::uint32_t>(random.uniform() * end);
  };
  for (int i = 0; i < 200'000; ++i) {
    // Numbers near 0, near the size and anywhere, so that all checks are reached.
    const auto number = [&]() -> std::uint32_t {
      return below(3) == 0 ? below(4'294'967'296.0) : below(3) == 0 ? 0U - below(40) : below(40);
    };
    Datagram datagram = fragment({.sequence = below(3),
                                  .message_size = number(),
                                  .offset = number(),
                                  .number = below(4),
                                  .fragments = below(5)},
                                 std::string(below(30), static_cast<char>(below(2))));
    if (below(20) == 0) datagram.resize(below(static_cast<double>(datagram.size()) + 1));
    if (below(20) == 0 && !datagram.empty()) datagram[below(4) % datagram.size()] ^= 1;
    now_ += below(1000);
    take(datagram, {below(30), 1});
    ASSERT_LE(dut_.openMessages(), UdpmAssembler::kMostOpen);
    ASSERT_LE(dut_.openBytes(), UdpmAssembler::kMostOpenBytes);
  }
  for (const Refusal reason : {Refusal::kNotLcm, Refusal::kBadChannel, Refusal::kBadFragment,
                               Refusal::kTooLong, Refusal::kIncomplete}) {
    EXPECT_GT(refused(reason), 0) << refusalText(reason);
  }
}

TEST(RefusedDatagrams, AreReportedByReasonWithTheirSource) {
  RefusedDatagrams dut;
  dut.count(Refusal::kStranger, kSource, 3);
  const RefusedDatagrams before = dut;
  EXPECT_THAT(dut.linesSince(before), IsEmpty());
  dut.count(Refusal::kStranger, kOther, 40);
  dut.count(Refusal::kReceiveBuffer, kSource, 7);

  EXPECT_THAT(dut.linesSince(before),
              ElementsAre("the bus refused 40: source is not this machine, the last from "
                          "10.0.0.6:7667; 43 since the start",
                          "the bus lost 7: receive buffer of the socket was full, the last from "
                          "10.0.0.5:7667; 7 since the start"));
  const std::vector<stream_count_t> rows = dut.rows();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].channel, "bus");
  EXPECT_EQ(rows[0].sender, "source is not this machine, last 10.0.0.6:7667");
  EXPECT_EQ(rows[0].decode_errors, 43);
  EXPECT_EQ(rows[0].lost, 0);
  EXPECT_EQ(rows[1].lost, 7);
}

}  // namespace
}  // namespace lab::udpm_test
