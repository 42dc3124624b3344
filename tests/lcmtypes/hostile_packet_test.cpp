// Packets whose counts and strings are wrong, for every count and every string of every type. The
// cases are made from the fields (contract.hpp). This test is a program of its own, because it
// counts what the program allocates.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <new>
#include <set>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "tests/lcmtypes/contract.hpp"
#include "tests/lcmtypes/contract_v3.hpp"
#include "tests/lcmtypes/contract_v4.hpp"

namespace {

std::size_t allocated = 0;  // [bytes] since the program began

}  // namespace

// Not inlined: g++ takes a delete that it inlines, and a new that it does not, for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  allocated += size;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}

namespace lab {
namespace {

namespace fs = std::filesystem;

using Encoding = std::vector<std::uint8_t>;

constexpr std::size_t kElements = 2;  // of every list, where it is not empty

/// The most that a decoded message takes of memory for a byte of its packet: an empty string of 5
/// bytes becomes a std::string of 32, and the numbers of a struct have gaps between them.
constexpr std::size_t kMemoryPerByte = 8;

/// A number in an encoding on which the length of something depends.
struct Place {
  std::size_t offset;
  std::size_t size;    ///< [bytes] of the number
  std::size_t length;  ///< of the string, final zero included
};

/// Finds the counts and the lengths of strings in the encoding of a message. The count of a list is
/// the number before it, as for Filler.
class Places {
 public:
  std::vector<Place> counts;
  std::vector<Place> strings;
  std::size_t offset = 8;  ///< behind the fingerprint

  template <class Type>
  void operator()(Type& value) {
    if constexpr (std::is_arithmetic_v<Type>) {
      if constexpr (std::integral<Type>) count_ = {offset, sizeof(Type), 0};
      offset += sizeof(Type);
    } else if constexpr (std::same_as<Type, std::string>) {
      strings.push_back({offset, 4, value.size() + 1});
      offset += 4 + value.size() + 1;
    } else if constexpr (std::is_bounded_array_v<Type>) {
      for (auto& element : value) (*this)(element);
    } else if constexpr (requires { value.begin(); }) {
      const Place count = count_;
      counts.push_back(count);
      for (auto& element : value) (*this)(element);
      count_ = count;
    } else {
      std::apply([this](auto&... field) { ((*this)(field), ...); }, fields(value));
    }
  }

 private:
  Place count_{};
};

template <class Visit>
void forEveryType(Visit visit) {
  forEachType(ChannelTypes{}, visit);
  forEachType(PartTypes{}, visit);
  forEachType(lab_v3::AllTypes{}, visit);
  forEachType(lab_v4::AllTypes{}, visit);
}

/// Calls `visit(encoding, places, refuses)` for samples of every type, with empty lists and others.
/// `refuses(encoding)` says whether decode() refuses an encoding without allocating anything.
template <class Visit>
void forEverySample(Visit visit) {
  forEveryType([&visit]<class Message>() {
    SCOPED_TRACE(Message::getTypeName());
    for (const std::size_t length : {std::size_t{0}, kElements}) {
      auto message = sample<Message>(length);
      const Encoding encoding = encode(message);
      Places places;
      places(message);
      ASSERT_EQ(places.offset, encoding.size());
      visit(encoding, places, [](Bytes packet) {
        Message heard{};
        const std::size_t before = allocated;
        const bool decoded = decode(packet, heard);
        return !decoded && allocated == before;
      });
    }
  });
}

/// `encoding` with `number` put in at `place`, big-endian as LCM has it.
Encoding with(Encoding encoding, Place place, std::int64_t number) {
  for (std::size_t i = place.size; i-- > 0;) {
    encoding[place.offset + i] = static_cast<std::uint8_t>(number);
    number >>= 8;
  }
  return encoding;
}

TEST(HostilePacket, WithAnImpossibleCountIsRefused) {
  std::size_t tried = 0;
  forEverySample([&tried](const Encoding& encoding, const Places& places, auto refuses) {
    for (const Place& count : places.counts) {
      const std::int64_t greatest = (std::int64_t{1} << (8 * count.size - 1)) - 1;
      const auto left = static_cast<std::int64_t>(encoding.size() - count.offset - count.size);
      // 0x20000002 elements of 8 bytes are 16 bytes in 32 bits.
      for (const std::int64_t wrong :
           {std::int64_t{-1}, -greatest - 1, greatest, left + 1, std::int64_t{0x20000002}}) {
        if (wrong > greatest) continue;
        EXPECT_TRUE(refuses(with(encoding, count, wrong))) << wrong << " at " << count.offset;
        ++tried;
      }
    }
  });
  EXPECT_GT(tried, 0U);
}

TEST(HostilePacket, WithAnImpossibleStringIsRefused) {
  std::size_t tried = 0;
  forEverySample([&tried](const Encoding& encoding, const Places& places, auto refuses) {
    for (const Place& string : places.strings) {
      const std::size_t begin = string.offset + string.size;
      const auto left = static_cast<std::int64_t>(encoding.size() - begin);
      for (const std::int64_t wrong :
           {std::int64_t{-1}, std::int64_t{std::numeric_limits<std::int32_t>::min()},
            std::int64_t{0}, std::int64_t{std::numeric_limits<std::int32_t>::max()}, left + 1}) {
        EXPECT_TRUE(refuses(with(encoding, string, wrong))) << wrong << " at " << string.offset;
        ++tried;
      }
      Encoding without_zero = encoding;
      without_zero[begin + string.length - 1] = 'x';
      EXPECT_TRUE(refuses(without_zero)) << "no final zero at " << string.offset;
      Encoding with_zero = encoding;
      with_zero[begin] = 0;
      EXPECT_TRUE(refuses(with_zero)) << "a zero inside at " << string.offset;
      tried += 2;
    }
  });
  EXPECT_GT(tried, 0U);
}

TEST(HostilePacket, ThatIsCutShortIsRefused) {
  forEverySample([](const Encoding& encoding, const Places& /*places*/, auto refuses) {
    for (std::size_t size = 0; size < encoding.size(); ++size) {
      EXPECT_TRUE(refuses(Bytes(encoding).first(size))) << size << " bytes";
    }
  });
}

// Some of these are accepted: a wrong number is a number too.
TEST(HostilePacket, NeverAsksForMoreMemoryThanItsBytesCanFill) {
  forEveryType([]<class Message>() {
    SCOPED_TRACE(Message::getTypeName());
    auto message = sample<Message>(kElements);
    Encoding encoding = encode(message);
    for (std::size_t i = 8; i < encoding.size(); ++i) {
      const std::uint8_t right = encoding[i];
      for (int bit = 0; bit < 8; ++bit) {
        encoding[i] = static_cast<std::uint8_t>(right ^ (1 << bit));
        Message heard{};
        const std::size_t before = allocated;
        static_cast<void>(decode(encoding, heard));
        EXPECT_LE(allocated - before, kMemoryPerByte * encoding.size()) << "byte " << i;
      }
      encoding[i] = right;
    }
  });
}

template <class Types>
void expectAllOf(const std::string& folder, Types types) {
  std::set<std::string> tried;
  std::set<std::string> written;
  forEachType(types, [&tried]<class Message>() { tried.insert(Message::getTypeName()); });
  for (const auto& entry : fs::directory_iterator(fs::path(LAB_LCMTYPES_FOLDER) / folder)) {
    written.insert(entry.path().stem());
  }
  EXPECT_EQ(tried, written);
}

TEST(HostilePacket, IsTriedForEveryTypeOfOlderVersions) {
  expectAllOf("v3", lab_v3::AllTypes{});
  expectAllOf("v4", lab_v4::AllTypes{});
}

template <class Types>
void expectAllFields(Types types) {
  forEachType(types, []<class Message>() {
    SCOPED_TRACE(Message::getTypeName());
    auto message = sample<Message>(kElements);
    WireWriter expected;
    expected.unsignedNumber(static_cast<std::uint64_t>(Message::getHash()));
    expected(message);
    EXPECT_EQ(encode(message), expected.bytes);
    Message heard{};
    EXPECT_TRUE(decode(encode(message), heard));
  });
}

// What test_lcmtypes_contract shows of today's types: the fields are all there, in this order.
TEST(HostilePacket, KnowsEveryFieldOfOlderVersions) {
  expectAllFields(lab_v3::AllTypes{});
  expectAllFields(lab_v4::AllTypes{});
}

}  // namespace
}  // namespace lab
