// The message contract: every type, field and constant. lcm-gen's exit code reports no errors, so
// the compiler and this test check the types; and constants are not part of LCM's fingerprint.
#include "tests/lcmtypes/contract.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/fingerprints.hpp"
#include "common/bus/message_header.hpp"
#include "common/process/version.hpp"
#include "tests/support/text_file.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;

const fs::path kTypes = LAB_LCMTYPES_FOLDER;
const fs::path kPinned = LAB_PINNED_CONTRACT;

template <class Visit>
void forEveryType(Visit visit) {
  forEachType(ChannelTypes{}, visit);
  forEachType(PartTypes{}, visit);
}

/// Lines "type hash" and "type.CONSTANT = value", in the order of the files.
std::string contractInWords() {
  std::map<std::string, std::string> hashes;
  forEveryType([&hashes]<class Message>() {
    std::array<char, 17> hash{};
    std::snprintf(hash.data(), hash.size(), "%016llx",
                  static_cast<unsigned long long>(Message::getHash()));
    hashes[Message::getTypeName()] = hash.data();
  });
  const std::regex constant(R"(const\s+\w+\s+(\w+)\s*=\s*(-?\w+)\s*;)");
  std::string words = "contract version " + std::to_string(kContractVersion) + "\n";
  for (const auto& [type, hash] : hashes) {
    words += type + " " + hash + "\n";
    const std::string text = support::readFile(kTypes / (type + ".lcm"));
    for (std::sregex_iterator match(text.begin(), text.end(), constant), end; match != end;
         ++match) {
      words += type + "." + (*match)[1].str() + " = " + (*match)[2].str() + "\n";
    }
  }
  return words;
}

TEST(Contract, CoversEveryTypeOfItsFolder) {
  std::set<std::string> tested;
  std::set<std::string> written;
  forEveryType([&tested]<class Message>() { tested.insert(Message::getTypeName()); });
  for (const auto& entry : fs::directory_iterator(kTypes)) {
    if (entry.path().extension() == ".lcm") written.insert(entry.path().stem());
  }
  EXPECT_EQ(tested, written);
}

TEST(Contract, ChangesOnlyWithItsVersion) {
  const std::string now = contractInWords();
  const fs::path proposal =
      fs::temp_directory_path() / ("lab_contract_" + std::to_string(getpid()) + ".txt");
  const bool same = now == support::readFile(kPinned);
  if (!same) std::ofstream(proposal) << now;
  EXPECT_TRUE(same) << "the contract is no longer the one in " << kPinned
                    << ". lcmtypes/README.md, \"Versions\", says what a change needs; the new text "
                       "stands in "
                    << proposal;
}

TEST(Contract, IsEncodedAsLcmSpecifies) {
  forEveryType([]<class Message>() {
    for (const std::size_t length : {0U, 1U, 3U}) {
      SCOPED_TRACE(std::string(Message::getTypeName()) + " with arrays of " +
                   std::to_string(length));
      auto message = sample<Message>(length);
      WireWriter expected;
      expected.unsignedNumber(static_cast<std::uint64_t>(Message::getHash()));
      expected(message);
      EXPECT_EQ(encode(message), expected.bytes);
    }
  });
}

TEST(Contract, SurvivesTheRoundTripFieldByField) {
  forEveryType([]<class Message>() {
    for (const std::size_t length : {0U, 1U, 3U}) {
      SCOPED_TRACE(std::string(Message::getTypeName()) + " with arrays of " +
                   std::to_string(length));
      auto message = sample<Message>(length);
      auto heard = sample<Message>(7);  // a reused message must be cleared
      ASSERT_TRUE(decode(encode(message), heard));
      WireWriter said;
      WireWriter understood;
      said(message);
      understood(heard);
      EXPECT_EQ(understood.bytes, said.bytes);
    }
  });
}

TEST(Contract, StartsEveryChannelTypeWithTheHeader) {
  forEachType(ChannelTypes{}, []<class Message>() {
    SCOPED_TRACE(Message::getTypeName());
    auto message = sample<Message>(2);
    message.sender = "robot_bridge";
    message.instance = 1'700'000'000'000'001;
    message.seq = 42;
    const std::vector<std::uint8_t> bytes = encode(message);
    const std::optional<MessageHeader> header = peekHeader(bytes);
    ASSERT_TRUE(header);
    EXPECT_EQ(header->fingerprint, Message::getHash());
    EXPECT_EQ(header->utime, message.utime);
    EXPECT_EQ(header->sender, "robot_bridge");
    EXPECT_EQ(header->instance, 1'700'000'000'000'001);
    EXPECT_EQ(header->seq, 42);
  });
}

TEST(Contract, FindsEveryChannelTypeByItsFingerprint) {
  std::set<std::int64_t> hashes;
  forEachType(ChannelTypes{}, [&hashes]<class Message>() {
    hashes.insert(Message::getHash());
    EXPECT_EQ(typeWithFingerprint(Message::getHash()), Message::getTypeName());
    EXPECT_THAT(fingerprintList(), testing::HasSubstr(std::string(Message::getTypeName()) + " "));
  });
  EXPECT_EQ(hashes.size(), 22U);
  EXPECT_EQ(typeWithFingerprint(1), "");
}

}  // namespace
}  // namespace lab
