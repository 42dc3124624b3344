/// Tests DashboardBus in virtual time, RequestQueue between threads, and the address file.
#include "dashboard/dashboard_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/loop/virtual_loop.hpp"
#include "dashboard/web/address_file.hpp"
#include "tests/dashboard/message_samples.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::dashboard::dashboard_bus_test {
namespace {

using testing::HasSubstr;

/// A dashboard and a service whose two robots obey stops unless it is deaf.
struct Bench {
  Bench() {
    loop.drainWith([this] { bus.deliver(); });
    node.start();
    owner.start();
    owner.subscribe<robot_stop_t>(channels::kRobotStop, [this](const robot_stop_t& stop) {
      ++stops;
      if (deaf) return;
      for (robot_state_t& robot : robots) {
        robot.stop_seq = stop.seq;
        robot.flags = stop.clear != 0 ? 0 : robot_state_t::FLAG_STOPPED;
      }
    });
    owner.subscribe<light_command_t>(
        channels::kLightCommand, [this](const light_command_t& light) { lights.push_back(light); });
    loop.every(50'000, loop.now(), [this] {
      robot_status_t status = statusOf(robots);
      status.utime = 0;
      owner.publish(channels::kRobotStatus, status);
    });
  }

  void run(double seconds) { loop.runUntil(loop.now() + static_cast<std::int64_t>(seconds * 1e6)); }
  Json topic(const char* name) {
    const Hub::Text text = hub.newest(name);
    return text ? Json::parse(*text) : Json();
  }

  VirtualLoop loop;
  MemoryBus bus{[this] { return loop.now(); }};
  Node node{bus, loop, {"dashboard", 0, 9}};
  Node owner{bus, loop, {"sim_svc", 2, 1}};
  std::vector<robot_state_t> robots{stateOf(3), stateOf(7)};
  int stops = 0;
  bool deaf = false;
  std::vector<light_command_t> lights;
  Experiment none;
  ServiceContext context{node, loop, none, ""};
  Hub hub;
  DashboardBus dut{
      context, hub, "runs", {.viewers = [] { return 1; }, .facts = [] { return ServerFacts{}; }}};
};

TEST(DashboardBus, AStopReachesEveryRobotWithin200msAndItsTopicShowsTheConfirmations) {
  Bench bench;
  bench.run(1);
  const std::int64_t begin = bench.loop.now();
  ASSERT_EQ(bench.dut.request(StopRobots{"test"}), "");
  while (bench.topic("stop")["state"] != "stopped") {
    bench.run(0.005);
    ASSERT_LT(bench.loop.now() - begin, 200'000);
  }
  EXPECT_EQ(bench.topic("stop")["confirmed"], 2);
  EXPECT_LE(bench.topic("stop")["took_ms"].get<double>(), 50);
  bench.run(1);
  const int stops = bench.stops;
  EXPECT_LE(stops, 4) << "at 10 Hz for 0.3 s";
  bench.run(5);
  EXPECT_EQ(bench.stops, stops) << "not repeated after all robots have confirmed";
  ASSERT_EQ(bench.dut.request(ReleaseStop{}), "");
  bench.run(0.2);
  EXPECT_EQ(bench.topic("stop")["state"], "free");
  EXPECT_EQ(bench.robots[0].flags, 0);
}

// A replay starts the page in this way: the run may be a stranger's.
TEST(DashboardOptions, ForThisMachineOnlyLeaveOpeningThePageToNoFile) {
  Bench bench;
  Experiment experiment;
  experiment.dashboard.address = "0.0.0.0";
  experiment.dashboard.control_from_elsewhere = true;
  experiment.camera.debug_port = 8081;
  const ServiceContext context{bench.node, bench.loop, experiment, ""};
  DashboardOptions options;
  const WebOptions open = webOptions(context, options);
  EXPECT_EQ(open.address, "0.0.0.0");
  EXPECT_TRUE(open.control_from_elsewhere);
  EXPECT_EQ(open.camera_port, 8081);

  options.this_machine_only = true;
  const WebOptions dut = webOptions(context, options);

  EXPECT_EQ(dut.address, "127.0.0.1");
  EXPECT_FALSE(dut.control_from_elsewhere);
  EXPECT_EQ(dut.camera_port, 0);
}

TEST(DashboardBus, RepeatsAStopThatARobotDoesNotConfirm) {
  Bench bench;
  bench.deaf = true;
  bench.run(1);
  ASSERT_EQ(bench.dut.request(StopRobots{}), "");
  bench.run(10);
  EXPECT_NEAR(bench.stops, 100, 2);
  EXPECT_EQ(bench.topic("stop")["state"], "stopping");
  EXPECT_EQ(bench.topic("stop")["unconfirmed"], Json({3, 7}));
}

TEST(DashboardBus, RefreshesManualLightAtTwoHertzAndReleasesIt) {
  Bench bench;
  ASSERT_EQ(bench.dut.request(ShowLight{0.5, 3}), "");
  bench.run(2.9);
  EXPECT_EQ(bench.lights.size(), 6U);
  bench.run(3);
  ASSERT_EQ(bench.lights.size(), 9U);
  EXPECT_EQ(bench.lights.back().release, 1);
  EXPECT_GT(bench.lights.back().utime, bench.lights.front().utime);
}

TEST(DashboardBus, ReportsReceivedMessagesInTheHeartbeatButNoErrors) {
  Bench bench;
  service_status_t last{};
  bench.owner.subscribe<service_status_t>(channels::kServiceStatus,
                                          [&last](const service_status_t& status) {
                                            if (status.sender == "dashboard") last = status;
                                          });
  const std::vector<std::uint8_t> junk{1, 2, 3};
  bench.bus.publish(channels::kLightStatus, junk);
  bench.run(3.5);
  bool received = false;
  for (const stream_count_t& row : last.received) {
    if (row.channel == channels::kRobotStatus) received = row.received >= 40;
  }
  EXPECT_TRUE(received);
  EXPECT_EQ(last.last_error, "") << "an error here would mark the run";
}

std::optional<std::string> nothing(std::string_view, std::string_view) { return std::nullopt; }

TEST(RequestQueue, CallsHandlersOnTheLoopsThread) {
  const auto loop_thread = std::this_thread::get_id();
  std::thread::id answered;
  RequestQueue dut({.request =
                        [&](const OperatorRequest&) {
                          answered = std::this_thread::get_id();
                          return std::string("no");
                        },
                    .query =
                        [](std::string_view what, std::string_view which) {
                          return std::optional(std::string(what) + "/" + std::string(which));
                        }});
  std::string refusal;
  std::optional<std::string> answer;
  std::thread web([&] {
    refusal = dut.request(PauseScript{});
    answer = dut.query("a", "b");
  });
  for (int served = 0; served < 2; ++served) {
    pollfd waiting{dut.descriptor(), POLLIN, 0};
    ASSERT_EQ(poll(&waiting, 1, 5000), 1);
    dut.serve();
  }
  web.join();
  EXPECT_EQ(refusal, "no");
  EXPECT_EQ(answer, "a/b");
  EXPECT_EQ(answered, loop_thread);
}

TEST(RequestQueue, ARequestWaitsForAtMostOneQuery) {
  std::string order;
  RequestQueue dut({.request =
                        [&](const OperatorRequest&) {
                          order += 'r';
                          return std::string();
                        },
                    .query =
                        [&](std::string_view, std::string_view) {
                          order += 'q';
                          return std::optional<std::string>("");
                        }},
                   std::chrono::seconds(20));
  std::vector<std::thread> web;
  eventfd_t rings = 0;
  const auto waitFor = [&](eventfd_t count) {
    while (rings < count) {
      eventfd_t more = 0;
      if (eventfd_read(dut.descriptor(), &more) == 0) rings += more;
      std::this_thread::yield();
    }
  };
  for (eventfd_t i = 1; i <= 3; ++i) {
    web.emplace_back([&] { static_cast<void>(dut.query("a", "b")); });
    waitFor(i);
  }
  web.emplace_back([&] { EXPECT_EQ(dut.request(StopRobots{}), ""); });
  waitFor(4);
  dut.serve();
  EXPECT_EQ(order, "rq");
  pollfd waiting{dut.descriptor(), POLLIN, 0};
  for (int served = 0; served < 2; ++served) {
    EXPECT_EQ(poll(&waiting, 1, 0), 1) << "more queries are pending";
    dut.serve();
  }
  EXPECT_EQ(poll(&waiting, 1, 0), 0);
  for (std::thread& thread : web) thread.join();
  EXPECT_EQ(order, "rqqq");
}

TEST(RequestQueue, DoesNotRunRequestsAfterTheirTimeout) {
  int done = 0;
  RequestQueue dut({.request =
                        [&](const OperatorRequest&) {
                          ++done;
                          return std::string();
                        },
                    .query = nothing},
                   std::chrono::milliseconds(20));
  EXPECT_THAT(dut.request(StopRobots{}), HasSubstr("nothing was done"));
  dut.serve();
  EXPECT_EQ(done, 0);
}

TEST(RequestQueue, RefusesAtOnceWhenClosed) {
  RequestQueue dut(
      {.request = [](const OperatorRequest&) { return std::string(); }, .query = nothing},
      std::chrono::hours(1));
  std::string refusal;
  std::thread web([&] { refusal = dut.request(PauseScript{}); });
  dut.close();
  web.join();
  EXPECT_NE(refusal, "");
}

TEST(AddressFile, IsReadAgainAfterARestart) {
  const std::string token = "0123456789abcdef0123456789abcdef";
  const TemporaryFolder folder;
  const auto file = folder / "address";
  writeAddressFile(file, "http://127.0.0.1:8481/#token=" + token);
  const auto read = readAddressFile(file);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->port, 8481);
  EXPECT_EQ(read->token, token);
}

TEST(AddressFile, IsReadableByItsOwnerOnly) {
  const TemporaryFolder folder;
  const auto file = folder / "address";
  writeAddressFile(file, "http://127.0.0.1:8481/#token=x");
  struct stat facts {};
  ASSERT_EQ(stat(file.c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0600U);
  EXPECT_THROW(writeAddressFile("/nowhere/address", "x"), std::runtime_error);
}

TEST(AddressFile, RefusesInvalidAddresses) {
  for (const char* text : {"", "http://127.0.0.1:8480/", "http://127.0.0.1:8480/#token=short",
                           "http://127.0.0.1:99999/#token=0123456789abcdef0123456789abcdef",
                           "http://127.0.0.1:x/#token=0123456789abcdef0123456789abcdef"}) {
    EXPECT_FALSE(parseAddress(text)) << text;
  }
}

}  // namespace
}  // namespace lab::dashboard::dashboard_bus_test
