#include "common/experiment/keys/experiment_key_table.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "tests/support/experiment_samples.hpp"
#include "tests/support/text_file.hpp"

namespace lab::keys {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(KeyTable, IsContainedInTheManual) {
  const std::string docs =
      support::readFile(std::filesystem::path(LAB_ROOT) / "docs" / "experiments.md");

  EXPECT_TRUE(docs.find(keyTables()) != std::string::npos)
      << "docs/experiments.md must contain, in place of its tables:\n\n"
      << keyTables();
}

TEST(KeyTable, HasEveryKeyOfAWrittenFile) {
  const std::string tables = keyTables();
  std::string written = writeExperiment(small());
  // The keys of programs of motion have a page of their own.
  const std::size_t parameters = written.find("\nparameters = {");
  const std::size_t after_phase = written.find("\n[light_table]");
  ASSERT_LT(parameters, after_phase);
  written.erase(parameters, after_phase - parameters);
  std::size_t keys = 0;
  for (std::size_t at = 0; (at = written.find(" = ", at)) != std::string::npos; ++at) {
    const std::size_t begin = written.find_last_of("\n{ ", at - 1) + 1;
    const std::string key = written.substr(begin, at - begin);
    EXPECT_THAT(tables, HasSubstr("| `" + key + "` |"));
    ++keys;
  }
  EXPECT_GT(keys, 40U);
}

TEST(KeyTable, HasDefaultsAndUnitsOfTheFile) {
  EXPECT_THAT(keyTables(), HasSubstr("| `diameter_cm` | number, cm | 7.5 | 1 to 50 |"));
  EXPECT_THAT(keyTables(), HasSubstr("| `pwm_steps` | boolean | true |"));
}

TEST(KeyTable, FindsAKeyInItsTable) {
  EXPECT_THAT(keyPathsEndingIn("fps"), ElementsAre("camera.fps"));
  EXPECT_THAT(keyPathsEndingIn("nothing"), IsEmpty());
}

TEST(NearestKey, ToleratesSmallMistakesAndAMissingUnit) {
  const std::vector<std::string> keys = {"diameter_cm", "ir_range_cm", "lease_s", "pwm_steps"};
  EXPECT_EQ(nearestKey("diametre_cm", keys), "diameter_cm");
  EXPECT_EQ(nearestKey("lease", keys), "lease_s");
  EXPECT_EQ(nearestKey("pwm_stpes", keys), "pwm_steps");
  EXPECT_EQ(nearestKey("colour", keys), "");
  EXPECT_EQ(nearestKey("x", {}), "");
}

TEST(KeyMeantBy, FindsAKeyWithoutItsUnitOrItsTable) {
  EXPECT_EQ(keyMeantBy("duration"), "duration_s");
  EXPECT_EQ(keyMeantBy("duratoin_s"), "duration_s");
  EXPECT_EQ(keyMeantBy("fps"), "camera.fps");
  EXPECT_EQ(keyMeantBy("frobnicate"), "");
}

}  // namespace
}  // namespace lab::keys
