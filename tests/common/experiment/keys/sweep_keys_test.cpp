#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/experiment/experiment_file.hpp"
#include "common/experiment/sweep.hpp"

namespace lab {
namespace {

constexpr const char* kText = R"([sweep]
over = ["programs.abp.v_cm_s=1,2"]
seeds = 60
[sweep.adaptive]
goal = "mean"
quantity = "D_cm2_s"
robot_time_s = 54000
)";

TEST(ReadSweepTable, AppliesSettings) {
  EXPECT_EQ(readSweepTable(kText, "x.toml").seeds, 60);
  const SweepTable dut = readSweepTable(
      kText, "x.toml", {"duration_s=3", "sweep.seeds=2", "sweep.adaptive.robot_time_s=200"});
  EXPECT_EQ(dut.seeds, 2);
  ASSERT_TRUE(dut.adaptive);
  EXPECT_EQ(dut.adaptive->robot_time_s, 200);
  EXPECT_EQ(readSweepTable("", "x.toml", {"sweep={seeds=3}"}).seeds, 3);
}

TEST(ReadSweepTable, NamesTheSettingThatIsWrong) {
  EXPECT_THAT([] { static_cast<void>(readSweepTable(kText, "x.toml", {"sweep.seeds=0"})); },
              testing::ThrowsMessage<ExperimentError>(
                  testing::StartsWith("--set sweep.seeds=0: sweep.seeds: found 0")));
}

}  // namespace
}  // namespace lab
