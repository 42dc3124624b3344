#include "common/service/experiment_request.hpp"

#include <gtest/gtest.h>

namespace lab {
namespace {

constexpr std::int64_t kStart_us = 1'000'000;

ExperimentRequest pauseRequest() {
  experiment_command_t command{};
  command.action = experiment_command_t::PAUSE;
  return {command, "lab_pause", 7, 42, kStart_us};
}

experiment_status_t echoOf(const ExperimentRequest& request) {
  experiment_status_t status{};
  status.commander = request.message().sender;
  status.command_instance = request.message().instance;
  status.command_seq = request.message().seq;
  return status;
}

TEST(ExperimentRequest, HasItsSenderAndContent) {
  experiment_command_t command{};
  command.action = experiment_command_t::SEEK;
  command.value = 12.5;
  command.text = "there";
  const ExperimentRequest request(command, "dashboard", 3, 9, kStart_us);
  EXPECT_EQ(request.message().action, experiment_command_t::SEEK);
  EXPECT_EQ(request.message().value, 12.5);
  EXPECT_EQ(request.message().text, "there");
  EXPECT_EQ(request.message().sender, "dashboard");
  EXPECT_EQ(request.message().instance, 3);
  EXPECT_EQ(request.message().seq, 9);
  EXPECT_EQ(request.message().utime, kStart_us);
}

TEST(ExperimentRequest, IsAnsweredOnlyByItsEcho) {
  ExperimentRequest request = pauseRequest();
  EXPECT_FALSE(request.take(experiment_status_t{}));
  experiment_status_t other = echoOf(request);
  other.command_seq = 41;
  EXPECT_FALSE(request.take(other)) << "an earlier request";
  other = echoOf(request);
  other.command_instance = 6;
  EXPECT_FALSE(request.take(other)) << "another process";
  other = echoOf(request);
  other.commander = "dashboard";
  EXPECT_FALSE(request.take(other)) << "another sender";
  EXPECT_FALSE(request.answered());

  EXPECT_TRUE(request.take(echoOf(request)));
  EXPECT_TRUE(request.answered());
  EXPECT_EQ(request.refusal(), "");
  EXPECT_TRUE(request.take(other)) << "it remains answered";
}

TEST(ExperimentRequest, KeepsTheRefusalOfTheFirstAnswer) {
  ExperimentRequest request = pauseRequest();
  experiment_status_t echo = echoOf(request);
  echo.refusal = "the script is over";
  EXPECT_TRUE(request.take(echo));
  echo.refusal = "";
  EXPECT_TRUE(request.take(echo));
  EXPECT_EQ(request.refusal(), "the script is over");
}

TEST(ExperimentRequest, ExpiresWithoutAnAnswer) {
  ExperimentRequest request = pauseRequest();
  EXPECT_FALSE(request.expired(kStart_us + ExperimentRequest::kTimeout_us));
  EXPECT_TRUE(request.expired(kStart_us + ExperimentRequest::kTimeout_us + 1));
  EXPECT_TRUE(request.take(echoOf(request)));
  EXPECT_FALSE(request.expired(kStart_us + 10 * ExperimentRequest::kTimeout_us));
}

TEST(Remark, IsOneLineOfText) {
  EXPECT_EQ(remarkProblem(""), "");
  EXPECT_EQ(remarkProblem("\u03B7 = 3 rad/s, robot 4 was l\u00F6se"), "");
  EXPECT_NE(remarkProblem("two\nlines"), "");
  EXPECT_NE(remarkProblem("bell\a"), "");
  EXPECT_NE(remarkProblem(std::string("nul\0", 4)), "");
  EXPECT_NE(remarkProblem("\x7F"), "");
  EXPECT_NE(remarkProblem("\xC2\x9B"
                          "2J"),
            "")
      << "an escape sequence of a terminal";
  EXPECT_EQ(remarkProblem("\xC2\xA0"), "")
      << "the first character after the control characters of Latin-1";
  EXPECT_NE(remarkProblem("caf\xE9"), "") << "Latin-1";
}

TEST(Remark, HasAtMost500Characters) {
  std::string longest;
  for (int i = 0; i < 500; ++i) longest += "\U0001F916";  // four bytes each
  EXPECT_EQ(remarkProblem(longest), "");
  EXPECT_NE(remarkProblem(longest + "a"), "");
  EXPECT_NE(remarkProblem(std::string(501, 'a')), "");
  EXPECT_NE(remarkProblem(std::string(10'000'000, 'a')), "");
}

}  // namespace
}  // namespace lab
