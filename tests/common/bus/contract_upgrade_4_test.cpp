// Messages of contract version 4, in which a program was one of five models with parameters.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <lab/analysis_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <limits>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/contract_upgrade.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/message_values.hpp"
#include "common/experiment/order_settings.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/files/file_values.hpp"
#include "common/math/random.hpp"
#include "common/math/units.hpp"
#include "tests/lcmtypes/contract_v4.hpp"
#include "tests/support/experiment_samples.hpp"
#include "tests/support/programs.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::contract_upgrade_4_test {
namespace {

using testing::HasSubstr;

lab_v4::program_t oldAbp(double v = 0.03, double epsilon = 0.5, double eta = 3) {
  lab_v4::program_t program{};
  program.kind = lab_v4::program_t::ABP;
  program.v = v;
  program.epsilon = epsilon;
  program.eta = eta;
  return program;
}

template <class New, class Old>
New converted(const Old& old) {
  New message{};
  const auto bytes = upgraded(encode(old));
  EXPECT_TRUE(bytes.has_value());
  EXPECT_TRUE(bytes && decode(*bytes, message));
  return message;
}

/// A message of version 4 with a different value in every field, but one possible program.
template <class Old>
Old sampleWith(const lab_v4::program_t& program) {
  auto message = sample<Old>(2);
  if constexpr (requires { message.robots[0].program.kind; }) {
    for (auto& robot : message.robots) robot.program = program;
  }
  if constexpr (requires { message.orders; }) {
    for (auto& order : message.orders) {
      for (auto& band : order.bands) band.program = program;
    }
  }
  return message;
}

/// The encoding of the fields of a message, without its fingerprint.
template <class... Fields>
std::vector<std::uint8_t> bytesOf(Fields&... field) {
  WireWriter writer;
  (writer(field), ...);
  return writer.bytes;
}

template <class Message>
std::vector<std::uint8_t> headerOf(Message& m) {
  return bytesOf(m.utime, m.sender, m.instance, m.seq);
}

TEST(ContractUpgrade4, KeepsEveryFieldOfARobotStatus) {
  auto old = sampleWith<lab_v4::robot_status_t>(oldAbp());

  auto message = converted<robot_status_t>(old);

  EXPECT_EQ(headerOf(message), headerOf(old));
  ASSERT_EQ(message.num_robots, 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto kept = [](auto& m) {
      return bytesOf(m.utime, m.robot_id, m.origin, m.uid, m.band, m.program_epoch,
                     m.program_start_utime, m.wheel_left, m.wheel_right, m.program_left,
                     m.program_right, m.light_front, m.light_back, m.ir, m.flags, m.command_seq,
                     m.command_instance, m.stop_seq, m.reversal_count, m.reversal_start_utime,
                     m.reversal_end_utime, m.tumble_count, m.run_time, m.battery, m.link_sent,
                     m.link_received, m.link_errors);
    };
    EXPECT_EQ(kept(message.robots[i]), kept(old.robots[i]));
    EXPECT_EQ(message.robots[i].program.hash, test::abp(0.03, 0.5, 3).hash);
    EXPECT_EQ(message.robots[i].program.name, "abp");
    EXPECT_EQ(message.robots[i].senses_utime, 0);
  }
}

TEST(ContractUpgrade4, KeepsThePhaseOfARobotThatTumbles) {
  lab_v4::robot_status_t old{};
  old.robots.resize(2);
  old.num_robots = 2;
  for (auto& robot : old.robots) {
    robot.program.kind = lab_v4::program_t::RTP;
    robot.program.v = 0.05;
    robot.program.gamma = 3;
    robot.program.tau_t = 0.5;
  }
  old.robots[1].flags = lab_v4::robot_state_t::FLAG_TUMBLING;

  const auto message = converted<robot_status_t>(old);

  EXPECT_EQ(message.robots[0].phase, 0);
  EXPECT_EQ(message.robots[1].phase, 1);
}

TEST(ContractUpgrade4, GivesACommandTheDefinitionsOfItsPrograms) {
  auto old = sampleWith<lab_v4::robot_command_t>(oldAbp());
  old.orders[0].bands[1].program = {};  // stands

  auto message = converted<robot_command_t>(old);

  EXPECT_EQ(headerOf(message), headerOf(old));
  EXPECT_EQ(message.lease_ms, old.lease_ms);
  ASSERT_EQ(message.num_orders, 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto kept = [](auto& m) {
      return bytesOf(m.num_robots, m.robot_ids, m.mode, m.wheel_left, m.wheel_right, m.light_sensor,
                     m.hysteresis, m.num_bands, m.reverse_on, m.reverse_distance, m.reverse_speed);
    };
    EXPECT_EQ(kept(message.orders[i]), kept(old.orders[i]));
    ASSERT_EQ(message.orders[i].bands.size(), 2U);
    EXPECT_EQ(message.orders[i].bands[1].low, old.orders[i].bands[1].low);
    EXPECT_EQ(message.orders[i].bands[1].high, old.orders[i].bands[1].high);
  }
  EXPECT_EQ(toProgram(message.orders[1].bands[1].program), test::abp(0.03, 0.5, 3));
  EXPECT_EQ(message.orders[0].bands[1].program.id.hash, 0);
  EXPECT_TRUE(message.orders[0].bands[1].program.code.empty());
}

TEST(ContractUpgrade4, KeepsEveryFieldOfStepsButTheirKind) {
  auto old = sample<lab_v4::robot_steps_t>(2);

  auto message = converted<robot_steps_t>(old);

  EXPECT_EQ(headerOf(message), headerOf(old));
  ASSERT_EQ(message.num_steps, 2);
  const auto kept = [](auto& m) {
    return bytesOf(m.utime, m.robot_id, m.draw_count, m.program_epoch, m.slot, m.wheel_left,
                   m.wheel_right, m.duration, m.rng);
  };
  EXPECT_EQ(kept(message.steps[1]), kept(old.steps[1]));
  EXPECT_EQ(message.steps[1].phase, 0);
}

TEST(ContractUpgrade4, KeepsTruePosesAndSaysThatTheirProgramIsNotKnown) {
  auto old = sample<lab_v4::sim_truth_t>(2);
  old.robots[0].program = lab_v4::program_t::NONE;
  old.robots[1].program = lab_v4::program_t::RTP;

  auto message = converted<sim_truth_t>(old);

  EXPECT_EQ(headerOf(message), headerOf(old));
  EXPECT_EQ(message.collisions, old.collisions);
  ASSERT_EQ(message.num_robots, 2);
  const auto kept = [](auto& m) {
    return bytesOf(m.robot_id, m.x, m.y, m.theta, m.contact_robot, m.contact_wall);
  };
  EXPECT_EQ(kept(message.robots[1]), kept(old.robots[1]));
  EXPECT_EQ(message.robots[0].program, 0);
  EXPECT_EQ(message.robots[1].program, -1);
}

TEST(ContractUpgrade4, KeepsEveryFieldOfAnAnalysisAndTheNameOfItsProgram) {
  auto old = sample<lab_v4::analysis_t>(2);
  old.program = oldAbp();
  old.program_name = "fast";

  auto message = converted<analysis_t>(old);

  EXPECT_EQ(headerOf(message), headerOf(old));
  const auto kept = [](auto& m) {
    return bytesOf(m.robot_id, m.observed, m.segments, m.reversals, m.contact_share, m.verdict,
                   m.max_z, m.num_curves, m.curves, m.num_estimates, m.estimates);
  };
  EXPECT_EQ(kept(message), kept(old));
  EXPECT_EQ(message.program.hash, test::abp(0.03, 0.5, 3).hash);
  EXPECT_EQ(message.program.name, "fast");
}

/// A program of an experiment file, and what version 4 made of it.
struct Pair {
  std::string file;
  lab_v4::program_t message;
};

/// A random number with `decimals` decimals, as people write it.
double written(Random& random, double low, double high, int decimals) {
  const double step = std::pow(10, -decimals);
  return std::round((low + (high - low) * random.uniform()) / step) / std::pow(10, decimals);
}

Pair randomProgram(Random& random, int kind) {
  Pair pair;
  pair.message.kind = static_cast<std::int8_t>(kind);
  const std::vector<std::string> models{"", "abp", "noisy_abp", "bp", "rtp", "wheels"};
  pair.file = "model = \"" + models.at(static_cast<std::size_t>(kind)) + "\"\n";
  const auto set = [&](const char* key, double lab_v4::program_t::*field, double low, double high) {
    const double value = written(random, low, high, 1 + kind % 3);
    pair.file += std::string(key) + " = " + keys::numberText(value) + "\n";
    pair.message.*field = keys::toSi(value, keys::unitOf(key));
  };
  using P = lab_v4::program_t;
  if (kind == P::ABP || kind == P::RTP) set("v_cm_s", &P::v, -5, 5);
  if (kind == P::NOISY_ABP) set("va_cm_s", &P::va, -5, 5);
  if (kind == P::NOISY_ABP || kind == P::BP) set("V_cm_s", &P::V, 0.1, 12);
  if (kind == P::ABP || kind == P::NOISY_ABP || kind == P::BP) {
    set("epsilon_s", &P::epsilon, 0.1, 3);
  }
  if (kind == P::ABP) set("eta_rad_s", &P::eta, 0.1, 5);
  if (kind == P::RTP) set("gamma_per_s", &P::gamma, 0.1, 9);
  if (kind == P::RTP) set("tau_t_s", &P::tau_t, 0.5, 3);
  if (kind == P::WHEELS) set("left_cm_s", &P::wheel_left, -20, 20);
  if (kind == P::WHEELS) set("right_cm_s", &P::wheel_right, -20, 20);
  return pair;
}

TEST(ContractUpgrade4, FindsTheProgramsOfTheExperimentFile) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Pair pair = randomProgram(random, 1 + i % 5);
    const Experiment experiment = small("[programs.mine]\n" + pair.file);
    lab_v4::robot_status_t old{};
    old.robots.resize(1);
    old.num_robots = 1;
    old.robots[0].program = pair.message;

    const auto message = converted<robot_status_t>(old);

    EXPECT_EQ(message.robots[0].program.hash, experiment.programs.at("mine").hash) << pair.file;
    EXPECT_EQ(programName(experiment, message.robots[0].program), "mine") << pair.file;
  }
}

TEST(ContractUpgrade4, OfAProgramThatNoRobotCanRunIsRefusedWithAReason) {
  for (const double epsilon :
       {-1.0, 0.0, 1e9, std::numeric_limits<double>::infinity(), units::kNan}) {
    lab_v4::robot_status_t status{};
    status.robots.resize(1);
    status.num_robots = 1;
    status.robots[0].program = oldAbp(0.03, epsilon, 3);
    EXPECT_EQ(impossibleValue(converted<robot_status_t>(status)),
              "robots[0].program.hash: found -1, expected 0 to 4294967295")
        << epsilon;
  }
  lab_v4::robot_command_t command{};
  command.orders.resize(1);
  command.num_orders = 1;
  lab_v4::robot_order_t& order = command.orders[0];
  order.mode = lab_v4::robot_order_t::TABLE;
  order.bands.resize(1);
  order.num_bands = 1;
  order.bands[0].high = 1;
  order.bands[0].program = oldAbp(0.03, -1, 3);
  EXPECT_THAT(
      settingsFrom(converted<robot_command_t>(command).orders[0], dynamics::WheelLimits(), 0.02)
          .refusal,
      HasSubstr("program \"impossible program\": its byte code has fault"));
}

TEST(ContractUpgrade4, OfAModelThatVersion4DidNotHaveIsRefused) {
  for (const int kind : {-1, 6, 77}) {
    lab_v4::robot_status_t status{};
    status.robots.resize(1);
    status.num_robots = 1;
    status.robots[0].program.kind = static_cast<std::int8_t>(kind);
    EXPECT_TRUE(impossibleValue(converted<robot_status_t>(status))) << kind;
  }
}

TEST(ContractUpgrade4, IgnoresPresentMessagesAndDamagedOnes) {
  EXPECT_FALSE(upgraded(encode(robot_status_t{})));
  EXPECT_FALSE(upgraded(encode(robot_command_t{})));
  std::vector<std::uint8_t> cut = encode(lab_v4::robot_status_t{});
  cut.resize(cut.size() - 1);
  EXPECT_FALSE(upgraded(cut));
}

TEST(ContractUpgrade4, NamesTheTypesThatItConverts) {
  for (const char* type :
       {"robot_status_t ", "robot_command_t ", "robot_steps_t ", "sim_truth_t ", "analysis_t "}) {
    EXPECT_THAT(olderFingerprintList(), HasSubstr(type));
  }
}

TEST(ContractUpgrade4, ConvertsMessagesOfOldLogs) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "old.lcmlog";
  {
    LogWriter writer(path);
    lab_v4::robot_status_t old{};
    old.robots.resize(1);
    old.num_robots = 1;
    old.robots[0].program = oldAbp();
    writer.write({channels::kRobotStatus, encode(old), 1});
  }

  robot_status_t status{};
  readLog({path}, [&](const Packet& packet) { ASSERT_TRUE(decode(packet.data, status)); });

  ASSERT_EQ(status.robots.size(), 1U);
  EXPECT_EQ(status.robots[0].program.name, "abp");
}

}  // namespace
}  // namespace lab::contract_upgrade_4_test
