#include "runner/doctor/doctor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace lab::runner {
namespace {

using Level = Finding::Level;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

MachineFacts healthyMachine() {
  MachineFacts facts;
  facts.loopback_up = true;
  facts.multicast_interface = "lo";
  facts.receive_buffer = 4194304;
  facts.free_bytes = 50'000'000'000;
  facts.has_logger = true;
  facts.has_gnuplot = true;
  facts.clock_disciplined = true;
  facts.cpus = 4;
  facts.has_ssh = true;
  facts.has_gateway = true;
  facts.has_emulator = true;
  facts.fragment_time = 1;
  facts.has_display = true;
  return facts;
}

std::vector<Finding> problems(const MachineFacts& facts) {
  std::vector<Finding> left = judge(facts, {.runs = "runs", .registrations = "labs"});
  std::erase_if(left, [](const Finding& finding) { return finding.level == Level::kOk; });
  return left;
}

Finding onlyProblem(const MachineFacts& facts) {
  const std::vector<Finding> found = problems(facts);
  EXPECT_EQ(found.size(), 1U);
  return found.empty() ? Finding{} : found.front();
}

TEST(Doctor, ReportsNoProblemOfAHealthyMachine) {
  const std::vector<Finding> findings = judge(healthyMachine(), {.runs = "r", .registrations = ""});

  EXPECT_EQ(findings.size(), 17U);
  EXPECT_THAT(problems(healthyMachine()), IsEmpty());
  EXPECT_EQ(exitCode(findings), 0);
}

TEST(Doctor, ReportsErrorsIfNoLabCanRun) {
  MachineFacts no_loopback = healthyMachine();
  no_loopback.loopback_up = false;
  MachineFacts no_multicast = healthyMachine();
  no_multicast.multicast_problem = {"no route", "add one"};
  MachineFacts no_disk = healthyMachine();
  no_disk.free_bytes = 99'999'999;
  MachineFacts no_gnuplot = healthyMachine();
  no_gnuplot.has_gnuplot = false;

  for (const MachineFacts& facts : {no_loopback, no_multicast, no_disk, no_gnuplot}) {
    EXPECT_EQ(onlyProblem(facts).level, Level::kError);
    EXPECT_EQ(exitCode(problems(facts)), 2);
  }
}

TEST(Doctor, WarnsOnlyIfALabCanStillRun) {
  MachineFacts small_buffer = healthyMachine();
  small_buffer.receive_buffer = 4194303;
  MachineFacts little_disk = healthyMachine();
  little_disk.free_bytes = 1'999'999'999;
  MachineFacts free_clock = healthyMachine();
  free_clock.clock_disciplined = false;
  MachineFacts unknown_clock = healthyMachine();
  unknown_clock.clock_disciplined.reset();
  MachineFacts one_cpu = healthyMachine();
  one_cpu.cpus = 1;
  MachineFacts unknown_route = healthyMachine();
  unknown_route.multicast_interface.reset();
  MachineFacts no_logger = healthyMachine();
  no_logger.has_logger = false;

  for (const MachineFacts& facts :
       {small_buffer, little_disk, free_clock, unknown_clock, one_cpu, unknown_route, no_logger}) {
    const Finding finding = onlyProblem(facts);
    EXPECT_EQ(finding.level, Level::kWarning) << finding.what;
    EXPECT_NE(finding.fix, "") << finding.what;
    EXPECT_EQ(exitCode(problems(facts)), 0);
  }
}

TEST(Doctor, WarnsOfAMulticastRouteToTheNetwork) {
  MachineFacts facts = healthyMachine();
  facts.multicast_interface = "wlan0";

  const Finding finding = onlyProblem(facts);

  EXPECT_EQ(finding.level, Level::kWarning);
  EXPECT_THAT(finding.what, HasSubstr("wlan0"));
  EXPECT_THAT(finding.fix, HasSubstr("sudo ip route add 224.0.0.0/4 dev lo"));
}

TEST(Doctor, ReportsTheMulticastProblemWithItsFix) {
  MachineFacts facts = healthyMachine();
  facts.multicast_problem = {"swallowed", "open it"};

  EXPECT_EQ(onlyProblem(facts).what, "swallowed");
  EXPECT_EQ(onlyProblem(facts).fix, "open it");
}

TEST(Doctor, ListsEveryStaleRegistration) {
  MachineFacts facts = healthyMachine();
  facts.stale_registrations = {"labs/a", "labs/b"};

  const std::vector<Finding> found = problems(facts);

  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].fix, "rm 'labs/a'");
  EXPECT_EQ(found[1].fix, "rm 'labs/b'");
}

TEST(Doctor, ListsPortsInUseWithoutAWarning) {
  MachineFacts facts = healthyMachine();
  facts.busy_ports = {20001, 30002};
  std::ostringstream out;

  print(out, judge(facts, {.runs = "r", .registrations = ""}));

  EXPECT_THAT(out.str(), HasSubstr("taken: 20001 30002\n"));
  EXPECT_THAT(problems(facts), IsEmpty());
}

TEST(Doctor, PrintsOneLinePerFindingAndTheFixBelow) {
  std::ostringstream out;

  print(out,
        {{Level::kOk, "a", ""}, {Level::kWarning, "b", "fix b"}, {Level::kError, "c", "fix c"}});

  EXPECT_EQ(out.str(), "ok    a\nwarn  b\n      fix b\nFIX   c\n      fix c\n");
}

TEST(Doctor, WarnsOfALongFragmentTime) {
  MachineFacts facts = healthyMachine();
  facts.fragment_time = 30;

  EXPECT_THAT(onlyProblem(facts).what, HasSubstr("after 30 s (ipfrag_time)"));
  EXPECT_THAT(onlyProblem(facts).fix, HasSubstr("net.ipv4.ipfrag_time=1"));
}

TEST(Doctor, NamesInaccessibleDevicesAndTheGroupWithAccess) {
  MachineFacts lines = healthyMachine();
  lines.serial_lines = 2;
  lines.closed_serial_lines = {"/dev/ttyUSB1"};
  EXPECT_THAT(onlyProblem(lines).what, HasSubstr("no access to /dev/ttyUSB1"));
  EXPECT_THAT(onlyProblem(lines).fix, HasSubstr("usermod -aG dialout $USER"));

  MachineFacts cameras = healthyMachine();
  cameras.cameras = 1;
  cameras.closed_cameras = {"/dev/video0"};
  EXPECT_THAT(onlyProblem(cameras).what, HasSubstr("no access to /dev/video0"));
  EXPECT_THAT(onlyProblem(cameras).fix, HasSubstr("usermod -aG video $USER"));
}

TEST(Doctor, WarnsOfAMissingDisplayAndMissingSsh) {
  MachineFacts facts = healthyMachine();
  facts.has_display = false;
  EXPECT_THAT(onlyProblem(facts).what, HasSubstr("no display"));

  facts = healthyMachine();
  facts.has_ssh = false;
  EXPECT_THAT(onlyProblem(facts).fix, HasSubstr("openssh-client"));
}

}  // namespace
}  // namespace lab::runner
