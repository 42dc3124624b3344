#include "runner/live/request_log.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace lab::runner {
namespace {

using testing::HasSubstr;

experiment_command_t requestOf(std::int64_t seq, const std::string& sender = "dashboard") {
  experiment_command_t request{};
  request.sender = sender;
  request.instance = 7;
  request.seq = seq;
  request.action = experiment_command_t::MARK;
  request.text = "a remark";
  return request;
}

class RequestLogTest : public testing::Test {
 protected:
  experiment_status_t answer() const {
    experiment_status_t status{};
    log_.write(status);
    return status;
  }

  std::vector<experiment_command_t> executed_;
  std::string refusal_;
  RequestLog log_{[this](const experiment_command_t& request) {
    executed_.push_back(request);
    return refusal_;
  }};
};

TEST_F(RequestLogTest, ReportsNothingBeforeARequest) { EXPECT_EQ(answer().commander, ""); }

TEST_F(RequestLogTest, ExecutesARequestOnceAndEchoesItsRepetitions) {
  for (int i = 0; i < 3; ++i) log_.take(requestOf(1));
  EXPECT_EQ(executed_.size(), 1U);
  EXPECT_EQ(answer().commander, "dashboard");
  EXPECT_EQ(answer().command_instance, 7);
  EXPECT_EQ(answer().command_seq, 1);
  EXPECT_EQ(answer().refusal, "");
}

TEST_F(RequestLogTest, DistinguishesSenders) {
  log_.take(requestOf(1));
  log_.take(requestOf(1, "lab_mark"));
  experiment_command_t other = requestOf(1);
  other.instance = 8;
  log_.take(other);
  log_.take(requestOf(2));
  EXPECT_EQ(executed_.size(), 4U);
}

TEST_F(RequestLogTest, RepeatsTheAnswerToARepetitionAfterOtherRequests) {
  refusal_ = "not now";
  log_.take(requestOf(1));
  refusal_ = "";
  log_.take(requestOf(2));
  EXPECT_EQ(answer().refusal, "");
  log_.take(requestOf(1));
  EXPECT_EQ(answer().command_seq, 1);
  EXPECT_EQ(answer().refusal, "not now");
  EXPECT_EQ(executed_.size(), 2U);
}

TEST_F(RequestLogTest, RefusesControlCharactersAndInvalidSenders) {
  experiment_command_t request = requestOf(1);
  request.text = "two\nlines";
  log_.take(request);
  EXPECT_THAT(answer().refusal, HasSubstr("control characters"));
  log_.take(requestOf(2, ""));
  EXPECT_THAT(answer().refusal, HasSubstr("no sender name"));
  log_.take(requestOf(3, "bad\x1B[2J"));
  EXPECT_THAT(answer().refusal, HasSubstr("no sender name"));
  log_.take(requestOf(4, std::string(65, 'x')));
  EXPECT_THAT(answer().refusal, HasSubstr("no sender name"));
  EXPECT_TRUE(executed_.empty());
}

TEST_F(RequestLogTest, KeepsTheLast256Answers) {
  for (int seq = 0; seq < 1000; ++seq) log_.take(requestOf(seq));
  ASSERT_EQ(executed_.size(), 1000U);
  log_.take(requestOf(999 - 255));
  EXPECT_EQ(executed_.size(), 1000U) << "still known";
  log_.take(requestOf(0));
  EXPECT_EQ(executed_.size(), 1001U) << "forgotten: no sender repeats a request for that long";
}

}  // namespace
}  // namespace lab::runner
