#include "projector_ctl/projector_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/image_file.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/math/units.hpp"
#include "light/field/raster.hpp"
#include "tests/support/programs.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::projector {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kEpoch = VirtualLoop::kEpoch;
constexpr std::int64_t kFrame = 16'667;  // [us] length of the first frame

/// A projector and a sender on a bus, in virtual time.
class ProjectorServiceTest : public testing::Test {
 protected:
  ProjectorServiceTest() {
    experiment.light.safe_intensity = 0.1;
    loop.drainWith([this] { bus.deliver(); });
    bus.subscribe(channels::kLightStatus, [this](const Packet& packet) {
      light_status_t status{};
      ASSERT_TRUE(decode(packet.data, status));
      statuses.push_back(status);
    });
    bus.subscribe(channels::kServiceStatus,
                  [this](const Packet& packet) { ASSERT_TRUE(decode(packet.data, heartbeat)); });
  }

  void start(const std::filesystem::path& pictures = {}) {
    dut = std::make_unique<ProjectorService>(ServiceContext{node, loop, experiment, folder.path()},
                                             pictures);
    node.start();
  }

  /// Starts to repeat the command at 2 Hz.
  void send(light_command_t command) {
    command.num_layers = static_cast<std::int32_t>(command.layers.size());
    sent = command;
    if (!repeating) loop.every(500'000, loop.now() + 500'000, [this] { publish(); });
    repeating = true;
    publish();
  }

  void publish() { sender.publishCommand(channels::kLightCommand, sent); }

  void runTo(double seconds) {
    statuses.clear();
    loop.runUntil(kEpoch + static_cast<std::int64_t>(seconds * 1e6 + 0.5));
  }

  static light_command_t uniform(std::int64_t seq, double intensity) {
    light_command_t command{};
    command.seq = seq;
    command.layers.push_back(toMessage(light::Layer{.intensity = intensity}));
    return command;
  }

  static double lightAt(const light_status_t& status, double x, double y) {
    return evaluate(toField(status), x, y);
  }

  VirtualLoop loop;
  TemporaryFolder folder;
  MemoryBus bus{[this] { return loop.now(); }};
  Node node{bus, loop, {"projector_ctl", 2, 1}};
  Node sender{bus, loop, {"lab", 0, 5}};
  Experiment experiment;
  std::unique_ptr<ProjectorService> dut;
  std::vector<light_status_t> statuses;
  service_status_t heartbeat{};
  light_command_t sent{};
  bool repeating = false;
};

TEST_F(ProjectorServiceTest, ReportsTheSafeFieldTenTimesASecond) {
  start();
  runTo(1.99);
  ASSERT_EQ(statuses.size(), 20);
  EXPECT_EQ(statuses[0].utime, kEpoch);
  EXPECT_EQ(statuses[1].utime, kEpoch + 100'000);
  EXPECT_EQ(statuses[19].frame, 19 * 6 + 1);
  EXPECT_EQ(statuses[19].seq, 20);
  EXPECT_EQ(statuses[19].commander, "");
  EXPECT_EQ(lightAt(statuses[19], 0.5, 0.5), 0.1);
  EXPECT_NEAR(statuses[19].frame_period, 1.0 / 60, 1e-12);
  EXPECT_EQ(heartbeat.state, service_status_t::READY);
}

TEST_F(ProjectorServiceTest, ShowsACommandAtTheNextFrameAndEchoesIt) {
  start();
  runTo(1.005);
  light_command_t command = uniform(3, 0.6);
  command.label = "bright";
  send(command);
  runTo(1.06);
  ASSERT_EQ(statuses.size(), 1);
  EXPECT_EQ(statuses[0].utime, kEpoch + 1'000'000 + kFrame);
  EXPECT_EQ(statuses[0].first_shown_utime, statuses[0].utime);
  EXPECT_EQ(statuses[0].commander, "lab");
  EXPECT_EQ(statuses[0].command_instance, 5);
  EXPECT_EQ(statuses[0].command_seq, 3);
  EXPECT_EQ(statuses[0].label, "bright");
  EXPECT_EQ(statuses[0].moving, 0);
  EXPECT_EQ(lightAt(statuses[0], 0.5, 0.5), 0.6);
}

TEST_F(ProjectorServiceTest, ShowsTheCommandAtTheFirstFrameAtOrAfterItsTime) {
  start();
  runTo(0.5);
  light_command_t command = uniform(1, 0.6);
  command.from_utime = kEpoch + 1'000'000;
  send(command);
  runTo(1.01);
  EXPECT_EQ(statuses.back().utime, kEpoch + 1'000'000);
  EXPECT_EQ(statuses.back().first_shown_utime, kEpoch + 1'000'000);
  EXPECT_EQ(lightAt(statuses.back(), 0.5, 0.5), 0.6);
}

TEST_F(ProjectorServiceTest, ReportsEveryFrameOfARamp) {
  start();
  runTo(0.95);
  light_command_t command = uniform(1, 1);
  command.from_utime = kEpoch + 1'000'000;
  command.ramp = 0.5;
  send(command);
  runTo(0.999);
  runTo(1.55);
  ASSERT_GE(statuses.size(), 31);
  for (std::size_t i = 0; i <= 30; ++i) {
    const double mix = static_cast<double>(statuses[i].utime - kEpoch - 1'000'000) / 500'000;
    EXPECT_EQ(statuses[i].frame, statuses[0].frame + static_cast<std::int64_t>(i));
    EXPECT_EQ(statuses[i].moving, i < 30 ? 1 : 0);
    EXPECT_NEAR(lightAt(statuses[i], 0.2, 0.2), 0.1 + 0.9 * mix, 1e-9);
  }
  EXPECT_EQ(statuses.size(), 31);
}

TEST_F(ProjectorServiceTest, FallsBackToTheSafeFieldWhenTheSenderIsSilent) {
  start();
  sent = uniform(1, 0.6);
  sent.num_layers = 1;
  publish();
  runTo(2.4);
  EXPECT_EQ(lightAt(statuses.back(), 0.5, 0.5), 0.6);
  runTo(2.55);
  EXPECT_EQ(lightAt(statuses.back(), 0.5, 0.5), 0.1);
  EXPECT_EQ(statuses.back().label, "safe field: lab fell silent");
}

TEST_F(ProjectorServiceTest, KeepsShowingARepeatedCommand) {
  start();
  send(uniform(1, 0.6));
  runTo(10);
  EXPECT_EQ(lightAt(statuses.back(), 0.5, 0.5), 0.6);
  EXPECT_EQ(statuses.back().first_shown_utime, kEpoch);
}

TEST_F(ProjectorServiceTest, ReportsWhyACommandWasRefusedAndKeepsTheLight) {
  start();
  send(uniform(1, 0.6));
  runTo(1.005);
  send(uniform(2, 1.5));
  runTo(2.2);
  ASSERT_FALSE(statuses.empty());
  EXPECT_EQ(statuses.front().utime, kEpoch + 1'000'000 + kFrame);
  EXPECT_EQ(statuses.front().last_refusal,
            "LIGHT_COMMAND 2 of lab: layers[0].intensity = 1.5, allowed: 0 to 1");
  EXPECT_EQ(statuses.front().command_seq, 1);
  EXPECT_EQ(lightAt(statuses.front(), 0.5, 0.5), 0.6);
  EXPECT_THAT(heartbeat.last_error, HasSubstr("intensity = 1.5"));
}

TEST_F(ProjectorServiceTest, RepeatsOnlyTheBeginningOfALongLabel) {
  start();
  light_command_t command = uniform(1, 0.6);
  command.label = std::string(300'000, 'x');
  send(command);
  runTo(0.5);
  ASSERT_FALSE(statuses.empty());
  EXPECT_EQ(statuses.back().label, std::string(200, 'x'));
  EXPECT_EQ(lightAt(statuses.back(), 0.5, 0.5), 0.6);
}

TEST_F(ProjectorServiceTest, FramesStayOnTheClockForAnHour) {
  start();
  runTo(3600);
  EXPECT_EQ(statuses.back().utime, kEpoch + 3'600'000'000);
  EXPECT_EQ(statuses.back().frame, 3600 * 60 + 1);
}

TEST_F(ProjectorServiceTest, ShowsTheImagesOfTheExperiment) {
  const std::string name = "projector_service_test.png";
  const std::filesystem::path path = folder / name;
  const std::vector<std::uint8_t> png = light::encodePng(2, 1, std::vector<std::uint8_t>{0, 255});
  replaceFile(path, png);
  LightStep step;
  LayerSpec& picture = step.layers.emplace_back();
  picture.kind = light_layer_t::IMAGE;
  picture.image = name;
  experiment.light.steps.push_back(step);
  start();

  light::Layer layer{.kind = light::LayerKind::kImage, .x = 0.6, .y = 0.45, .size = 1.2};
  layer.inner = 0.9;
  layer.intensity = 1;
  layer.image = light::sha256(png);
  light_command_t command{};
  command.seq = 1;
  command.layers.push_back(toMessage(layer));
  send(command);
  runTo(0.05);

  EXPECT_EQ(statuses.back().last_refusal, "");
  ASSERT_EQ(statuses.back().layers.size(), 1);
  EXPECT_EQ(statuses.back().layers[0].image, light::sha256(png));
  light::ImageStore images;
  images[light::sha256(png)] = light::decodeImage(png).image;
  EXPECT_NEAR(evaluate(toField(statuses.back(), images), 0.3, 0.4), 0, 1e-12);
  EXPECT_NEAR(evaluate(toField(statuses.back(), images), 0.9, 0.4), 1, 1e-12);
}

TEST_F(ProjectorServiceTest, RefusesAnImageThatTheExperimentDoesNotName) {
  start();
  light::Layer layer{.kind = light::LayerKind::kImage, .size = 1, .inner = 1};
  layer.image.assign(64, '0');
  light_command_t command{};
  command.seq = 1;
  command.layers.push_back(toMessage(layer));
  send(command);
  runTo(0.05);
  EXPECT_THAT(statuses.back().last_refusal, HasSubstr("an image that was loaded here"));
}

TEST_F(ProjectorServiceTest, NamesAMissingImageAtStart) {
  LightStep step;
  LayerSpec& picture = step.layers.emplace_back();
  picture.kind = light_layer_t::IMAGE;
  picture.image = "no_such_picture.png";
  experiment.light.steps.push_back(step);
  try {
    start();
    FAIL() << "the service started without its image";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no_such_picture.png"));
  }
}

TEST_F(ProjectorServiceTest, SavesAPictureOfEachNewFieldAfterItsCrossFade) {
  const std::filesystem::path directory = folder / "pictures";
  std::filesystem::create_directory(directory);
  start(directory);
  runTo(0.5);
  light_command_t command = uniform(1, 1);
  command.from_utime = kEpoch + 1'000'000;
  command.ramp = 0.5;
  send(command);
  runTo(3);

  const light::DecodedImage safe =
      loadImage(directory / ("light_" + std::to_string(kEpoch) + ".png"));
  const light::DecodedImage bright =
      loadImage(directory / ("light_" + std::to_string(kEpoch + 1'000'000) + ".png"));
  const auto files = std::distance(std::filesystem::directory_iterator(directory), {});
  ASSERT_TRUE(safe.image) << safe.error;
  ASSERT_TRUE(bright.image) << bright.error;
  EXPECT_EQ(files, 2);
  EXPECT_NEAR(light::sample(*safe.image, 0.5, 0.5), 0.1, 0.5 / 255);
  EXPECT_EQ(light::sample(*bright.image, 0.5, 0.5), 1);
}

TEST_F(ProjectorServiceTest, ReportsTimesAndDisplayOfTheLight) {
  experiment.projector.latency = 0.04;
  start();
  runTo(0.5);
  EXPECT_EQ(statuses.front().utime, kEpoch + 40'000);
  EXPECT_EQ(statuses.front().latency, 0.04);
  EXPECT_EQ(statuses.front().display, "headless");
  EXPECT_EQ(statuses.front().vsync, "clock");
  EXPECT_EQ(statuses.front().sync, -1);
  EXPECT_EQ(statuses.front().tracker_instance, 0);
  EXPECT_EQ(statuses.front().first_shown_utime, kEpoch + 40'000);
}

TEST_F(ProjectorServiceTest, FollowsTrackedRobotsAndReportsTheFramesUsed) {
  experiment.robots.emplace_back().id = 3;
  experiment.projector.latency = 0.04;
  Node tracker{bus, loop, {"sim_svc", 2, 77}};
  std::int64_t number = 0;
  loop.every(20'000, kEpoch + 5'000, [&] {
    tracked_frame_t frame{};
    frame.utime = loop.now() - 20'000;
    frame.frame = ++number;
    tracked_pose_t pose{};
    pose.robot_id = 3;
    pose.x = 0.2 + 0.1 * units::seconds(frame.utime - kEpoch);
    pose.y = 0.3;
    pose.confidence = 1;
    frame.robots = {pose};
    frame.num_robots = 1;
    // The robot is not seen for a while.
    if (number < 100 || number > 150) tracker.publish(channels::kTrackedFrame, frame);
  });
  start();
  light::Layer spot{.kind = light::LayerKind::kDisk, .size = 0.05, .intensity = 1};
  light::Drive drive;
  drive.follow = light::Follow::kRobots;
  light_command_t command{};
  setLayers(command, {{spot, drive}});
  command.seq = 1;
  send(command);
  runTo(1.5);
  EXPECT_GT(statuses.size(), 85U) << "every frame of a moving field";
  std::int64_t last = 0;
  for (const light_status_t& status : statuses) {
    EXPECT_EQ(status.moving, 1);
    EXPECT_EQ(status.tracker_instance, status.utime < kEpoch + 50'000 ? 0 : 77);
    for (const std::int64_t frame : status.tracked_frames) {
      if (last != 0) {
        EXPECT_EQ(frame, last + 1);
      }
      last = frame;
    }
  }
  ASSERT_EQ(statuses.back().layers.size(), 1U);
  EXPECT_NEAR(statuses.back().layers[0].x,
              0.2 + 0.1 * units::seconds(statuses.back().utime - kEpoch), 1e-6);

  runTo(2.9);
  EXPECT_THAT(statuses.back().trouble, HasSubstr("robot 3 (last seen 00:00:01.9"));
  EXPECT_EQ(statuses.back().layers.size(), 0U);
  const std::string trouble = statuses.back().trouble;
  runTo(3.5);
  EXPECT_EQ(heartbeat.last_error, trouble);
  EXPECT_EQ(statuses.back().trouble, "");
  EXPECT_EQ(statuses.back().layers.size(), 1U);
}

TEST_F(ProjectorServiceTest, RefusesTooManyLayersAndNonFiniteNumbersWithOneMessage) {
  start();
  light_command_t command{};
  command.seq = 1;
  command.layers.assign(20'000, toMessage(light::Layer{}));
  send(command);
  runTo(2.1);
  EXPECT_EQ(statuses.back().last_refusal,
            "LIGHT_COMMAND 1 of lab: layers = more than 160 layers, allowed: at most 160");
  EXPECT_EQ(heartbeat.last_error, statuses.back().last_refusal);
  light::Drive drive;
  drive.follow = light::Follow::kRobots;
  drive.stale = std::numeric_limits<double>::quiet_NaN();
  light_command_t second{};
  setLayers(second, {{{.kind = light::LayerKind::kDisk, .size = 0.1}, drive}});
  second.seq = 2;
  send(second);
  runTo(3);
  EXPECT_THAT(statuses.back().last_refusal, HasSubstr("layers[0].stale = nan s"));
  EXPECT_EQ(statuses.back().commander, "");
}

TEST_F(ProjectorServiceTest, DoesNotDecodeACommandOfAMillionLayers) {
  start();
  light_command_t command{};
  command.seq = 1;
  command.layers.assign(1'000'000, toMessage(light::Layer{}));
  send(command);
  runTo(2.1);
  EXPECT_THAT(heartbeat.last_error, HasSubstr("LIGHT_COMMAND from lab refused: size: found "));
  EXPECT_EQ(statuses.back().commander, "");
}

TEST_F(ProjectorServiceTest, GatesByTheExperimentsNamesOfPrograms) {
  experiment.robots.emplace_back().id = 3;
  Program spec = test::abp(0.05, 0.5, 3);
  spec.name = "same";
  experiment.programs["other"] = test::rtp(0.05, 3, 0.5);
  experiment.programs["same"] = spec;
  start();
  Node robots{bus, loop, {"sim_svc", 2, 77}};
  robot_status_t report{};
  robot_state_t robot{};
  robot.robot_id = 3;
  loop.every(20'000, kEpoch + 5'000, [&] {
    robot.utime = loop.now();
    report.robots = {robot};
    report.num_robots = 1;
    robots.publish(channels::kRobotStatus, report);
  });
  light::Drive drive;
  drive.gate = light::Gate::kProgram;
  drive.gate_program = "same";
  light_command_t command{};
  setLayers(command, {{light::Layer{.intensity = 0.9}, drive}});
  command.seq = 1;
  send(command);
  runTo(1);
  EXPECT_EQ(statuses.back().last_refusal, "");
  EXPECT_EQ(statuses.back().layers.size(), 0U);
  robot.program = toId(experiment.programs.at("other"));
  runTo(1.5);
  EXPECT_EQ(statuses.back().layers.size(), 0U);
  robot.program = toId(spec);
  robot.program.name = "a name of another experiment";
  runTo(1.6);
  EXPECT_EQ(statuses.back().layers.size(), 1U);
}

}  // namespace
}  // namespace lab::projector
