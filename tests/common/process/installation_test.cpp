#include "common/process/installation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/process/version.hpp"

namespace lab {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Installation, OfAPackageIsRecognisedByItsFolder) {
  const Installation found = installationOf("/usr/lib/active-lab/bin/lab");

  EXPECT_TRUE(found.packaged);
  EXPECT_EQ(found.command, "active-lab");
  EXPECT_EQ(found.programs, "/usr/lib/active-lab/bin");
  EXPECT_EQ(found.experiments, "/usr/share/active-lab/experiments");
  EXPECT_TRUE(installationOf("/home/me/x/lib/active-lab/bin/sim_svc").packaged);
}

TEST(Installation, AnywhereElseIsABuild) {
  const Installation found = installationOf("/home/me/active-lab/build/release/bin/lab");

  EXPECT_FALSE(found.packaged);
  EXPECT_EQ(found.command, "./lab");
  EXPECT_EQ(found.experiments, "/home/me/active-lab/experiments");
  for (const char* program : {"/home/me/active-lab/bin/lab", "/home/lib/my-lab/bin/lab", "/lab"}) {
    EXPECT_FALSE(installationOf(program).packaged) << program;
  }
}

TEST(Installation, NamesThePackageOfAMissingFile) {
  const Installation package = installationOf("/usr/lib/active-lab/bin/lab");
  const auto way = [&](const char* name) { return package.installHint(name, "build it"); };

  EXPECT_THAT(way("dds_gateway"), AllOf(StartsWith("sudo apt install ./active-lab-gateway_"),
                                        HasSubstr(kVersion), EndsWith("_*.deb")));
  EXPECT_THAT(way("robot_emulator"), HasSubstr("./active-lab-emulator_"));
  EXPECT_THAT(way("robot_firmware.elf"), HasSubstr("./active-lab-emulator_"));
  EXPECT_THAT(way("robot_firmware.hex"), HasSubstr("./active-lab_"));
  EXPECT_EQ(installationOf("/x/build/dev/bin/lab").installHint("dds_gateway", "build it"),
            "build it");
}

TEST(Installation, SendsAUserWhoMayNotBuildToTheOwner) {
  Installation clone = installationOf("/home/you/active-lab/build/release/bin/lab");
  clone.may_build = false;

  EXPECT_EQ(clone.installHint("sim_svc", "./lab build builds it"),
            "you may not write in /home/you/active-lab: ask its owner to run ./lab build there, or "
            "make a clone of your own");
  EXPECT_TRUE(installationOf("/home/me/active-lab/build/release/bin/lab").may_build);
}

TEST(Installation, OfThisTestIsABuild) {
  EXPECT_FALSE(installation().packaged);
  EXPECT_TRUE(std::filesystem::exists(installation().programs));
}

}  // namespace
}  // namespace lab
