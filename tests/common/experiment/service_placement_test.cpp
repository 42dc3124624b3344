#include "common/experiment/service_placement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/experiment/experiment.hpp"

namespace lab::service_placement_test {
namespace {

using testing::ElementsAre;

Experiment withBody(Body body) {
  Experiment experiment;
  experiment.robots.resize(1);
  experiment.robots[0].body = body;
  experiment.camera.tracker = Tracker::kSimPoses;
  return experiment;
}

TEST(ServicePlacement, NamesOnlyTheServicesThatTheExperimentNeeds) {
  Experiment experiment = withBody(Body::kSerial);
  EXPECT_THAT(neededServices(experiment), ElementsAre("analyzer", "projector_ctl", "robot_bridge"));

  experiment.camera.tracker = Tracker::kCamera;
  experiment.gateway.ros = true;
  EXPECT_THAT(neededServices(experiment), ElementsAre("analyzer", "projector_ctl", "robot_bridge",
                                                      "tracker_svc", "dds_gateway"));

  EXPECT_THAT(neededServices(withBody(Body::kFirmware)),
              ElementsAre("analyzer", "projector_ctl", "robot_bridge", "sim_svc"));
}

TEST(ServicePlacement, OnlyHostsOfNeededServicesAreInUse) {
  Experiment experiment = withBody(Body::kSerial);
  experiment.services["robot_bridge"].host = "bench";
  experiment.services["sim_svc"].host = "idle";

  EXPECT_THAT(hostsInUse(experiment), ElementsAre("bench"));
}

}  // namespace
}  // namespace lab::service_placement_test
