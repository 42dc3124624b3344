#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/experiment_samples.hpp"
#include "tests/support/programs.hpp"

namespace lab::experiment_shipped_test {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsSupersetOf;
using ::testing::SizeIs;

std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const auto& file : tomlFiles("experiments")) names.push_back(file.stem().string());
  return names;
}

Experiment shipped(const std::string& name) {
  return loadExperiment(std::filesystem::path(LAB_ROOT) / "experiments" / (name + ".toml"));
}

TEST(ShippedExperiments, AreFound) {
  EXPECT_THAT(names(), IsSupersetOf({"abp", "bp", "half_dark_arena", "light_switching", "noisy_abp",
                                     "rtp", "swarm"}));
}

TEST(ShippedExperiments, HaveTheNamesOfTheirFiles) {
  for (const std::string& name : names()) EXPECT_EQ(shipped(name).name, name);
}

TEST(ShippedExperiments, AreReadBackAsWritten) {
  for (const std::string& name : names()) {
    const Experiment dut = shipped(name);
    const std::string written = writeExperiment(dut);
    const Experiment back = parseExperiment(written, name);
    EXPECT_EQ(back, dut) << name;
    EXPECT_EQ(writeExperiment(back), written) << name;
  }
}

TEST(ShippedExperiments, HaveTheParametersOfThePaper) {
  EXPECT_EQ(shipped("abp").programs.at("abp"), test::abp(0.03, 0.5, 3));
  EXPECT_EQ(shipped("noisy_abp").programs.at("noisy_abp"), test::noisyAbp(0.01, 0.1, 0.1));
  EXPECT_EQ(shipped("bp").programs.at("bp"), test::bp(0.07, 0.2));
  EXPECT_EQ(shipped("rtp").programs.at("rtp"), test::rtp(0.05, 3, 0.5));
}

TEST(ShippedExperiments, SwitchTheLightThroughThreeBands) {
  const Experiment dut = shipped("light_switching");

  EXPECT_THAT(dut.light_table.bands,
              ElementsAre(Field(&LightBand::program, "bp"), Field(&LightBand::program, "abp"),
                          Field(&LightBand::program, "rtp")));
  ASSERT_THAT(dut.light.steps, SizeIs(3));
  EXPECT_TRUE(dut.light.repeat);
  EXPECT_EQ(dut.light.length, 90);
  for (std::size_t i = 0; i < 3; ++i) {
    const double light = dut.light.steps[i].layers.at(0).intensity;
    EXPECT_GT(light, dut.light_table.bands[i].low);
    EXPECT_LT(light, dut.light_table.bands[i].high);
  }
}

}  // namespace
}  // namespace lab::experiment_shipped_test
