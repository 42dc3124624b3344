#include "runner/doctor_dds.hpp"

#include <gmock/gmock.h>

namespace lab::runner {
namespace {

using testing::HasSubstr;
using Level = Finding::Level;

const DdsEndpoint kWriter{true, "rt/lab/robot1/pose", "PoseStamped_", true, false};
const DdsEndpoint kReader{false, "rt/lab/robot1/pose", "PoseStamped_", true, false};

std::vector<Finding> findingsOf(std::vector<DdsEndpoint> endpoints) {
  DdsFacts facts;
  facts.endpoints = std::move(endpoints);
  facts.participants = 2;
  return judgeDds(facts);
}

TEST(DoctorOfDds, CountsWhoIsThere) {
  const auto found = findingsOf({kWriter, kReader, kReader});

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].level, Level::kOk);
  EXPECT_EQ(found[0].what, "DDS domain 0: 2 participants, 1 writers, 2 readers");
}

TEST(DoctorOfDds, NamesWhatDoesNotFit) {
  DdsEndpoint best_effort = kWriter;
  best_effort.reliable = false;
  DdsEndpoint late = kReader;
  late.latched = true;
  DdsEndpoint other_type = kReader;
  other_type.type = "String_";

  EXPECT_THAT(findingsOf({best_effort, kReader}).at(1).what,
              HasSubstr("rt/lab/robot1/pose hears nothing of a writer: it is best effort"));
  EXPECT_THAT(findingsOf({kWriter, late}).at(1).what, HasSubstr("wanted transient local"));
  EXPECT_THAT(findingsOf({kWriter, other_type}).at(1).what, HasSubstr("wanted String_"));
  EXPECT_THAT(findingsOf({best_effort, kReader}).at(1).fix, HasSubstr("/lab/robot1/pose"));
  EXPECT_EQ(findingsOf({best_effort, kReader, kReader}).size(), 2U) << "said once";
}

TEST(DoctorOfDds, LeavesAloneWhatFitsAndWhatIsOfAnotherTopic) {
  DdsEndpoint modest = kReader;
  modest.reliable = false;
  DdsEndpoint elsewhere = kReader;
  elsewhere.topic = "rt/other";
  elsewhere.type = "String_";

  EXPECT_EQ(findingsOf({kWriter, modest, elsewhere}).size(), 1U);
}

TEST(DoctorOfDds, SaysWhyADomainCannotBeEntered) {
  DdsFacts facts;
  facts.problem = "no free participant index";

  const auto found = judgeDds(facts);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].level, Level::kWarning);
  EXPECT_THAT(found[0].what, HasSubstr("no free participant index"));
}

}  // namespace
}  // namespace lab::runner
