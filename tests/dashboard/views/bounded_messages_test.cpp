/// Messages of any size that the bus carries: what the page keeps and shows of them.
#include "dashboard/views/bounded_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/experiment_event_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/light_delivery_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/link_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"
#include "dashboard/views/lab_view.hpp"
#include "dashboard/web/hub.hpp"
#include "tests/dashboard/message_samples.hpp"

namespace lab::dashboard::bounded_messages_test {
namespace {

using testing::SizeIs;

template <class Part>
void fill(std::vector<Part>& list, std::int32_t& size, std::size_t count, const Part& part = {}) {
  list.assign(count, part);
  size = static_cast<std::int32_t>(count);
}

class LargeMessages : public testing::Test {
 protected:
  LargeMessages() {
    experiment_event_t start{};
    start.kind = experiment_event_t::START;
    start.text = writeExperiment(experimentForTests());
    send(channels::kExperimentEvent, start);
  }

  template <class Message>
  void send(std::string_view channel, Message message) {
    message.sender = "lab";
    message.instance = 1;
    message.utime = kNow;
    const auto data = encode(message);
    dut_.take({channel, data, kNow}, kNow);
  }

  Json topic(std::string_view name) {
    dut_.publishMoving(kNow + kSecond, true);
    dut_.publishTotals(kNow + kSecond, {});
    const Hub::Text text = hub_.newest(name);
    return text ? Json::parse(*text) : Json();
  }

  /// Bytes of all topics.
  std::size_t published() {
    static_cast<void>(topic("health"));
    std::size_t sum = 0;
    std::uint64_t seen = 0;
    for (const auto& change : hub_.changesSince(seen, std::chrono::milliseconds(0))) {
      sum += change.text->size();
    }
    return sum;
  }

  const std::string long_ = std::string(200'000, 'x');
  Hub hub_;
  LabView dut_{hub_, "dashboard", 9, [](const auto&, const auto&) { return light::ImageStore{}; }};
};

TEST_F(LargeMessages, ResultsWithCurvesWithoutEndAreNotDecoded) {
  analysis_t analysis = poolOf("swim", kNow);
  fill(analysis.curves, analysis.num_curves, 100'000);
  send(channels::kAnalysis, analysis);
  collective_t collective{};
  fill(collective.observables, collective.num_observables, 100'000);
  send(channels::kCollective, collective);

  EXPECT_EQ(topic("health")["not_understood"],
            Json::parse(R"([{"channel": "ANALYSIS", "messages": 1},
                            {"channel": "COLLECTIVE", "messages": 1}])"));
  EXPECT_TRUE(topic("pool/swim").is_null());
  EXPECT_TRUE(topic("crowd").is_null());
}

TEST_F(LargeMessages, ListsAreShownUpToABound) {
  analysis_t analysis = poolOf("swim", kNow);
  fill(analysis.curves, analysis.num_curves, 1000);
  fill(analysis.estimates, analysis.num_estimates, 200);
  send(channels::kAnalysis, analysis);
  collective_t collective{};
  fill(collective.observables, collective.num_observables, 1000);
  fill(collective.curves, collective.num_curves, 1000);
  fill(collective.members, collective.num_members, 5000);
  send(channels::kCollective, collective);
  link_status_t link{};
  link.host = "here";
  fill(link.peers, link.num_peers, 2000);
  send(channels::kLinkStatus, link);

  EXPECT_THAT(topic("pool/swim")["curves"], SizeIs(kMostCurves));
  EXPECT_THAT(topic("pool/swim")["estimates"], SizeIs(kMostEstimates));
  EXPECT_THAT(topic("crowd")["observables"], SizeIs(kMostObservables));
  EXPECT_THAT(topic("crowd")["curves"], SizeIs(kMostCurves));
  EXPECT_THAT(topic("crowd")["members"], SizeIs(kMostMembers));
  EXPECT_THAT(topic("health")["links"], SizeIs(kMostPeers));
  EXPECT_TRUE(topic("health")["not_understood"].empty());
}

/// The topic `stop` is built 40 times a second.
TEST_F(LargeMessages, AStopWithAReasonOfMegabytesIsShownWithItsBeginning) {
  robot_stop_t stop{};
  stop.reason.assign(8'000'000, 'x');
  stop.seq = 7;
  fill(stop.robot_ids, stop.num_robots, 1'000'000, 3);
  send(channels::kRobotStop, stop);

  EXPECT_EQ(topic("stop")["state"], "stopping");
  EXPECT_THAT(topic("stop")["reason"].get<std::string>(), SizeIs(kLongestText));
  EXPECT_EQ(topic("stop")["unconfirmed"], Json({3, 7})) << "a million robots are every robot";
}

TEST_F(LargeMessages, TextsAreShownUpToABound) {
  const std::size_t before = published();
  service_status_t service{};
  service.state = service_status_t::FAULT;
  service.host = service.version = long_.substr(0, 50'000);
  service.last_error = long_.substr(0, 50'000);
  send(channels::kServiceStatus, service);
  tracker_status_t tracker{};
  tracker.camera = tracker.trouble = tracker.warning = long_.substr(0, 50'000);
  send(channels::kTrackerStatus, tracker);
  light_status_t light{};
  light.label = light.commander = light.display = light.trouble = long_.substr(0, 50'000);
  send(channels::kLightStatus, light);
  light_delivery_t delivery{};
  light_delay_t delay{};
  delay.until = long_;
  fill(delivery.delays, delivery.num_delays, 1, delay);
  send(channels::kLightDelivery, delivery);
  experiment_status_t status{};
  status.phase = experiment_status_t::SCRIPT;
  status.label = status.stop = status.run = long_.substr(0, 50'000);
  send(channels::kExperimentStatus, status);
  experiment_event_t event{};
  event.text = event.label = event.ended_by = long_;
  for (const std::int8_t kind : {experiment_event_t::STEP, experiment_event_t::MARK,
                                 experiment_event_t::FAULT, experiment_event_t::END}) {
    event.kind = kind;
    send(channels::kExperimentEvent, event);
  }
  robot_state_t robot = stateOf(3);
  robot.program.hash = 5;
  robot.program.name = long_;
  send(channels::kRobotStatus, statusOf({robot}));
  analysis_t analysis = poolOf("swim", kNow);
  analysis.estimates[0].note = analysis.estimates[0].unit = long_.substr(0, 10'000);
  send(channels::kAnalysis, analysis);
  collective_t collective{};
  observable_t observable{};
  observable.name = observable.unit = long_.substr(0, 50'000);
  fill(collective.observables, collective.num_observables, 1, observable);
  send(channels::kCollective, collective);

  EXPECT_TRUE(topic("health")["not_understood"].empty());
  EXPECT_THAT(topic("health")["services"][0]["last_error"].get<std::string>(),
              SizeIs(kLongestText));
  EXPECT_THAT(topic("timeline")["marks"][0]["text"].get<std::string>(), SizeIs(kLongestText));
  // 30 texts, some of which two topics have.
  EXPECT_LT(published(), before + 50 * kLongestText);
}

TEST(BoundedMessages, KeepTheExperimentFileAndCountTheirLists) {
  experiment_event_t start{};
  start.kind = experiment_event_t::START;
  start.text.assign(1'000'000, 'x');
  bound(start);
  EXPECT_THAT(start.text, SizeIs(1'000'000));

  service_status_t service{};
  stream_count_t stream{};
  stream.sender.assign(1000, 'x');
  fill(service.received, service.num_received, 5000, stream);
  bound(service);
  EXPECT_THAT(service.received, SizeIs(kMostCounts));
  EXPECT_EQ(service.num_received, static_cast<std::int32_t>(kMostCounts));
  EXPECT_THAT(service.received[0].sender, SizeIs(63));
  EXPECT_GT(encode(service).size(), 63 * kMostCounts) << "LCM trusts the counts";
}

}  // namespace
}  // namespace lab::dashboard::bounded_messages_test
