#include "runner/campaign/live/robot_problems.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
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
  /// @param seen share of the frames
  Summary& robot(int id, double seen, double msd_cm2, int boots = 1, double contact = 0) {
    seen_[id] = seen;
    robots_.push_back({{"robot", id}, {"boots", boots}});
    each_.push_back({{"robot", id},
                     {"time_shares", {{"contact", contact}}},
                     {"whole_motion",
                      {{"observed_s", 60 * seen},
                       {"lag_s", {0.1, 0.96, 10.0}},
                       {"msd_cm2", {0.01, msd_cm2, nullptr}}}}});
    return *this;
  }

  [[nodiscard]] std::map<std::int32_t, RobotProblem> problems() const {
    return robotProblems(text(), seen_);
  }

 private:
  [[nodiscard]] std::string text() const {
    nlohmann::json program{{"name", "abp"}, {"each_robot", each_}};
    if (each_.size() == 1) {
      program["pool"] = each_[0];
      program["each_robot"] = nlohmann::json::array();
    }
    return nlohmann::json{{"duration_s", 60.0}, {"robots", robots_}, {"programs", {program}}}
        .dump();
  }

  std::map<std::int32_t, double> seen_;
  nlohmann::json robots_ = nlohmann::json::array();
  nlohmann::json each_ = nlohmann::json::array();
};

TEST(RobotProblems, ThereAreNoneInAnOrdinaryRun) {
  EXPECT_THAT(Summary().robot(1, 1, 9).robot(2, 0.9, 4).robot(3, 0.98, 12).problems(), IsEmpty());
}

TEST(RobotProblems, NamesRobotsThatRebootVanishOrStall) {
  EXPECT_THAT(Summary()
                  .robot(1, 1, 9)
                  .robot(2, 1, 9, 2)
                  .robot(3, 0.4, 9)
                  .robot(4, 1, 0.1)
                  .robot(5, 1, 9)
                  .robot(6, 0, 9)
                  .problems(),
              ElementsAre(Pair(2, RobotProblem::kRebooted), Pair(3, RobotProblem::kVanished),
                          Pair(4, RobotProblem::kStalled), Pair(6, RobotProblem::kVanished)));
}

TEST(RobotProblems, ADimCameraIsNoProblemOfTheRobots) {
  EXPECT_THAT(Summary().robot(1, 0.4, 9).robot(2, 0.3, 4).robot(3, 0.35, 12).problems(), IsEmpty());
}

TEST(RobotProblems, OneRobotIsComparedWithAllFrames) {
  EXPECT_THAT(Summary().robot(1, 0.98, 9).problems(), IsEmpty());
  EXPECT_THAT(Summary().robot(1, 0.3, 9).problems(), ElementsAre(Pair(1, RobotProblem::kVanished)));
}

TEST(RobotProblems, AJammedRobotIsNotCalledStalled) {
  EXPECT_THAT(
      Summary().robot(1, 1, 9).robot(2, 1, 0.1, 1, 0.4).robot(3, 1, 9).robot(4, 1, 8).problems(),
      IsEmpty());
}

TEST(RobotProblems, SlowProgramsAreNoStall) {
  EXPECT_THAT(Summary().robot(1, 1, 1e-4).robot(2, 1, 2e-4).robot(3, 1, 1e-4).problems(),
              IsEmpty());
}

}  // namespace
}  // namespace lab::runner::campaign
