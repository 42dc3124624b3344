#include "runner/hosts/host_files.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "common/files/certificate_folder.hpp"
#include "tests/support/experiment_samples.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner {
namespace {

TEST(HostFiles, HaveEveryPartOfARecording) {
  const TemporaryFolder folder;
  for (const char* name : {"log.lcmlog", "log.lcmlog.01", "log.lcmlog.02", "other.lcmlog"}) {
    std::ofstream(folder / name) << name;
  }
  Experiment experiment = small();
  experiment.robots.front().log = "log.lcmlog";
  experiment.robots.push_back(experiment.robots.front());

  const std::vector<HostFile> dut = filesFor(experiment, folder.path());

  ASSERT_EQ(dut.size(), 3U);
  const std::string there = experimentElsewhere(experiment).robots.front().log;
  EXPECT_EQ(experimentElsewhere(experiment).robots.back().log, there) << "once for all robots";
  EXPECT_EQ(dut[0].path, there);
  EXPECT_EQ(dut[1].path, there + ".01");
  EXPECT_EQ(dut[2].path, there + ".02");
  EXPECT_EQ(dut[2].source, folder / "log.lcmlog.02");
}

// checkCertificates() does not look into the others.
TEST(HostFiles, HaveTheCertificatesThatAreRead) {
  const TemporaryFolder folder;
  for (const std::string_view file : kSecurityFiles) support::writeFile(folder.path() / file, "x");
  Experiment experiment =
      small("[link]\nsecurity = \"keys\"\n[services.sim_svc]\nhost = \"me@bench\"\n");
  experiment.link.security = experiment.gateway.security = ".";

  EXPECT_EQ(filesFor(experiment, folder.path()).size(), kSecurityFiles.size());
  experiment.gateway.ros = true;
  EXPECT_EQ(filesFor(experiment, folder.path()).size(), 2 * kSecurityFiles.size());
  experiment.link.join = JoinBy::kMulticast;
  EXPECT_EQ(filesFor(experiment, folder.path()).size(), kSecurityFiles.size());
  experiment.gateway.ros = false;
  EXPECT_EQ(filesFor(experiment, folder.path()).size(), 0U);
}

}  // namespace
}  // namespace lab::runner
