#include "runner/doctor/machine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

class Machine : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    support::writeFile(folder_ / name, text);
    return folder_ / name;
  }

  TemporaryFolder folder_;
};

// These tests run in a private network namespace in which multicast is routed over lo.

TEST_F(Machine, FindsNoProblemWhenMulticastComesBack) {
  const auto problem = multicastProblem();

  EXPECT_FALSE(problem) << *problem;
}

TEST_F(Machine, ReportsThatMulticastLeavesByTheLoopback) { EXPECT_EQ(multicastInterface(), "lo"); }

TEST_F(Machine, ReportsBrokenMulticastInAnEmptyNetwork) {
  const auto check = [] {
    if (unshare(CLONE_NEWNET) != 0) std::exit(1);
    const auto problem = multicastProblem();
    if (!problem || problem->find("224.0.0.0/4 dev lo") == std::string::npos) std::exit(2);
    if (multicastInterface()) std::exit(3);
    if (survey(".", "").loopback_up) std::exit(4);
    std::exit(0);
  };

  EXPECT_EXIT(check(), testing::ExitedWithCode(0), "");
}

TEST_F(Machine, ReadsTheDeviceOfARoute) {
  EXPECT_EQ(interfaceOfRoute("multicast 239.255.76.67 dev eth0 src 10.0.0.2 uid 0 \n    cache"),
            "eth0");
  EXPECT_EQ(interfaceOfRoute("RTNETLINK answers: Network is unreachable"), std::nullopt);
  EXPECT_EQ(interfaceOfRoute("multicast 239.255.76.67 dev"), std::nullopt);
}

TEST_F(Machine, ReportsTheFreeSpaceOfTheNearestExistingAncestor) {
  EXPECT_GT(freeBytes(folder_.path()), 0);
  EXPECT_GT(freeBytes(folder_ / "runs/not yet/made"), 0);
}

TEST_F(Machine, FindsOnlyExecutableFilesInThePath) {
  fs::permissions(write("tool", "#!/bin/sh\n"), fs::perms::owner_all);
  fs::permissions(write("text", "tool"), fs::perms::owner_read);
  fs::create_directory(folder_ / "folder");
  setenv("PATH", ("/nowhere:" + folder_.path().string()).c_str(), 1);

  EXPECT_EQ(findProgram("tool"), folder_ / "tool");
  EXPECT_EQ(findProgram("text"), std::nullopt);
  EXPECT_EQ(findProgram("folder"), std::nullopt);
  EXPECT_EQ(findProgram("absent"), std::nullopt);
}

TEST_F(Machine, ARegistrationIsStaleWhenItsProcessIsGone) {
  const fs::path gone = write("4194305.json", "{}");  // above the largest pid that Linux gives
  write(std::to_string(getpid()) + ".json", "{}");
  write("4194305.txt", "not a registration");
  write("note.json", "{}");

  EXPECT_THAT(staleRegistrations(folder_.path()), ElementsAre(gone));
  EXPECT_THAT(staleRegistrations(folder_ / "absent"), IsEmpty());
}

TEST_F(Machine, ListsThePortsThatListenOnEveryAddressOrOnLcmsGroup) {
  const char* text =
      "   sl  local_address rem_address   st tx_queue rx_queue tr\n"
      " 5210: 00000000:7531 00000000:0000 07 00000000:00000000 00:00000000\n"   // 30001
      " 5211: 00000000:4E20 00000000:0000 07 00000000:00000000 00:00000000\n"   // 20000
      " 5212: 00000000:7531 00000000:0000 07 00000000:00000000 00:00000000\n"   // 30001 again
      " 5213: 0100007F:7532 00000000:0000 07 00000000:00000000 00:00000000\n"   // one address
      " 5214: 00000000:7533 08080808:0035 01 00000000:00000000 00:00000000\n"   // connected
      " 5215: 00000000:4E1F 00000000:0000 07 00000000:00000000 00:00000000\n"   // 19999
      " 5216: 00000000:EA60 00000000:0000 07 00000000:00000000 00:00000000\n"   // 60000
      " 5217: 434CFFEF:7534 00000000:0000 07 00000000:00000000 00:00000000\n"   // 30004, group
      " 5218: 444CFFEF:7535 00000000:0000 07 00000000:00000000 00:00000000\n";  // another group

  EXPECT_THAT(listeningPorts(text), ElementsAre(20000, 30001, 30004));
}

TEST_F(Machine, SurveyFillsTheFactsThatEveryMachineHas) {
  const MachineFacts facts = survey(folder_.path(), folder_.path());

  EXPECT_TRUE(facts.loopback_up);
  EXPECT_GT(facts.receive_buffer, 0);
  EXPECT_LE(facts.receive_buffer, 4194304);
  EXPECT_GT(facts.free_bytes, 0);
  EXPECT_GE(facts.cpus, 1U);
  EXPECT_THAT(facts.busy_ports, IsEmpty());
}

}  // namespace
}  // namespace lab::runner
