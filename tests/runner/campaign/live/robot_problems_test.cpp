#include "runner/campaign/live/robot_problems.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace lab::runner::campaign {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

/// A summary of robots that ran one program for 60 s.
class Summary {
 public:
  Summary& robot(int id, double observed_s, double msd_cm2, int boots = 1, double contact = 0) {
    robots_.push_back({{"robot", id}, {"boots", boots}});
    each_.push_back({{"robot", id},
                     {"time_shares", {{"contact", contact}}},
                     {"whole_motion",
                      {{"observed_s", observed_s},
                       {"lag_s", {0.1, 0.96, 10.0}},
                       {"msd_cm2", {0.01, msd_cm2, nullptr}}}}});
    return *this;
  }

  [[nodiscard]] std::string text() const {
    nlohmann::json program{{"name", "abp"}, {"each_robot", each_}};
    if (each_.size() == 1) {
      program["pool"] = each_[0];
      program["each_robot"] = nlohmann::json::array();
    }
    return nlohmann::json{{"duration_s", 60.0}, {"robots", robots_}, {"programs", {program}}}
        .dump();
  }

 private:
  nlohmann::json robots_ = nlohmann::json::array();
  nlohmann::json each_ = nlohmann::json::array();
};

TEST(RobotProblems, ThereAreNoneInAnOrdinaryRun) {
  const std::string text = Summary().robot(1, 60, 9).robot(2, 55, 4).robot(3, 59, 12).text();
  EXPECT_THAT(robotProblems(text, {1, 2, 3}), IsEmpty());
}

TEST(RobotProblems, NamesRobotsThatRebootVanishOrStall) {
  const std::string text = Summary()
                               .robot(1, 60, 9)
                               .robot(2, 60, 9, 2)
                               .robot(3, 25, 9)
                               .robot(4, 60, 0.1)
                               .robot(5, 60, 9)
                               .text();
  EXPECT_THAT(robotProblems(text, {1, 2, 3, 4, 5, 6}),
              ElementsAre(Pair(2, RobotProblem::kRebooted), Pair(3, RobotProblem::kVanished),
                          Pair(4, RobotProblem::kStalled), Pair(6, RobotProblem::kVanished)));
}

TEST(RobotProblems, OneRobotIsComparedWithTheDuration) {
  EXPECT_THAT(robotProblems(Summary().robot(1, 59, 9).text(), {1}), IsEmpty());
  EXPECT_THAT(robotProblems(Summary().robot(1, 20, 9).text(), {1}),
              ElementsAre(Pair(1, RobotProblem::kVanished)));
}

TEST(RobotProblems, AJammedRobotIsNotCalledStalled) {
  const std::string text =
      Summary().robot(1, 60, 9).robot(2, 60, 0.1, 1, 0.4).robot(3, 60, 9).robot(4, 60, 8).text();
  EXPECT_THAT(robotProblems(text, {1, 2, 3, 4}), IsEmpty());
}

TEST(RobotProblems, SlowProgramsAreNoStall) {
  const std::string text =
      Summary().robot(1, 60, 1e-4).robot(2, 60, 2e-4).robot(3, 60, 1e-4).text();
  EXPECT_THAT(robotProblems(text, {1, 2, 3}), IsEmpty());
}

}  // namespace
}  // namespace lab::runner::campaign
