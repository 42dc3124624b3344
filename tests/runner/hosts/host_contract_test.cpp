#include "runner/hosts/host_contract.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace lab::runner {
namespace {

using testing::HasSubstr;

HostSpec bench() {
  HostSpec host;
  host.name = "bench";
  host.ssh = "pi@robot-bench";
  return host;
}

TEST(HostHello, SurvivesTheRoundTripThroughJson) {
  const HostHello own = ownHello();
  const auto dut = helloFrom(toJson(own));

  ASSERT_TRUE(dut);
  EXPECT_EQ(toJson(*dut), toJson(own));
  EXPECT_EQ(refusal(bench(), own, *dut), "");
  EXPECT_FALSE(helloFrom({{"say", "pong"}}));
  EXPECT_FALSE(helloFrom({{"say", "hello"}, {"version", 7}}));
  EXPECT_FALSE(helloFrom({{"say", "hello"}, {"version", "1"}, {"utime", 1e300}}));
}

TEST(HostHello, OfAnotherVersionIsRefusedWithBothVersionsAndAFix) {
  const HostHello own = ownHello();
  HostHello version = own;
  version.version = "9.9";
  EXPECT_THAT(refusal(bench(), own, version), HasSubstr("host bench: found another version"));
  EXPECT_THAT(refusal(bench(), own, version), HasSubstr("9.9"));
  EXPECT_THAT(refusal(bench(), own, version), HasSubstr(own.version));
  EXPECT_THAT(refusal(bench(), own, version), HasSubstr("git pull"));

  HostHello contract = own;
  ++contract.contract_version;
  HostHello types = own;
  types.fingerprints = "0";
  for (const HostHello& hello : {contract, types}) {
    EXPECT_THAT(refusal(bench(), own, hello), HasSubstr("other message types"));
  }

  HostHello here = own;
  here.revision = "aaaa";
  HostHello there = own;
  there.revision = "bbbb";
  EXPECT_THAT(refusal(bench(), here, there), HasSubstr("(bbbb) there"));
  there.revision.clear();  // built without git: the revision is unknown
  EXPECT_EQ(refusal(bench(), here, there), "");
}

TEST(ClockRefusal, RefusesOnlyOffsetsBeyondTheErrorBound) {
  EXPECT_EQ(clockRefusal(bench(), {0.0049, 0.0001}, 0.005), "");
  EXPECT_EQ(clockRefusal(bench(), {0.0060, 0.0020}, 0.005), "");
  EXPECT_THAT(clockRefusal(bench(), {0.0060, 0.0005}, 0.005),
              HasSubstr("6.0 ms ahead of this one (known to 0.5 ms), allowed 5 ms"));
  EXPECT_THAT(clockRefusal(bench(), {-2, 0.0005}, 0.005), HasSubstr("2000.0 ms behind"));
}

TEST(ClockRefusal, SaysWhenNoTimeOfTheHostWasPossible) {
  EXPECT_THAT(clockRefusal(bench(), {}, 0.005), HasSubstr("found no possible time"));
}

TEST(SshEnds, AreTheFirstAndTheThirdWord) {
  const auto dut = endsOf("10.77.1.1 50022 10.77.2.1 22");
  ASSERT_TRUE(dut);
  EXPECT_EQ(dut->here, "10.77.1.1");
  EXPECT_EQ(dut->there, "10.77.2.1");
  EXPECT_FALSE(endsOf(""));
}

TEST(SshTrouble, NamesTheFix) {
  const auto trouble = [](const char* output, const char* ending = "exit code 255") {
    return sshTrouble(bench(), output, ending);
  };
  EXPECT_THAT(trouble("ssh: Could not resolve hostname robot-bench: Name or service not known\r\n"),
              HasSubstr("hosts.bench.ssh = "));
  EXPECT_THAT(trouble("pi@robot-bench: Permission denied (publickey,password).\r\n"),
              HasSubstr("ssh-copy-id pi@robot-bench [pi@robot-bench: Permission denied"));
  EXPECT_THAT(trouble("Host key verification failed.\r\n"), HasSubstr("ssh pi@robot-bench once"));
  EXPECT_THAT(trouble("@ WARNING: REMOTE HOST IDENTIFICATION HAS CHANGED! @\nHost key verification "
                      "failed.\n"),
              HasSubstr("ssh-keygen -R robot-bench"));
  EXPECT_THAT(trouble("ssh: connect to host robot-bench port 22: Connection refused\r\n"),
              HasSubstr("openssh-server"));
  EXPECT_THAT(trouble("ssh: connect to host robot-bench port 22: Connection timed out\r\n"),
              HasSubstr("is it switched on and connected?"));
  EXPECT_THAT(trouble("bash: line 1: exec: lab: not found\n", "exit code 127"),
              HasSubstr("hosts.bench.programs"));
  EXPECT_THAT(trouble("The following argument was not expected: host-agent\n", "exit code 109"),
              HasSubstr("older version"));
  EXPECT_THAT(trouble("bash: line 1: /x/lab: Permission denied\n", "exit code 126"),
              HasSubstr("cannot be executed"));
  EXPECT_EQ(trouble("", "killed by signal 15"),
            "host bench (ssh pi@robot-bench): ssh ended (killed by signal 15)");
}

TEST(AgentCommand, QuotesTheFolderForTheRemoteShell) {
  HostSpec host = bench();
  EXPECT_EQ(agentCommand(host), "exec lab host-agent");
  host.programs = "/opt/it's a lab/bin";
  EXPECT_EQ(agentCommand(host), "exec '/opt/it'\\''s a lab/bin/lab' host-agent");
  host.programs = "~/lab/bin";
  EXPECT_EQ(agentCommand(host), "exec ~/'lab/bin/lab' host-agent");
}

}  // namespace
}  // namespace lab::runner
