#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ReproduceLong, EveryPanelOfAnHourAgreesWithTheExactLaw) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  const Finished dut = run("lab reproduce --out " + out.string(), std::chrono::seconds(1700));
  ASSERT_EQ(dut.exit_code, 0) << dut.output;
  for (const char* panel : {"2b", "2c", "2d", "2e", "3b", "3d", "4c", "4d", "4e"}) {
    EXPECT_THAT(dut.output, HasSubstr(std::string(panel) + "  agrees with the exact law"));
  }
  EXPECT_THAT(dut.output, HasSubstr("The paper’s eq. 6 is the exact law here"));
  EXPECT_THAT(dut.output, Not(HasSubstr("deviates")));
}

}  // namespace
}  // namespace lab::system_test
