// The controller while a foreign program floods the bus: what it keeps and what it publishes stay
// bounded.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <lab/experiment_event_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/service/node.hpp"
#include "runner/live/experiment_controller.hpp"
#include "tests/support/experiment_samples.hpp"

namespace lab::runner::controller_flood_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

class ExperimentControllerFlood : public testing::Test {
 protected:
  ExperimentControllerFlood() {
    loop_.drainWith([this] { bus_.deliver(); });
    controller_.emplace(ServiceContext{node_, loop_, experiment_, "."},
                        writeExperiment(experiment_),
                        [this](Ending, const std::string& why) { ended_ = why; });
    foreign_.subscribe<robot_stop_t>(channels::kRobotStop, [this](const robot_stop_t& stop) {
      ++stops_;
      if (std::ranges::count(stop.robot_ids, 1) > 0) ++stops_of_robot_;
    });
    foreign_.subscribe<experiment_event_t>(channels::kExperimentEvent,
                                           [this](const auto&) { ++events_; });
    foreign_.subscribe<experiment_status_t>(channels::kExperimentStatus,
                                            [this](const auto& status) {
                                              ++statuses_;
                                              status_ = status;
                                            });
    node_.start();
    controller_->begin();
    loop_.runUntil(loop_.now() + 1'000'000);
  }

  void stop(std::int32_t robot) {
    robot_stop_t message{};
    message.seq = ++seq_;
    message.robot_ids = {robot};
    message.num_robots = 1;
    foreign_.publishCommand(channels::kRobotStop, message);
    bus_.deliver();
  }

  void request(std::int8_t action) {
    experiment_command_t command{};
    command.action = action;
    command.text = "again";
    command.seq = ++seq_;
    foreign_.publishCommand(channels::kExperimentCommand, command);
    bus_.deliver();
  }

  void runFor(std::int64_t time_us) { loop_.runUntil(loop_.now() + time_us); }

  VirtualLoop loop_;
  MemoryBus bus_{[this] { return loop_.now(); }};
  Node node_{bus_, loop_, {"lab", 0, 1}};
  Node foreign_{bus_, loop_, {"foreign", 0, 1}};
  Experiment experiment_ = small();
  std::optional<ExperimentController> controller_;
  std::string ended_;
  std::int64_t seq_ = 0;
  int stops_ = 0;
  int stops_of_robot_ = 0;
  int events_ = 0;
  int statuses_ = 0;
  experiment_status_t status_{};
};

TEST_F(ExperimentControllerFlood, StopsOfRobotsThatDoNotExistAreNotRepeatedOneByOne) {
  stop(1);
  for (std::int32_t id = 1000; id < 4000; ++id) stop(id);
  EXPECT_LE(events_, 3 * 250);
  EXPECT_THAT(controller_->faults(), Contains(HasSubstr("64 robots that are not of this run")));
  EXPECT_THAT(controller_->faults(), Contains(HasSubstr("not each is recorded")));
  stops_ = stops_of_robot_ = 0;

  runFor(1'000'000);

  EXPECT_LE(stops_, 15 * static_cast<int>(StopLatch::kMostMessages) + 16);
  EXPECT_GE(stops_of_robot_, 10) << "the stop of a robot of the run is repeated at 10 Hz";
  EXPECT_THAT(controller_->faults(), SizeIs(2)) << "each is said once";
}

TEST_F(ExperimentControllerFlood, RequestsAreLimitedButTheRunCanBeEnded) {
  events_ = statuses_ = 0;
  for (int i = 0; i < 3000; ++i) request(experiment_command_t::MARK);
  EXPECT_LE(events_, 3 * 200);
  EXPECT_LE(statuses_, 500);
  runFor(600'000);
  EXPECT_THAT(status_.refusal, HasSubstr("too many requests: more than 200 in 10 s"));

  request(experiment_command_t::END);
  EXPECT_EQ(ended_, "ended by foreign: again");
}

TEST_F(ExperimentControllerFlood, MarksAreTakenAgainAfterwards) {
  for (int i = 0; i < 3000; ++i) request(experiment_command_t::MARK);
  runFor(10'000'000);
  events_ = 0;
  request(experiment_command_t::MARK);
  EXPECT_EQ(events_, 3);
}

TEST_F(ExperimentControllerFlood, RobotsThatAreNotOfTheRunAreForgottenBeyondABound) {
  tracked_frame_t frame{};
  frame.robots.resize(1);
  frame.num_robots = 1;
  for (std::int32_t id = 10; id < 5000; ++id) {
    frame.utime = loop_.now();
    frame.robots[0].robot_id = id;
    foreign_.publish(channels::kTrackedFrame, frame);
    bus_.deliver();
  }
  frame.robots[0].robot_id = 1;
  foreign_.publish(channels::kTrackedFrame, frame);
  bus_.deliver();

  EXPECT_THAT(controller_->lastPoses(), SizeIs(1001));
  EXPECT_TRUE(controller_->lastPoses().contains(1));
  EXPECT_THAT(controller_->faults(), ElementsAre(HasSubstr("more than 1000 robots")));
}

TEST_F(ExperimentControllerFlood, ErrorsOfServicesAreRecordedUpToABound) {
  service_status_t status{};
  for (int i = 0; i < 3000; ++i) {
    status.last_error = "problem " + std::to_string(i);
    foreign_.publish(channels::kServiceStatus, status);
    bus_.deliver();
  }
  EXPECT_THAT(controller_->faults(), SizeIs(1001));
  EXPECT_THAT(controller_->faults().back(), HasSubstr("more than 1000 different errors"));
}

/// Each is sent three times.
TEST_F(ExperimentControllerFlood, LongTextsOfOthersAreRecordedUpToTheirBeginning) {
  std::vector<std::string> texts;
  Node reader(bus_, loop_, {"reader", 0, 1});
  reader.subscribe<experiment_event_t>(channels::kExperimentEvent, [&](const auto& event) {
    const bool has_text =
        event.kind == experiment_event_t::FAULT || event.kind == experiment_event_t::MARK;
    if (has_text) texts.push_back(event.text);
  });
  service_status_t status{};
  for (const char letter : {'a', 'b'}) {
    // Another end would be another error.
    status.last_error = std::string(100'000, 'x') + letter;
    foreign_.publish(channels::kServiceStatus, status);
  }
  robot_stop_t message{};
  message.seq = ++seq_;
  message.reason.assign(8'000'000, 'r');
  foreign_.publishCommand(channels::kRobotStop, message);
  bus_.deliver();

  EXPECT_THAT(texts, SizeIs(6));
  for (const std::string& text : texts) EXPECT_THAT(text, SizeIs(3000));
  EXPECT_THAT(texts.front(), HasSubstr("foreign: xxx"));
  EXPECT_THAT(texts.back(), HasSubstr("robots stopped by foreign: rrr"));
  EXPECT_THAT(controller_->faults(), ElementsAre(SizeIs(3000)));
}

}  // namespace
}  // namespace lab::runner::controller_flood_test
