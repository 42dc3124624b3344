// Folders and devices that a file of a stranger names are refused by `lab check` and before a run.
#include "runner/runs/place_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "common/files/certificate_folder.hpp"
#include "runner/runs/run_directory.hpp"
#include "tests/support/experiment_samples.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner::place_checks_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string refusalBy(const std::function<void()>& check) {
  try {
    check();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

class PlaceChecks : public testing::Test {
 protected:
  /// The refusal of `lab check`, which is that of prepareRun().
  [[nodiscard]] std::string refusalOf(const Experiment& experiment) const {
    return refusalBy([&] { checkFiles(experiment, folder_.path()); });
  }
  [[nodiscard]] std::string refusalOfRun(const Experiment& experiment) const {
    return refusalBy([&] { requireCertificates(experiment, folder_.path()); });
  }

  TemporaryFolder folder_;
};

/// An experiment with a service on another host.
Experiment onTwoHosts() {
  return small("[link]\nsecurity = \"keys\"\n[services.sim_svc]\nhost = \"me@bench\"\n");
}

TEST_F(PlaceChecks, ReadTheFoldersOfCertificates) {
  for (const std::string_view file : kSecurityFiles) {
    support::writeFile(folder_ / "keys" / file, "x");
  }
  Experiment linked = onTwoHosts();
  Experiment gateway = small("[gateway]\nros = true\naddress = \"127.0.0.1\"\n");
  gateway.gateway.security = "keys";
  EXPECT_EQ(refusalOf(linked), "accepted");
  EXPECT_EQ(refusalOf(gateway), "accepted");

  support::writeFile(folder_ / "secret", "password");
  fs::remove(folder_ / "keys/key.pem");
  fs::create_symlink("../secret", folder_ / "keys/key.pem");

  EXPECT_THAT(refusalOf(linked), AllOf(StartsWith("link.security: "), HasSubstr("found a link")));
  EXPECT_THAT(refusalOf(gateway),
              AllOf(StartsWith("gateway.security: "), HasSubstr("found a link")));
  EXPECT_THAT(refusalOfRun(linked), HasSubstr("found a link"));
  EXPECT_THROW((void)prepareRun(linked, folder_.path(), folder_ / "runs", 0), std::exception);
  EXPECT_FALSE(fs::exists(folder_ / "runs"));

  linked.link.join = JoinBy::kMulticast;
  EXPECT_EQ(refusalOf(linked), "accepted") << "no gateway reads it";
  gateway.gateway.ros = false;
  EXPECT_EQ(refusalOf(gateway), "accepted") << "no gateway reads it";
}

TEST_F(PlaceChecks, AcceptAFileWithoutTheCertificatesButNoRunOfIt) {
  Experiment experiment = onTwoHosts();
  EXPECT_EQ(refusalOf(experiment), "accepted");
  EXPECT_THAT(refusalOfRun(experiment),
              AllOf(StartsWith("link.security: "), HasSubstr("keys: not found, expected")));
  experiment.services.clear();
  EXPECT_EQ(refusalOfRun(experiment), "accepted") << "nothing is linked";
  experiment.gateway.security = "keys";
  EXPECT_EQ(refusalOfRun(experiment), "accepted") << "there is no ROS 2";
  experiment.gateway.ros = true;
  EXPECT_THAT(refusalOfRun(experiment), StartsWith("gateway.security: "));

  experiment.gateway.security = "a<b";
  EXPECT_THAT(refusalOf(experiment), AllOf(StartsWith("gateway.security: "), HasSubstr("rename")));
}

TEST_F(PlaceChecks, RefuseOtherDevicesThanSerialLines) {
  Experiment experiment = small();
  experiment.serial.ports = "/dev/null";
  EXPECT_EQ(refusalOf(experiment), "accepted") << "no robot is real";
  experiment.robots[0].body = Body::kSerial;
  EXPECT_THAT(refusalOf(experiment),
              AllOf(StartsWith("serial.ports: found \"/dev/null\""), HasSubstr("/dev/ttyUSB*")));
  experiment.serial.ports = "/dev/line-of-another-machine /dev/ttyUSB*";
  EXPECT_EQ(refusalOf(experiment), "accepted");
  experiment.serial.ports = "/dev/null";
  experiment.services["robot_bridge"] = {"robot_bridge", "bench"};
  EXPECT_EQ(refusalOf(experiment), "accepted") << "the devices are those of another host";
}

TEST_F(PlaceChecks, RefuseOtherDevicesThanCameras) {
  Experiment experiment = small();
  experiment.camera.source = "/dev/null";
  EXPECT_EQ(refusalOf(experiment), "accepted") << "nothing reads a camera";
  const auto refusal = [&] { return refusalBy([&] { checkDevices(experiment); }); };
  experiment.camera.tracker = Tracker::kCamera;
  EXPECT_THAT(refusal(), StartsWith("camera.camera: found \"/dev/null\""));
  for (const char* source : {"sim", "pipeline", "/dev/video-of-another-machine"}) {
    experiment.camera.source = source;
    EXPECT_EQ(refusal(), "accepted") << source;
  }
  experiment.cameras.resize(2);
  experiment.cameras[1].source = "/dev/null";
  EXPECT_THAT(refusal(), StartsWith("cameras[1].camera: found \"/dev/null\""));
  experiment.services["tracker_svc"] = {"tracker_svc", "bench"};
  EXPECT_EQ(refusal(), "accepted") << "the devices are those of another host";
}

}  // namespace
}  // namespace lab::runner::place_checks_test
