#include "runner/live/request_log.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace lab::runner {
namespace {

using testing::HasSubstr;

experiment_command_t wishOf(std::int64_t seq, const std::string& sender = "dashboard") {
  experiment_command_t wish{};
  wish.sender = sender;
  wish.instance = 7;
  wish.seq = seq;
  wish.action = experiment_command_t::MARK;
  wish.text = "a remark";
  return wish;
}

class Desk : public testing::Test {
 protected:
  experiment_status_t answer() const {
    experiment_status_t status{};
    desk_.write(status);
    return status;
  }

  std::vector<experiment_command_t> obeyed_;
  std::string refusal_;
  RequestLog desk_{[this](const experiment_command_t& wish) {
    obeyed_.push_back(wish);
    return refusal_;
  }};
};

TEST_F(Desk, SaysNothingBeforeAWish) { EXPECT_EQ(answer().commander, ""); }

TEST_F(Desk, ObeysAWishOnceAndEchoesItsRepetitions) {
  for (int i = 0; i < 3; ++i) desk_.take(wishOf(1));
  EXPECT_EQ(obeyed_.size(), 1U);
  EXPECT_EQ(answer().commander, "dashboard");
  EXPECT_EQ(answer().command_instance, 7);
  EXPECT_EQ(answer().command_seq, 1);
  EXPECT_EQ(answer().refusal, "");
}

TEST_F(Desk, TellsWishersApart) {
  desk_.take(wishOf(1));
  desk_.take(wishOf(1, "lab_mark"));
  experiment_command_t other = wishOf(1);
  other.instance = 8;
  desk_.take(other);
  desk_.take(wishOf(2));
  EXPECT_EQ(obeyed_.size(), 4U);
}

TEST_F(Desk, AnswersARepetitionAsBeforeThoughOthersCameBetween) {
  refusal_ = "not now";
  desk_.take(wishOf(1));
  refusal_ = "";
  desk_.take(wishOf(2));
  EXPECT_EQ(answer().refusal, "");
  desk_.take(wishOf(1));
  EXPECT_EQ(answer().command_seq, 1);
  EXPECT_EQ(answer().refusal, "not now");
  EXPECT_EQ(obeyed_.size(), 2U);
}

TEST_F(Desk, RefusesATextThatIsNoRemarkAndASenderWithoutAName) {
  experiment_command_t wish = wishOf(1);
  wish.text = "two\nlines";
  desk_.take(wish);
  EXPECT_THAT(answer().refusal, HasSubstr("control characters"));
  desk_.take(wishOf(2, ""));
  EXPECT_THAT(answer().refusal, HasSubstr("no name"));
  desk_.take(wishOf(3, "bad\x1B[2J"));
  EXPECT_THAT(answer().refusal, HasSubstr("no name"));
  desk_.take(wishOf(4, std::string(65, 'x')));
  EXPECT_THAT(answer().refusal, HasSubstr("no name"));
  EXPECT_TRUE(obeyed_.empty());
}

TEST_F(Desk, KeepsTheLast256Answers) {
  for (int seq = 0; seq < 1000; ++seq) desk_.take(wishOf(seq));
  ASSERT_EQ(obeyed_.size(), 1000U);
  desk_.take(wishOf(999 - 255));
  EXPECT_EQ(obeyed_.size(), 1000U) << "still known";
  desk_.take(wishOf(0));
  EXPECT_EQ(obeyed_.size(), 1001U) << "forgotten: nobody repeats a wish for so long";
}

}  // namespace
}  // namespace lab::runner
