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

TEST(ServicePlacement, OnlyWhatNothingDependsOnIsDispensable) {
  Experiment experiment = withBody(Body::kSim);
  experiment.gateway.ros = true;
  EXPECT_TRUE(isDispensable(experiment, "analyzer"));
  EXPECT_TRUE(isDispensable(experiment, "dds_gateway"));
  EXPECT_TRUE(isDispensable(experiment, "dashboard"));
  for (const char* service :
       {"sim_svc", "robot_bridge", "projector_ctl", "tracker_svc", "recorder"}) {
    EXPECT_FALSE(isDispensable(experiment, service)) << service;
  }

  experiment.gateway.commands = true;
  EXPECT_FALSE(isDispensable(experiment, "dds_gateway")) << "robots are driven from ROS 2";
  experiment.gateway.commands = false;
  experiment.services["sim_svc"].host = "bench";
  EXPECT_FALSE(isDispensable(experiment, "dds_gateway")) << "it joins the buses";
  experiment.stop_when.resize(1);
  EXPECT_FALSE(isDispensable(experiment, "analyzer")) << "its estimates end the run";
}

}  // namespace
}  // namespace lab::service_placement_test
