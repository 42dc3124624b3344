#include "common/experiment/program_colours.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace lab {
namespace {

Experiment withPrograms(const std::vector<std::string>& names) {
  Experiment experiment;
  for (const std::string& name : names) experiment.programs[name] = {};
  return experiment;
}

TEST(ProgramColours, FollowTheNamesInTheExperiment) {
  const Experiment experiment = withPrograms({"rtp", "abp", "bp"});

  EXPECT_EQ(hexText(programColour(experiment, "abp")), "#0072B2");
  EXPECT_EQ(hexText(programColour(experiment, "bp")), "#D55E00");
  EXPECT_EQ(hexText(programColour(experiment, "rtp")), "#009E73");
}

TEST(ProgramColours, AreDifferentForSevenProgramsOfAnyName) {
  const std::vector<std::string> names{"a", "spin left", "tumble", "v 2", "µ", "zig", "zag"};
  const Experiment experiment = withPrograms(names);
  std::set<std::string> colours;
  for (const std::string& name : names) colours.insert(hexText(programColour(experiment, name)));

  EXPECT_EQ(colours.size(), names.size());
}

TEST(ProgramColours, OfProgramsWithoutANameComeAfterThoseOfTheExperiment) {
  const Experiment experiment = withPrograms({"abp", "rtp"});

  EXPECT_EQ(programPlace(experiment, "ABP 1", 0), 2U);
  EXPECT_EQ(programPlace(experiment, "ABP 2", 1), 3U);
  EXPECT_EQ(programPlace(experiment, "rtp", 1), 1U);
}

}  // namespace
}  // namespace lab
