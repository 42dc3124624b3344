#include "common/text/nearest_word.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lab {
namespace {

TEST(NearestWord, FindsTheWordThatWasMeant) {
  const std::vector<std::string> words = {"abp", "noisy_abp", "bp", "rtp", "stand", "wheels"};
  EXPECT_EQ(nearestWord("abpp", words), "abp");
  EXPECT_EQ(nearestWord("ABP", words), "abp");
  EXPECT_EQ(nearestWord("noisyabp", words), "noisy_abp");
  EXPECT_EQ(nearestWord("apb", words), "abp");
  EXPECT_EQ(nearestWord("staand", words), "stand");
}

TEST(NearestWord, FindsNothingWhereNothingIsSimilar) {
  EXPECT_EQ(nearestWord("vicsek", {"abp", "bp", "stand"}), "");
  EXPECT_EQ(nearestWord("x", {"bp"}), "");
  EXPECT_EQ(nearestWord("", {"bp"}), "");
  EXPECT_EQ(nearestWord("x", {}), "");
}

TEST(NearestWord, LeavesOutLongWords) {  // they would take hours
  const std::string longest(64, 'a');
  EXPECT_EQ(nearestWord(longest, {longest}), longest);
  EXPECT_EQ(nearestWord(longest + "a", {longest}), "");
  EXPECT_EQ(nearestWord(longest, {longest + "a"}), "");
  const std::string endless(1'000'000, 'a');
  EXPECT_EQ(didYouMean(endless, {endless, "abp"}), "");
}

TEST(NearestWord, EditDistanceCountsInsertedRemovedReplacedAndSwappedLetters) {
  EXPECT_EQ(editDistance("kitten", "sitting"), 3U);
  EXPECT_EQ(editDistance("", "abc"), 3U);
  EXPECT_EQ(editDistance("abc", ""), 3U);
  EXPECT_EQ(editDistance("apb", "abp"), 1U);
  EXPECT_EQ(editDistance("Same", "same"), 0U);
}

TEST(NearestWord, AsksWhetherAWordWasMeant) {
  EXPECT_EQ(didYouMean("abpp", {"abp"}), "; did you mean abp?");
  EXPECT_EQ(didYouMean("vicsek", {"abp"}), "");
}

}  // namespace
}  // namespace lab
