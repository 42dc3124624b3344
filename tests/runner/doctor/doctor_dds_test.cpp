#include "runner/doctor/doctor_dds.hpp"

#include <gmock/gmock.h>

namespace lab::runner::doctor_dds_test {
namespace {

using testing::HasSubstr;
using Level = Finding::Level;

const DdsEndpoint kWriter{
    .writer = true, .topic = "rt/lab/robot1/pose", .type = "PoseStamped_", .reliable = true};
const DdsEndpoint kReader{
    .writer = false, .topic = "rt/lab/robot1/pose", .type = "PoseStamped_", .reliable = true};

std::vector<Finding> findingsOf(std::vector<DdsEndpoint> endpoints) {
  DdsFacts facts;
  facts.endpoints = std::move(endpoints);
  facts.participants = 2;
  return judgeDds(facts);
}

TEST(DoctorDds, CountsParticipantsWritersAndReaders) {
  const auto found = findingsOf({kWriter, kReader, kReader});

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].level, Level::kOk);
  EXPECT_EQ(found[0].what, "DDS domain 0: 2 participants, 1 writers, 2 readers");
}

TEST(DoctorDds, ReportsIncompatibleWritersAndReaders) {
  DdsEndpoint best_effort = kWriter;
  best_effort.reliable = false;
  DdsEndpoint latched = kReader;
  latched.latched = true;
  DdsEndpoint other_type = kReader;
  other_type.type = "String_";

  EXPECT_THAT(findingsOf({best_effort, kReader}).at(1).what,
              HasSubstr("rt/lab/robot1/pose does not match a writer: the writer is best effort"));
  EXPECT_THAT(findingsOf({kWriter, latched}).at(1).what, HasSubstr("wants transient local"));
  EXPECT_THAT(findingsOf({kWriter, other_type}).at(1).what, HasSubstr("the reader's String_"));
  EXPECT_THAT(findingsOf({best_effort, kReader}).at(1).fix, HasSubstr("/lab/robot1/pose"));
  EXPECT_EQ(findingsOf({best_effort, kReader, kReader}).size(), 2U) << "reported once";
}

TEST(DoctorDds, IgnoresCompatibleReadersAndOtherTopics) {
  DdsEndpoint best_effort = kReader;
  best_effort.reliable = false;
  DdsEndpoint elsewhere = kReader;
  elsewhere.topic = "rt/other";
  elsewhere.type = "String_";

  EXPECT_EQ(findingsOf({kWriter, best_effort, elsewhere}).size(), 1U);
}

// The lab reads commands in two types, so a writer of either type is received.
TEST(DoctorDds, AParticipantThatReadsTwoTypesMatchesBoth) {
  const DdsEndpoint teleop{.writer = true,
                           .topic = "rt/lab/robot1/cmd_vel",
                           .type = "Twist_",
                           .reliable = true,
                           .owner = "teleop"};
  const DdsEndpoint plain{.writer = false,
                          .topic = "rt/lab/robot1/cmd_vel",
                          .type = "Twist_",
                          .reliable = true,
                          .owner = "lab"};
  DdsEndpoint stamped = plain;
  stamped.type = "TwistStamped_";
  EXPECT_EQ(findingsOf({teleop, plain, stamped}).size(), 1U);

  DdsEndpoint elsewhere = stamped;  // of another participant: not matched
  elsewhere.owner = "echo";
  const auto found = findingsOf({teleop, plain, stamped, elsewhere});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_THAT(found[1].what, HasSubstr("the writer's type is Twist_, the reader's TwistStamped_"));

  DdsEndpoint text = teleop;  // neither of the two types
  text.type = "String_";
  EXPECT_EQ(findingsOf({text, plain, stamped}).size(), 3U);
}

TEST(DoctorDds, MentionsDdsSecurity) {
  DdsFacts facts;
  facts.secured = true;
  EXPECT_THAT(judgeDds(facts).at(0).what, HasSubstr("secured"));
}

TEST(DoctorDds, UsesTheConfigurationOfTheGateway) {
  Gateway gateway;
  gateway.configuration = "no_such.xml";
  EXPECT_THAT(surveyDds(gateway, "/nowhere", 0).problem,
              HasSubstr("/nowhere/no_such.xml: cannot be read"));
}

TEST(DoctorPorts, NamesPortsInUse) {
  const auto all_free = [](int) { return true; };
  const auto none_free = [](int) { return false; };
  Experiment experiment;
  EXPECT_TRUE(judgePorts(experiment, none_free, none_free).empty()) << "any port will do, no ROS 2";

  experiment.network.port = 23456;
  experiment.gateway.ros = true;
  experiment.gateway.domain = 3;
  EXPECT_TRUE(judgePorts(experiment, all_free, all_free).empty());
  const auto found = judgePorts(experiment, none_free, none_free);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].level, Level::kWarning);
  EXPECT_THAT(found[0].what, HasSubstr("UDP port 23456 (network.port) is in use"));
  EXPECT_THAT(found[0].fix, HasSubstr("another network.port"));
  // 7400 + 250 * domain, the first port of the domain.
  EXPECT_THAT(found[1].what, HasSubstr("UDP port 8150 (gateway.domain = 3) is in use"));
  EXPECT_THAT(found[1].fix, HasSubstr("another gateway.domain"));
}

TEST(DoctorDds, ReportsWhyADomainCannotBeJoined) {
  DdsFacts facts;
  facts.problem = "no free participant index";

  const auto found = judgeDds(facts);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].level, Level::kWarning);
  EXPECT_THAT(found[0].what, HasSubstr("no free participant index"));
}

}  // namespace
}  // namespace lab::runner::doctor_dds_test
