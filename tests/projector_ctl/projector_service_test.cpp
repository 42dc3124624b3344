#include "projector_ctl/projector_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <vector>

#include "common/channels.hpp"
#include "common/memory_bus.hpp"
#include "common/virtual_loop.hpp"
#include "light/raster.hpp"

namespace lab::projector {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kEpoch = VirtualLoop::kEpoch;
constexpr std::int64_t kFrame = 16'667;  // [us] the first frame's length

/// A projector on a bus of its own, in virtual time, and a sender beside it.
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
    dut = std::make_unique<ProjectorService>(
        ServiceContext{node, loop, experiment, testing::TempDir()}, pictures);
    node.start();
  }

  /// Repeats the command at 2 Hz from now on.
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

TEST_F(ProjectorServiceTest, SaysTenTimesASecondThatItShowsTheSafeField) {
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

TEST_F(ProjectorServiceTest, SaysWhyItRefusedACommandAndKeepsTheLight) {
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

TEST_F(ProjectorServiceTest, KeepsFramesOnTheirClockForAnHour) {
  start();
  runTo(3600);
  EXPECT_EQ(statuses.back().utime, kEpoch + 3'600'000'000);
  EXPECT_EQ(statuses.back().frame, 3600 * 60 + 1);
}

TEST_F(ProjectorServiceTest, ShowsTheImagesOfTheExperiment) {
  const std::string name = "projector_service_test.png";
  const std::filesystem::path path = testing::TempDir() + name;
  const std::vector<std::uint8_t> png = light::encodePng(2, 1, std::vector<std::uint8_t>{0, 255});
  ASSERT_EQ(light::writeFile(path, png), std::nullopt);
  LightStep step;
  step.layers.push_back({.kind = light_layer_t::IMAGE, .image = name});
  experiment.light.steps.push_back(step);
  start();
  std::filesystem::remove(path);

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

TEST_F(ProjectorServiceTest, NamesAnImageThatIsMissingAtStart) {
  LightStep step;
  step.layers.push_back({.kind = light_layer_t::IMAGE, .image = "no_such_picture.png"});
  experiment.light.steps.push_back(step);
  try {
    start();
    FAIL() << "it started without its image";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no_such_picture.png"));
  }
}

TEST_F(ProjectorServiceTest, LeavesAPictureOfEachNewFieldOnceItIsFadedIn) {
  const std::filesystem::path directory = testing::TempDir() + "projector_service_pictures";
  std::filesystem::create_directory(directory);
  start(directory);
  runTo(0.5);
  light_command_t command = uniform(1, 1);
  command.from_utime = kEpoch + 1'000'000;
  command.ramp = 0.5;
  send(command);
  runTo(3);

  const light::DecodedImage safe =
      light::loadImage(directory / ("light_" + std::to_string(kEpoch) + ".png"));
  const light::DecodedImage bright =
      light::loadImage(directory / ("light_" + std::to_string(kEpoch + 1'000'000) + ".png"));
  const auto files = std::distance(std::filesystem::directory_iterator(directory), {});
  std::filesystem::remove_all(directory);
  ASSERT_TRUE(safe.image) << safe.error;
  ASSERT_TRUE(bright.image) << bright.error;
  EXPECT_EQ(files, 2);
  EXPECT_NEAR(light::sample(*safe.image, 0.5, 0.5), 0.1, 0.5 / 255);
  EXPECT_EQ(light::sample(*bright.image, 0.5, 0.5), 1);
}

}  // namespace
}  // namespace lab::projector
