#include "common/experiment/experiment_describe.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "common/experiment/experiment_log_size.hpp"
#include "tests/support/experiment_samples.hpp"
#include "tests/support/programs.hpp"

namespace lab {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

Experiment shipped(const std::string& name) {
  return loadExperiment(std::filesystem::path(LAB_ROOT) / "experiments" / (name + ".toml"));
}

TEST(Description, ListsWhatWouldStart) {
  const std::string dut = describeExperiment(shipped("light_switching"));

  EXPECT_THAT(dut, HasSubstr("run           90 s, seed 1\n"));
  EXPECT_THAT(dut,
              HasSubstr("robots        6 simulated (1 to 6), 6 at given and 0 at random places\n"));
  EXPECT_THAT(
      dut, HasSubstr("bp: Brownian particle: both wheel speeds are drawn anew every epsilon, with "
                     "mean 0, V = 7 cm/s, epsilon = 0.2 s\n"));
  EXPECT_THAT(dut, HasSubstr("light         3 steps, again every 90 s\n"));
  EXPECT_THAT(dut, HasSubstr("30 s half: ABP: light 0.5, abp\n"));
}

TEST(Description, SaysWhatSensesAre) {
  EXPECT_THAT(
      describeExperiment(shipped("quorum_sensing")),
      HasSubstr("senses        10 times per second, 500 ms after the exposure of the frame\n"
                "                sense(0): neighbours within 20 cm\n"));
  EXPECT_THAT(describeExperiment(shipped("abp")), ::testing::Not(HasSubstr("senses  ")));
}

TEST(Description, GivesTheCoefficientsAndTheFastestWheelOfEachProgram) {
  // |v| + eta d / 2
  EXPECT_THAT(describeExperiment(shipped("abp")),
              HasSubstr("\n                fastest wheel 14.25 of 27 cm/s\n"));
  EXPECT_THAT(describeExperiment(shipped("abp"),
                                 [](const Program& p) {
                                   return "D_r of " + p.name + " with the law " + p.law.name;
                                 }),
              HasSubstr("  D_r of abp with the law abp; fastest wheel 14.25 of"));
  // V + va
  EXPECT_THAT(describeExperiment(shipped("noisy_abp")), HasSubstr("  fastest wheel 11 of"));
  EXPECT_THAT(describeExperiment(shipped("bp")), HasSubstr("  fastest wheel 7 of"));
  // pi d / (2 tau_t)
  EXPECT_THAT(describeExperiment(shipped("rtp")), HasSubstr("  fastest wheel 23.56 of"));
}

TEST(Description, WarnsOfARunTooShortForItsProgram) {
  const auto with = [](const std::string& set) { return describeExperiment(small({}, {set})); };
  EXPECT_THAT(with("programs.abp.epsilon_s=20"), ::testing::Not(HasSubstr("a third of the run")));
  EXPECT_THAT(with("programs.abp.epsilon_s=20.001"),
              HasSubstr("epsilon = 20 s is more than a third of the run"));
  Experiment tumbling = small();
  Program& program = tumbling.programs.begin()->second;
  program = test::rtp(0.05, 0.01, 0.5);
  EXPECT_THAT(describeExperiment(tumbling), HasSubstr("1/gamma = 100 s is more than a third"));
  program = test::rtp(0.05, 3, 500);
  EXPECT_THAT(describeExperiment(tumbling), HasSubstr("tau_t = 500 s is more than a third"));
}

TEST(Description, ListsTheHostsOfServices) {
  EXPECT_THAT(describeExperiment(shipped("two_hosts")),
              HasSubstr("hosts         bench: sim_svc (ssh pi@robot-bench)\n"
                        "              joined by DDS, domain 77, unsecured\n"));
  EXPECT_THAT(describeExperiment(shipped("abp")), ::testing::Not(HasSubstr("hosts")));
}

TEST(Description, GivesThePartOfTheArenaOfEachProgram) {
  EXPECT_THAT(describeExperiment(shipped("half_dark_arena")),
              HasSubstr("light 0.1 to 0.8, abp 50 %, rtp 50 %\n"));
}

TEST(Description, TellsThatALightChanges) {
  EXPECT_THAT(describeExperiment(shipped("travelling_wave")),
              HasSubstr("abp 50 %, bp 50 % at its start; it changes with time\n"));
  EXPECT_THAT(describeExperiment(small("[[light.steps]]\nat_s = 0\nlayers = [{kind = \"disk\", "
                                       "radius_cm = 4, intensity = 1, follow = \"robots\"}]\n")),
              HasSubstr("light 0, abp; without layers that depend on robots\n"));
}

TEST(Description, WarnsOfLightThatSelectsNoProgram) {
  const Experiment dut = small(
      "[[light.steps]]\nat_s = 0\nlayers = [{kind = \"uniform\", "
      "intensity = 0.9}]\n[[light.steps]]\nat_s = 5\nramp_s = 2\nlayers = "
      "[{kind = \"uniform\", intensity = 1}]\n[light_table]\nsensor = "
      "\"front\"\n",
      {"program=abp"});
  Experiment narrow = dut;
  narrow.light_table.bands[0].high = 0.8;

  EXPECT_THAT(describeExperiment(narrow), HasSubstr("light 0.9, no band (robots stand)\n"));
  EXPECT_THAT(describeExperiment(dut), HasSubstr("light 1, abp, fading in for 2 s\n"));
  EXPECT_THAT(describeExperiment(dut), HasSubstr("front sensor"));
}

TEST(Description, TellsWhoCanReachTheBus) {
  EXPECT_THAT(describeExperiment(small()), testing::Not(HasSubstr("\nbus ")));
  EXPECT_THAT(describeExperiment(small("[network]\nttl = 1\n")),
              HasSubstr("\nbus           open to the network (ttl 1): every machine there can read "
                        "it and drive the robots\n"));
  EXPECT_THAT(describeExperiment(small("[network]\nttl = 3\n[services.sim_svc]\nhost = "
                                       "\"pi@bench\"\n[link]\njoin = \"multicast\"\n"
                                       "unsecured = true\n")),
              testing::AllOf(HasSubstr("open to the network (ttl 3)"),
                             HasSubstr("joined by LCM multicast\n")));
}

TEST(Description, TellsWhoCanReachRos2) {
  Experiment experiment = small();
  experiment.gateway.ros = true;
  experiment.gateway.commands = true;
  EXPECT_THAT(describeExperiment(experiment), testing::Not(HasSubstr("unsecured")));
  EXPECT_THAT(describeExperiment(experiment), testing::Not(HasSubstr("warning")));
  experiment.gateway.address = "192.168.1.20";
  experiment.gateway.unsecured_commands = true;
  experiment.gateway.load_programs = true;
  EXPECT_THAT(
      describeExperiment(experiment),
      HasSubstr("by 192.168.1.20, unsecured: every machine there can read it\n"
                "              may set the light, load programs and drive robots: all\n"
                "              warning: taken without DDS Security, so from every machine of that "
                "network\n"));
  experiment.gateway.security = "keys";
  EXPECT_THAT(
      describeExperiment(experiment),
      testing::AllOf(HasSubstr("by 192.168.1.20, secured\n"), testing::Not(HasSubstr("warning"))));
}

TEST(Description, TellsWhatRos2MayDo) {
  Experiment experiment = small();
  EXPECT_THAT(describeExperiment(experiment), testing::Not(HasSubstr("ROS 2")));
  experiment.gateway.ros = true;
  EXPECT_THAT(describeExperiment(experiment), HasSubstr("on this machine only"));
  EXPECT_THAT(describeExperiment(experiment), HasSubstr("may observe, but not drive"));
  experiment.gateway.commands = true;
  experiment.gateway.command_robots = {1};
  EXPECT_THAT(describeExperiment(experiment), HasSubstr("drive robots: 1"));
}

TEST(Description, TellsWhoCanOpenThePage) {
  Experiment experiment = small();
  EXPECT_THAT(describeExperiment(experiment), testing::Not(HasSubstr("dashboard")));
  experiment.dashboard.address = "127.0.0.2";
  EXPECT_THAT(describeExperiment(experiment), testing::Not(HasSubstr("dashboard")));
  experiment.dashboard.address = "0.0.0.0";
  EXPECT_THAT(describeExperiment(experiment), HasSubstr("listens on 0.0.0.0, unencrypted"));
  EXPECT_THAT(describeExperiment(experiment), HasSubstr("buttons work on this machine only"));
  experiment.dashboard.control_from_elsewhere = true;
  EXPECT_THAT(describeExperiment(experiment), HasSubstr("may drive robots and light"));
}

TEST(Description, ListsSeveralCameras) {
  Experiment experiment = small();
  experiment.camera.tracker = Tracker::kCamera;
  experiment.camera.width = 800;
  experiment.camera.height = 640;
  experiment.cameras.resize(2);
  experiment.cameras[0].name = "left";
  experiment.cameras[0].view.width = 0.7;
  experiment.cameras[1].name = "right";
  experiment.cameras[1].view.x = 0.5;
  const std::string text = describeExperiment(experiment);
  EXPECT_THAT(text, HasSubstr("2 cameras\n"));
  EXPECT_THAT(text,
              HasSubstr("left: 800 x 640 pixels, simulated, sees 70 cm x 90 cm from (0, 0) cm"));
  EXPECT_THAT(text,
              HasSubstr("right: 800 x 640 pixels, simulated, sees 70 cm x 90 cm from (50, 0) cm"));
}

TEST(Description, ListsRangesOfIds) {
  EXPECT_THAT(describeExperiment(small("[[robots]]\nid = 5\ncount = 3\n[[robots]]\nid = 9\n")),
              HasSubstr("5 simulated (1, 5 to 7, 9)"));
}

TEST(Description, HasALineForEveryProgram) {
  const std::string dut = describeExperiment(
      small("[programs.still]\nmodel = \"stand\"\n[programs.turn]\nmodel = \"wheels\"\nleft_cm_s = "
            "-4\nright_cm_s = 5\n[reversal]\non = \"never\"\n"));

  EXPECT_THAT(dut, HasSubstr("still: stands still\n"));
  EXPECT_THAT(dut, HasSubstr("turn: constant wheel speeds, left = -4 cm/s, right = 5 cm/s\n"));
  EXPECT_THAT(dut, HasSubstr("fastest wheel 5 of 27"));
  EXPECT_THAT(dut, HasSubstr("reversal      never\n"));
}

TEST(Description, GivesEachParameterInItsUnit) {
  const std::string dut = describeExperiment(small(
      "[programs.mine]\nparameters = {v = \"20 mm/s\", r = \"3 cm\", a = \"90 deg\", area = "
      "\"2 cm*cm\", n = \"2\"}\n[programs.mine.phases.run]\nforward = \"v\"\nhold = \"1 s\"\n"));

  EXPECT_THAT(dut, HasSubstr("mine: v = 2 cm/s, r = 3 cm, a = 1.5708 rad, "));
  EXPECT_THAT(dut, HasSubstr("area = 2 cm², n = 2\n"));
}

TEST(LogSize, GrowsWithTimeAndRobots) {
  const double one = expectedLogBytes(small());
  EXPECT_DOUBLE_EQ(expectedLogBytes(small({}, {"duration_s=120"})), 2 * one);
  const double ten = expectedLogBytes(small({}, {"robots[0].count=10"}));
  EXPECT_GT(ten, 3 * one);
  EXPECT_LT(ten, 10 * one);
}

TEST(LogSize, HasAUnitThatFits) {
  EXPECT_THAT(describeExperiment(small()), ContainsRegex("log +about [0-9]+ MB"));
  EXPECT_THAT(
      describeExperiment(small({}, {"duration_s=864000", "camera.fps=500", "robots[0].count=100"})),
      ContainsRegex("log +about [0-9.]+ TB"));
}

}  // namespace
}  // namespace lab
