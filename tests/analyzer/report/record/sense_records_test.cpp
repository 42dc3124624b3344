#include "analyzer/report/record/sense_records.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lab::report::sense_records_test {
namespace {

robot_senses_t message(const std::vector<std::vector<float>>& robots) {
  robot_senses_t senses{};
  for (const std::vector<float>& values : robots) {
    sense_values_t robot{};
    for (std::size_t i = 0; i < values.size(); ++i) robot.values[i] = values[i];
    senses.robots.push_back(robot);
  }
  senses.num_robots = static_cast<std::int32_t>(senses.robots.size());
  return senses;
}

SenseSpec sense(std::int64_t index, SenseKind kind) {
  SenseSpec spec;
  spec.index = index;
  spec.kind = kind;
  spec.radius = 0.12;
  return spec;
}

TEST(SenseRecords, HoldWhatProgramsReadFromAllRobotsAtAllTimes) {
  SenseRecords dut;
  dut.take(message({{2, 0, 0, 0, 0, 0, 0, -1}, {4, 0, 0, 0, 0, 0, 0, -2}}));
  dut.take(message({{9, 0, 0, 0, 0, 0, 0, -3}}));
  Senses senses;
  senses.values = {sense(0, SenseKind::kNeighbours), sense(7, SenseKind::kNearestBearing)};

  const std::vector<SenseRecord> records = dut.records(senses);

  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].index, 0);
  EXPECT_EQ(records[0].what, "neighbours within 12 cm");
  EXPECT_EQ(records[0].values, 3);
  EXPECT_DOUBLE_EQ(records[0].mean, 5);
  EXPECT_DOUBLE_EQ(records[0].deviation, std::sqrt(26.0 / 3));
  EXPECT_EQ(records[0].lowest, 2);
  EXPECT_EQ(records[0].highest, 9);
  EXPECT_EQ(records[1].index, 7);
  EXPECT_EQ(records[1].what, "bearing of the nearest robot within 12 cm (rad)");
  EXPECT_EQ(records[1].lowest, -3);
  EXPECT_EQ(records[1].highest, -1);
}

TEST(SenseRecords, LeaveOutNumbersThatNobodyWrites) {
  SenseRecords dut;
  dut.take(message({{0, 0, 0, 5, 0, 0, 0, 0}}));
  Senses senses;
  senses.values = {sense(1, SenseKind::kNeighbours)};

  const std::vector<SenseRecord> records = dut.records(senses);

  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].index, 1) << "defined, and always 0";
  EXPECT_EQ(records[1].index, 3) << "not defined here, but written";
  EXPECT_EQ(records[1].what, "");
  EXPECT_TRUE(SenseRecords().records(senses).empty()) << "nothing was sent";
}

}  // namespace
}  // namespace lab::report::sense_records_test
