// A running gateway seen from ROS 2: topics and commands. ROS 2's side is Cyclone as rmw uses it:
// @final types without keys, XCDR1, rmw's QoS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <lab/light_command_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <optional>
#include <string>
#include <thread>

#include "tests/dds_gateway/ros/ros_gateway_fixture.hpp"

namespace lab::gateway::ros_gateway_test {
namespace {

using ::testing::HasSubstr;

ros::Twist forward(double v) {
  ros::Twist twist{};
  twist.linear.x = v;
  return twist;
}

TEST(RosGateway, ALateJoinerGetsLightRobotsAndPosesAtOnce) {
  RosGatewayFixture dut;
  const std::int64_t utime = 1'700'000'000'000'000;
  // Each is sent once; a listener on LCM would have to wait for the next.
  auto frame = frameOf(2, utime, 1);
  dut.node().publish(channels::kTrackedFrame, frame);
  auto status = statusOf(2, utime);
  dut.node().publish(channels::kRobotStatus, status);
  auto light = uniformLight(0.25, utime);
  dut.node().publish(channels::kLightStatus, light);
  dut.spin(2.5);  // the list of robots is published once a second

  RosReader<ros::OccupancyGrid> field(dut.domain(), "/lab/light_field", true);
  RosReader<ros::String> robots(dut.domain(), "/lab/robots", true);
  RosReader<ros::PoseArray> poses(dut.domain(), "/lab/poses", true);
  RosReader<ros::PoseStamped> pose(dut.domain(), "/lab/robot2/pose", true);
  int fields = 0;
  std::string list;
  std::uint32_t posed = 0;
  double x = 0;
  const bool all = dut.spin(5, [&] {
    field.take([&](const ros::OccupancyGrid& grid) {
      ++fields;
      EXPECT_EQ(grid.data._length, 120U * 90U);
      EXPECT_EQ(grid.data._buffer[1234], 25);
      EXPECT_EQ(grid.header.stamp.sec, 1'700'000'000);
    });
    robots.take([&](const ros::String& message) { list = message.data; });
    poses.take([&](const ros::PoseArray& message) { posed = message.poses._length; });
    pose.take([&](const ros::PoseStamped& message) {
      x = message.pose.position.x;
      EXPECT_STREQ(message.header.frame_id, "lab/arena");
    });
    return fields > 0 && !list.empty() && posed > 0 && x > 0;
  });
  EXPECT_TRUE(all) << fields << list << posed << " " << x;
  EXPECT_EQ(fields, 1);
  EXPECT_EQ(posed, 2U);
  EXPECT_DOUBLE_EQ(x, 0.2);
  EXPECT_THAT(list, HasSubstr(R"("namespace":"/lab/robot2")"));
}

TEST(RosGateway, PublishesMotionLightAndDiagnostics) {
  RosGatewayFixture dut;
  RosReader<ros::Odometry> odometry(dut.domain(), "/lab/robot1/odom");
  RosReader<ros::TFMessage> tf(dut.domain(), "/tf");
  RosReader<ros::Illuminance> light(dut.domain(), "/lab/robot1/light");
  RosReader<ros::PoseArray> volatile_too(dut.domain(), "/lab/poses");
  RosReader<ros::Odometry> wrong_qos(dut.domain(), "/lab/robot2/odom", true);
  std::int64_t number = 0;
  double v = 0;
  double reading = 0;
  std::uint32_t frames = 0;
  int arrays = 0;
  const bool all = dut.spinActing(
      8, 0.02,
      [&] {
        auto status = statusOf(2, dut.now());
        dut.node().publish(channels::kRobotStatus, status);
        auto frame = frameOf(2, dut.now(), ++number);
        dut.node().publish(channels::kTrackedFrame, frame);
      },
      [&] {
        odometry.take([&](const ros::Odometry& message) { v = message.twist.twist.linear.x; });
        tf.take([&](const ros::TFMessage& message) { frames = message.transforms._length; });
        light.take([&](const ros::Illuminance& message) { reading = message.illuminance; });
        arrays += volatile_too.take([](const ros::PoseArray&) {});
        return v > 0 && reading > 0 && frames > 0 && arrays > 0;
      });
  EXPECT_TRUE(all);
  EXPECT_DOUBLE_EQ(v, 0.1);
  EXPECT_EQ(reading, 0.5);
  EXPECT_EQ(frames, 2U);
  const std::string text = dut.diagnostics();
  EXPECT_THAT(text, HasSubstr("lab: dds_gateway"));
  EXPECT_THAT(text, HasSubstr("/lab/robot1/pose: readers 0, in "));
  EXPECT_THAT(text, HasSubstr("ROS side asks for another durability"));
}

TEST(RosGateway, CmdVelDrivesASimulatedRobotAndSilenceStopsIt) {
  RosGatewayFixture dut(kTwoRobots, true);
  ASSERT_TRUE(dut.spin(10, [&] { return dut.inScript(1) && dut.inScript(2); }));
  RosWriter<ros::Twist> teleop(dut.domain(), "/lab/robot1/cmd_vel", false);
  ASSERT_TRUE(dut.spinActing(
      10, 0.05, [&] { teleop.write(forward(0.1)); }, [&] { return dut.driven(1, 0.1); }));
  int away = 0;
  dut.spinActing(1, 0.05, [&] {
    teleop.write(forward(0.1));
    away += dut.driven(1, 0.1) ? 0 : 1;
  });
  EXPECT_EQ(away, 0) << "the lab's light table has the robot meanwhile";
  EXPECT_TRUE(dut.inScript(2)) << "the other robot goes on";
  EXPECT_TRUE(dut.spin(3, [&] { return dut.driven(1, 0); })) << "it stands";
  EXPECT_FALSE(dut.inScript(1));
  EXPECT_TRUE(dut.spin(10, [&] { return dut.inScript(1); })) << "and is given back";

  // Newer ROS 2 programs send the stamped form; a command that is too fast is slowed down.
  RosWriter<ros::TwistStamped> stamped(dut.domain(), "/lab/robot2/cmd_vel");
  static char no_frame[] = "";
  ros::TwistStamped message{};
  message.header.frame_id = no_frame;
  message.twist = forward(7);
  EXPECT_TRUE(dut.spinActing(
      10, 0.05, [&] { stamped.write(message); }, [&] { return dut.driven(2, 0.27); }));
}

TEST(RosGateway, NobodyCommandsUnlessTheFileAllowsIt) {
  std::string text = kTwoRobots;
  text.erase(text.find("commands = true\n"), std::string("commands = true\n").size());
  RosGatewayFixture dut(text, true);
  ASSERT_TRUE(dut.spin(10, [&] { return dut.inScript(1); }));
  RosReader<ros::PoseStamped> pose(dut.domain(), "/lab/robot1/pose");
  RosWriter<ros::Twist> teleop(dut.domain(), "/lab/robot1/cmd_vel", false);
  // The reader is matched: the discovery of the gateway's endpoints is over.
  ASSERT_TRUE(dut.spin(10, [&] { return pose.matching().peers > 0; }));
  int driven = 0;
  dut.spinActing(1, 0.05, [&] {
    teleop.write(forward(0.1));
    driven += dut.driven(1, 0.1) ? 1 : 0;
  });
  EXPECT_EQ(driven, 0);
  EXPECT_EQ(teleop.matching().peers, 0);
}

TEST(RosGateway, OnePublisherHoldsARobot) {
  RosGatewayFixture dut(kTwoRobots, true);
  RosWriter<ros::Twist> anna(dut.domain(), "/lab/robot1/cmd_vel");
  RosWriter<ros::Twist> bert(dut.domain(), "/lab/robot1/cmd_vel");
  ASSERT_TRUE(dut.spinActing(
      10, 0.05, [&] { anna.write(forward(0.05)); }, [&] { return dut.driven(1, 0.05); }));
  int other = 0;
  dut.spinActing(1.5, 0.03, [&] {
    anna.write(forward(0.05));
    bert.write(forward(-0.2));
    other += dut.driven(1, 0.05) ? 0 : 1;
  });
  EXPECT_EQ(other, 0);
  EXPECT_THAT(dut.diagnostics(1.5), HasSubstr("owned by another publisher: "));
  EXPECT_TRUE(dut.spinActing(
      5, 0.03, [&] { bert.write(forward(-0.2)); }, [&] { return dut.driven(1, -0.2); }))
      << "the first is silent";
}

TEST(RosGateway, NanAndForeignTypesAreRefusedAndReported) {
  RosGatewayFixture dut(kTwoRobots, true);
  RosWriter<ros::Twist> teleop(dut.domain(), "/lab/robot1/cmd_vel");
  RosWriter<ros::String> foreign(dut.domain(), "/lab/robot2/cmd_vel");
  static char text[] = "forward";
  int moved = 0;
  dut.spinActing(2.5, 0.02, [&] {
    teleop.write(forward(std::nan("")));
    foreign.write({text});
    moved += dut.state(1).robot_id == 1 && !dut.inScript(1) ? 1 : 0;
  });
  EXPECT_LE(moved, 20) << "until the first light table";
  const std::string report = dut.diagnostics(2.5);
  EXPECT_THAT(report, HasSubstr("nan or infinite: "));
  EXPECT_THAT(report, HasSubstr("rt/lab/robot2/cmd_vel has std_msgs::msg::dds_::String_"));
  EXPECT_THAT(dut.lastError(),
              ::testing::AnyOf(HasSubstr("nan or infinite"), HasSubstr("with another type")));
  EXPECT_TRUE(dut.inScript(1));
  EXPECT_TRUE(dut.inScript(2));
}

TEST(RosGateway, AFloodOnOneTopicDoesNotDelayTheOthers) {
  RosGatewayFixture dut(kTwoRobots, true);
  RosWriter<ros::Twist> calm(dut.domain(), "/lab/robot2/cmd_vel");
  ASSERT_TRUE(dut.spinActing(
      10, 0.05, [&] { calm.write(forward(0.05)); }, [&] { return dut.driven(2, 0.05); }));
  std::atomic<bool> over = false;
  std::atomic<std::int64_t> sent = 0;
  std::thread flood([&] {
    RosWriter<ros::Twist> writer(dut.domain(), "/lab/robot1/cmd_vel", false);
    while (!over) {  // 50 000 per second; fewer on a slow machine, which never has to catch up
      for (int i = 0; i < 50; ++i) writer.write(forward(0.1));
      sent += 50;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  int away = 0;
  int looks = 0;
  ASSERT_TRUE(dut.spinActing(
      60, 0.05,
      [&] {
        calm.write(forward(0.05));
        ++looks;
        away += dut.driven(2, 0.05) ? 0 : 1;
      },
      [&] { return looks >= 60 && sent > 10'000; }));
  EXPECT_TRUE(dut.driven(1, 0.1)) << "the newest counts";
  over = true;
  flood.join();
  RecordProperty("sent", static_cast<int>(sent));
  EXPECT_EQ(away, 0) << "of " << looks;
  EXPECT_THAT(dut.diagnostics(2.5), HasSubstr("too many messages a second: "));
}

TEST(RosGateway, AStopOutranksEveryPublisher) {
  RosGatewayFixture dut(kTwoRobots, true);
  RosWriter<ros::Twist> teleop(dut.domain(), "/lab/robot1/cmd_vel");
  const auto drive = [&] { teleop.write(forward(0.1)); };
  ASSERT_TRUE(dut.spinActing(10, 0.05, drive, [&] { return dut.driven(1, 0.1); }));
  robot_stop_t stop{};
  stop.seq = 1;
  const auto stopping = [&] {
    drive();
    stop.utime = 0;
    dut.node().publishCommand(channels::kRobotStop, stop);
  };
  ASSERT_TRUE(dut.spinActing(3, 0.1, stopping, [&] { return dut.driven(1, 0); }));
  int moved = 0;
  dut.spinActing(1, 0.02, [&] {
    drive();
    moved += dut.driven(1, 0) ? 0 : 1;
  });
  EXPECT_EQ(moved, 0) << "the stop is latched";
  stop.clear = 1;
  EXPECT_TRUE(dut.spinActing(3, 0.1, stopping, [&] { return dut.driven(1, 0.1); }));
}

TEST(RosGateway, ProgramsAndLightFollowTheirCommands) {
  RosGatewayFixture dut(kTwoRobots, true);
  std::optional<light_command_t> light;
  dut.node().subscribe<light_command_t>(channels::kLightCommand,
                                        [&](const light_command_t& command) { light = command; });
  RosWriter<ros::String> program(dut.domain(), "/lab/robot1/program");
  RosWriter<ros::ProgramCommand> group(dut.domain(), "/lab/program");
  RosWriter<ros::Float64> level(dut.domain(), "/lab/light");
  RosWriter<ros::LightCommand> lights(dut.domain(), "/lab/light");
  ASSERT_TRUE(dut.spin(10, [&] {
    return program.matching().peers > 0 && group.matching().peers > 0 &&
           level.matching().peers > 0 && lights.matching().peers > 0 && dut.inScript(1) &&
           dut.inScript(2);
  }));
  static char straight[] = "straight";
  static char nothing[] = "nothing";
  static char release[] = "";
  program.write({straight});
  EXPECT_TRUE(dut.spin(3, [&] { return dut.driven(1, 0.02); }));
  EXPECT_FALSE(dut.spin(1.5, [&] { return !dut.driven(1, 0.02); })) << "it stays";
  program.write({nothing});
  program.write({release});
  EXPECT_TRUE(dut.spin(3, [&] { return dut.inScript(1); }));

  ros::ProgramCommand stand{};
  group.write(stand);
  EXPECT_TRUE(dut.spin(3, [&] { return dut.driven(1, 0) && dut.driven(2, 0); }));
  stand.mode = 1;
  group.write(stand);
  EXPECT_TRUE(dut.spin(3, [&] { return dut.inScript(1) && dut.inScript(2); }));

  level.write({0.75});
  ASSERT_TRUE(dut.spin(3, [&] { return light.has_value(); }));
  EXPECT_EQ(light->sender, "dds_gateway");
  EXPECT_EQ(light->priority, light_command_t::MANUAL);
  EXPECT_EQ(light->layers.at(0).intensity, 0.75);
  dut.spin(0.5);  // another publisher may command now
  ros::LightCommand back{};
  back.label = release;
  back.release = true;
  lights.write(back);
  EXPECT_TRUE(dut.spin(3, [&] { return light->release == 1; }));
}

constexpr char kCreep[] = "[phases.creep]\nforward = \"1 cm/s\"\nhold = \"1 s\"\n";

TEST(RosGateway, ATextOfAProgramIsCompiledAndRuns) {
  RosGatewayFixture dut(withGatewayLine("load_programs = true").c_str(), true);
  RosWriter<ros::String> program(dut.domain(), "/lab/robot1/program");
  ASSERT_TRUE(dut.spin(10, [&] { return program.matching().peers > 0 && dut.inScript(1); }));
  std::string creep = kCreep;
  program.write({creep.data()});
  EXPECT_TRUE(dut.spin(3, [&] { return dut.driven(1, 0.01); }));
  EXPECT_EQ(dut.state(1).program.name, "ros");
  EXPECT_NE(dut.state(1).program.hash, 0);
  EXPECT_TRUE(dut.inScript(2));

  std::string wrong = "[phases.creep]\nforward = \"1 s\"\nhold = \"1 s\"\n";
  program.write({wrong.data()});
  EXPECT_TRUE(dut.spin(3, [&] {
    return dut.lastError().find("program of ROS 2 refused: ROS 2:2:12: phases.creep.forward: ") ==
           0;
  })) << dut.lastError();
  std::string fast = "[phases.creep]\nforward = \"30 cm/s\"\nhold = \"1 s\"\n";
  program.write({fast.data()});
  EXPECT_FALSE(dut.spin(0.5, [&] { return !dut.driven(1, 0.01); })) << "it keeps its program";
}

TEST(RosGateway, ATextOfAProgramIsRefusedUnlessTheExperimentAllowsIt) {
  RosGatewayFixture dut(kTwoRobots, true);
  RosWriter<ros::String> program(dut.domain(), "/lab/robot1/program");
  ASSERT_TRUE(dut.spin(10, [&] { return program.matching().peers > 0 && dut.inScript(1); }));
  std::string creep = kCreep;
  program.write({creep.data()});
  EXPECT_TRUE(dut.spin(3, [&] {
    return dut.lastError().find("gateway.load_programs") != std::string::npos;
  })) << dut.lastError();
  EXPECT_TRUE(dut.inScript(1));
}

/// The output of a gateway that ends with "bad input"; empty if it ends otherwise.
std::string refusal(const std::string& experiment, const std::string& name, const std::string& file,
                    const std::string& options = "") {
  TemporaryFolder folder;
  std::ofstream(folder / "e.toml") << experiment;
  if (!name.empty()) std::ofstream(folder / name) << file;
  const std::string output = (folder / "output").string();
  Program program({"/bin/sh", "-c",
                   "exec timeout 20 " + std::string(LAB_PROGRAMS) + "/dds_gateway --experiment " +
                       (folder / "e.toml").string() + " --lcm-url '" + lcmUrl(7902) + "' " +
                       options + " 2> " + output});
  if (program.wait() != 2) return "";
  std::ifstream stream(output);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(RosGateway, RefusesFilesThatItCannotUse) {
  const auto with = [](const std::string& line) {
    std::string text = kTwoRobots;
    const std::string commands = "commands = true\n";
    return text.replace(text.find(commands), commands.size(), line + "\n");
  };
  // An element of a newer Cyclone.
  EXPECT_THAT(
      refusal(with(""), "c.xml", "<CycloneDDS><Domain><Nonsense>1</Nonsense></Domain></CycloneDDS>",
              "--dds-configuration c.xml"),
      ::testing::AllOf(HasSubstr("--dds-configuration"), HasSubstr("c.xml"),
                       HasSubstr("Nonsense")));
  EXPECT_THAT(refusal(with(""), "", "", "--dds-configuration none.xml"),
              HasSubstr("none.xml: cannot be read"));
  EXPECT_THAT(refusal(with(""), "", "", "--dds-configuration /dev/zero"),
              HasSubstr("/dev/zero: found a device"));
  EXPECT_THAT(refusal(with("mapping = \"/dev/zero\""), "", ""),
              HasSubstr("/dev/zero: found a device"));
  EXPECT_THAT(refusal(with("mapping = \"m.toml\""), "m.toml", "fileversion = 1\nrule = 1\n"),
              HasSubstr("m.toml:2: rule: found an unknown key"));
  EXPECT_THAT(refusal(with("mapping = \"m.toml\""), "m.toml",
                      "fileversion = 1\n[[rules]]\ntopic = \"/lab/.*\"\nrename = \"/9\"\n"),
              HasSubstr("gateway.mapping: the rule /lab/.* makes \"/9\" of /lab/"));
  // A configuration loads any library that it names, so that a file may not name one.
  const TemporaryFolder loaded;
  EXPECT_THAT(
      refusal(with("configuration = \"c.xml\""), "c.xml",
              "<CycloneDDS><Domain><Tracing><Verbosity>config</Verbosity><OutputFile>" +
                  (loaded / "trace").string() + "</OutputFile></Tracing></Domain></CycloneDDS>"),
      HasSubstr("gateway.configuration: found \"c.xml\", which can run code"));
  EXPECT_FALSE(std::filesystem::exists(loaded / "trace"));
  EXPECT_THAT(refusal(with("address = \"10.99.99.99\""), "", ""), HasSubstr("gateway.address: "));
}

}  // namespace
}  // namespace lab::gateway::ros_gateway_test
