#include "common/bus/contract_upgrade.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <lab/experiment_event_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab_v3/experiment_event_t.hpp>
#include <lab_v3/light_command_t.hpp>
#include <lab_v3/light_status_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

lab_v3::light_layer_t disk() {
  lab_v3::light_layer_t layer{};
  layer.kind = lab_v3::light_layer_t::DISK;
  layer.x = 0.3;
  layer.size = 0.1;
  layer.intensity = 0.8;
  layer.image = "none";
  return layer;
}

TEST(ContractUpgrade, KeepsEveryFieldOfAnOldLightStatus) {
  lab_v3::light_status_t old{};
  old.utime = 12;
  old.sender = "projector_ctl";
  old.instance = 3;
  old.seq = 4;
  old.frame = 5;
  old.frame_period = 0.02;
  old.commander = "lab";
  old.command_instance = 6;
  old.command_seq = 7;
  old.label = "dim";
  old.first_shown_utime = 11;
  old.moving = 1;
  old.last_refusal = "no";
  old.mix = 0.25;
  old.previous = {disk()};
  old.num_previous = 1;
  old.layers = {disk(), disk()};
  old.num_layers = 2;

  const auto bytes = upgraded(encode(old));

  ASSERT_TRUE(bytes);
  light_status_t status{};
  ASSERT_TRUE(decode(*bytes, status));
  EXPECT_EQ(status.utime, 12);
  EXPECT_EQ(status.sender, "projector_ctl");
  EXPECT_EQ(status.instance, 3);
  EXPECT_EQ(status.seq, 4);
  EXPECT_EQ(status.frame, 5);
  EXPECT_EQ(status.frame_period, 0.02);
  EXPECT_EQ(status.commander, "lab");
  EXPECT_EQ(status.command_instance, 6);
  EXPECT_EQ(status.command_seq, 7);
  EXPECT_EQ(status.label, "dim");
  EXPECT_EQ(status.first_shown_utime, 11);
  EXPECT_EQ(status.moving, 1);
  EXPECT_EQ(status.last_refusal, "no");
  EXPECT_EQ(status.mix, 0.25);
  EXPECT_EQ(status.sync, -1);
  EXPECT_EQ(status.display, "headless");
  ASSERT_EQ(status.num_previous, 1);
  ASSERT_EQ(status.num_layers, 2);
  EXPECT_EQ(status.layers[1].kind, light_layer_t::DISK);
  EXPECT_EQ(status.layers[1].x, 0.3);
  EXPECT_EQ(status.layers[1].size, 0.1);
  EXPECT_EQ(status.layers[1].intensity, 0.8);
  EXPECT_EQ(status.layers[1].image, "none");
}

TEST(ContractUpgrade, ReadsOldCommandsAndEvents) {
  lab_v3::light_command_t command{};
  command.sender = "lab";
  command.ramp = 2;
  command.layers = {disk()};
  command.num_layers = 1;
  lab_v3::experiment_event_t event{};
  event.kind = lab_v3::experiment_event_t::STEP;
  event.step = 9;
  event.last_acted_utime = 44;

  light_command_t new_command{};
  ASSERT_TRUE(decode(upgraded(encode(command)).value(), new_command));
  EXPECT_EQ(new_command.sender, "lab");
  EXPECT_EQ(new_command.ramp, 2);
  EXPECT_EQ(new_command.num_layers, 1);
  EXPECT_EQ(new_command.num_drives, 0);
  experiment_event_t new_event{};
  ASSERT_TRUE(decode(upgraded(encode(event)).value(), new_event));
  EXPECT_EQ(new_event.step, 9);
  EXPECT_EQ(new_event.last_acted_utime, 44);
  EXPECT_EQ(new_event.seen_utime, 0);
}

TEST(ContractUpgrade, IgnoresPresentMessagesAndArbitraryBytes) {
  EXPECT_FALSE(upgraded(encode(light_status_t{})));
  EXPECT_FALSE(upgraded({}));
  std::vector<std::uint8_t> cut = encode(lab_v3::light_status_t{});
  cut.resize(cut.size() - 1);
  EXPECT_FALSE(upgraded(cut));
}

TEST(ContractUpgrade, ConvertsMessagesOfOldLogs) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "old.lcmlog";
  {
    LogWriter writer(path);
    lab_v3::light_status_t old{};
    old.frame = 77;
    const std::vector<std::uint8_t> bytes = encode(old);
    writer.write({channels::kLightStatus, bytes, 1});
  }
  light_status_t status{};
  readLog({path}, [&](const Packet& packet) { ASSERT_TRUE(decode(packet.data, status)); });
  EXPECT_EQ(status.frame, 77);
}

}  // namespace
}  // namespace lab
