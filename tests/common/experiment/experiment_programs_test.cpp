// Programs of motion in experiment files (docs/programs.md).
#include <gmock/gmock.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/experiment/program_messages.hpp"
#include "common/programs/program_library.hpp"
#include "robot/dynamics/byte_code.hpp"
#include "tests/support/experiment_samples.hpp"
#include "tests/support/programs.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::experiment_programs_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kReversing = R"toml(
[programs.mine]
description = "runs, and now and then reverses"
parameters = {v = "5 cm/s", gamma = "0.5 1/s", eta = "23 deg/s", epsilon = "100 ms"}
state = {sign = "1"}

[programs.mine.phases.zigzag]
set = {sign = "if(chance(gamma*epsilon), -sign, sign)"}
forward = "sign*v"
turn = "uniform(-eta, eta)"
hold = "epsilon"
until = "light > 0.5"
then = "away"

[programs.mine.phases.away]
left = "v"
right = "v/2"
hold = "forever"
)toml";

void expectReadBackAsWritten(const Experiment& experiment) {
  const std::string written = writeExperiment(experiment);
  const Experiment back = parseExperiment(written, "written");
  EXPECT_EQ(back, experiment) << written;
  EXPECT_EQ(writeExperiment(back), written);
}

TEST(ExperimentPrograms, AreDefinedInTheFile) {
  const Experiment dut = small(kReversing);

  const Program& program = dut.programs.at("mine");
  EXPECT_EQ(program.name, "mine");
  EXPECT_EQ(program.description, "runs, and now and then reverses");
  EXPECT_THAT(program.phases, ElementsAre("zigzag", "away"));
  EXPECT_EQ(test::parameter(program, "v"), 0.05);
  EXPECT_EQ(test::parameter(program, "gamma"), 0.5);
  EXPECT_NEAR(test::parameter(program, "eta"), 0.4014, 1e-4);
  EXPECT_TRUE(program.reads_surroundings);
  EXPECT_EQ(program.hash, dynamics::programHash(program.code.data(),
                                                static_cast<std::uint8_t>(program.code.size())));
  expectReadBackAsWritten(dut);
}

TEST(ExperimentPrograms, OfAFileDoTheSameAsTheOneItDefines) {
  const Experiment shipped = small("[programs.mine]\nmodel = \"rtp\"\n");
  const Experiment in_place = small(R"toml([programs.mine]
parameters = {v = "5 cm/s", gamma = "3 1/s", tau_t = "0.5 s"}
[programs.mine.phases.run]
forward = "v"
hold = "exponential(1/gamma)"
next = "tumble"
[programs.mine.phases.tumble]
turn = "uniform(-pi, pi) / tau_t"
hold = "tau_t"
next = "run"
)toml");

  EXPECT_EQ(in_place.programs.at("mine").code, shipped.programs.at("mine").code);
  EXPECT_EQ(in_place.programs.at("mine").parameters, shipped.programs.at("mine").parameters);
  EXPECT_FALSE(shipped.programs.at("mine").reads_surroundings);
}

TEST(ExperimentPrograms, OfAModelHaveItsParametersUnlessTheFileGivesOthers) {
  const Experiment dut = small(
      "[programs.whole]\nmodel = \"abp\"\n[programs.mine]\nmodel = \"abp\"\n"
      "v_cm_s = 4\n");

  EXPECT_EQ(dut.programs.at("whole").hash, test::abp(0.05, 0.5, 3).hash);
  EXPECT_EQ(dut.programs.at("mine").hash, test::abp(0.04, 0.5, 3).hash);
  expectReadBackAsWritten(dut);
}

TEST(ExperimentPrograms, TakeParametersAsTextsWithUnits) {
  const Experiment dut = small(R"toml([programs.mine]
model = "abp"
description = "slow"
parameters = {v = "20 mm/s", eta = "90 deg/s"}
)toml");

  const Program& program = dut.programs.at("mine");
  EXPECT_EQ(program.description, "slow");
  EXPECT_EQ(test::parameter(program, "v"), 0.02);
  EXPECT_EQ(test::parameter(program, "epsilon"), 0.5);
  EXPECT_DOUBLE_EQ(test::parameter(program, "eta"), 1.5707963267948966);
  EXPECT_EQ(program.law.name, "abp");
  ASSERT_EQ(program.law.parameters.size(), 3U);
  EXPECT_EQ(program.law.parameters[0].second, 0.02);
  EXPECT_EQ(program.law.parameters[2].second, test::parameter(program, "eta"));
  expectReadBackAsWritten(dut);
}

TEST(ExperimentPrograms, TakeParametersWithEveryUnitInTheKey) {
  const auto parameter = [](const std::string& model, const std::string& key,
                            const std::string& name) {
    return test::parameter(
        small("[programs.mine]\nmodel = \"" + model + "\"\n" + key + "\n").programs.at("mine"),
        name);
  };
  EXPECT_DOUBLE_EQ(parameter("abp", "v_m_s = 0.02", "v"), 0.02);
  EXPECT_DOUBLE_EQ(parameter("abp", "v_mm_s = 20", "v"), 0.02);
  EXPECT_DOUBLE_EQ(parameter("abp", "v_um_s = 20000", "v"), 0.02);
  EXPECT_DOUBLE_EQ(parameter("abp", "epsilon_ms = 400", "epsilon"), 0.4);
  EXPECT_DOUBLE_EQ(parameter("rtp", "gamma_hz = 2", "gamma"), 2);
  EXPECT_DOUBLE_EQ(parameter("rtp", "gamma_per_min = 30", "gamma"), 0.5);
  EXPECT_DOUBLE_EQ(parameter("rtp", "tau_t_s = 0.7", "tau_t"), 0.7);
  EXPECT_NEAR(parameter("abp", "eta_deg_s = 90", "eta"), 1.5708, 1e-4);
  // A number without unit, and its share.
  EXPECT_DOUBLE_EQ(parameter("levy", "exponent = 1.2", "exponent"), 1.2);
  EXPECT_DOUBLE_EQ(parameter("levy", "exponent_percent = 120", "exponent"), 1.2);
}

TEST(ExperimentPrograms, MayStand) {
  const Experiment dut = small("[programs.still]\nmodel = \"stand\"\n");

  EXPECT_EQ(dut.programs.at("still").fastest_wheel, 0);
  expectReadBackAsWritten(dut);
}

TEST(ExperimentPrograms, AreReadFromFilesBesideTheExperiment) {
  const TemporaryFolder folder;
  support::writeFile(
      folder / "spin.toml",
      "parameters = {w = \"1 rad/s\"}\n[phases.turn]\nturn = \"w\"\nhold = \"1 s\"\n");
  support::writeFile(folder / "x.toml", std::string(kSmall) +
                                            "[programs.mine]\nmodel = \"spin.toml\"\n"
                                            "parameters = {w = \"2 rad/s\"}\n");

  const Experiment dut = loadExperiment(folder / "x.toml");

  EXPECT_EQ(dut.programs.at("mine").name, "mine");
  EXPECT_EQ(test::parameter(dut.programs.at("mine"), "w"), 2);
  EXPECT_THAT(writeExperiment(dut), testing::Not(HasSubstr("spin.toml")));
  expectReadBackAsWritten(dut);
}

TEST(ExperimentPrograms, NameTheLineOfAFileBesideTheExperiment) {
  const TemporaryFolder folder;
  support::writeFile(folder / "spin.toml", "[phases.turn]\nturn = \"2 cm\"\nhold = \"1 s\"\n");
  support::writeFile(folder / "x.toml",
                     std::string(kSmall) + "[programs.mine]\nmodel = \"spin.toml\"\n");
  try {
    static_cast<void>(loadExperiment(folder / "x.toml"));
    FAIL() << "was accepted";
  } catch (const ExperimentError& error) {
    EXPECT_THAT(error.problems(), ElementsAre(HasSubstr("spin.toml:2:9: phases.turn.turn: ")));
  }
}

TEST(ExperimentPrograms, AreCheckedAgainstTheWheelsOfTheFile) {
  const std::string fast = "[programs.mine.phases.run]\nforward = \"30 cm/s\"\nhold = \"1 s\"\n";
  EXPECT_THAT(problemsOf(fast),
              ElementsAre(HasSubstr("programs.mine.phases.run: found a wheel speed of 30 cm/s, "
                                    "expected at most 27 cm/s")));
  EXPECT_THAT(problemsOf(fast, {"robot.max_wheel_speed_cm_s=30"}), testing::IsEmpty());
}

TEST(ExperimentPrograms, MayBeChangedOnTheCommandLine) {
  EXPECT_EQ(small(kReversing, {"programs.mine.parameters.v=\"4 cm/s\""})
                .programs.at("mine")
                .parameters[0]
                .value,
            0.04);
  EXPECT_THAT(problemsOf(kReversing, {"programs.mine.parameters.v=\"4 s\""}),
              ElementsAre(HasSubstr("programs.mine.parameters.v: found a number in s, but "
                                    "phases.zigzag.forward needs 'v' to be a number in cm/s")));
}

TEST(ProgramMessages, CarryAProgramThereAndBack) {
  const Program program = small(kReversing).programs.at("mine");

  const program_t message = toMessage(program);

  EXPECT_EQ(message.id.hash, program.hash);
  EXPECT_EQ(message.size, static_cast<std::int16_t>(program.code.size()));
  ASSERT_EQ(message.num_parameters, 4);
  EXPECT_EQ(message.parameters[1].name, "gamma");
  EXPECT_EQ(message.parameters[1].value, 0.5);
  EXPECT_EQ(message.parameters[1].unit, "1/s");
  EXPECT_EQ(toProgram(message), program);
}

TEST(ProgramMessages, RefuseATextThatIsNotThatOfTheByteCode) {
  program_t message = toMessage(test::abp(0.03, 0.5, 3));
  message.text = test::abp(0.04, 0.5, 3).text;
  EXPECT_THROW(static_cast<void>(toProgram(message)), ExperimentError);
  message.text = "no TOML";
  EXPECT_THROW(static_cast<void>(toProgram(message)), ExperimentError);
}

TEST(ProgramMessages, RefuseATextThatIsTooLong) {
  program_t message = toMessage(test::abp(0.03, 0.5, 3));
  const std::string text = message.text;
  const auto fill = [&](std::size_t size) {
    message.text = text + "#" + std::string(size - text.size() - 1, 'x');
  };
  fill(100'000);
  EXPECT_NO_THROW(static_cast<void>(toProgram(message)));
  fill(100'001);
  EXPECT_THAT([&message] { static_cast<void>(toProgram(message)); },
              testing::ThrowsMessage<ExperimentError>(
                  HasSubstr("found a text of 100001 bytes, allowed at most 100000")));
}

TEST(ProgramMessages, NameAProgramAsTheExperimentDoes) {
  const Experiment experiment = small(kReversing);
  program_id_t id = toId(experiment.programs.at("mine"));
  id.name = "other";
  EXPECT_EQ(programName(experiment, id), "mine");
  EXPECT_EQ(findProgram(experiment, id), &experiment.programs.at("mine"));
  id.hash ^= 1;
  EXPECT_EQ(programName(experiment, id), "other");
  EXPECT_EQ(findProgram(experiment, id), nullptr);
  EXPECT_EQ(programName(experiment, program_id_t{}), "standing");
}

TEST(ProgramLibrary, FindsTheByteCodeOfAHash) {
  ProgramLibrary dut;
  const Program abp = test::abp(0.03, 0.5, 3);
  const Program rtp = test::rtp(0.05, 3, 0.5);
  EXPECT_TRUE(dut.add(abp.hash, abp.code));
  EXPECT_TRUE(dut.add(rtp.hash, rtp.code));

  const dynamics::ProgramBytes found = dut.find(rtp.hash);

  EXPECT_EQ(std::vector<std::uint8_t>(found.code, found.code + found.size), rtp.code);
  EXPECT_EQ(dut.find(1).size, 0);
}

TEST(ProgramLibrary, KeepsTheBytesOfAProgramThatIsAddedAgain) {
  ProgramLibrary dut;
  const Program abp = test::abp(0.03, 0.5, 3);
  EXPECT_TRUE(dut.add(abp.hash, abp.code));
  const std::uint8_t* const first = dut.find(abp.hash).code;

  EXPECT_TRUE(dut.add(abp.hash, abp.code));

  EXPECT_EQ(dut.find(abp.hash).code, first) << "a robot may be executing it";
}

TEST(ProgramLibrary, IsBounded) {
  ProgramLibrary dut;
  for (std::uint32_t hash = 1; hash <= ProgramLibrary::kMost; ++hash) {
    ASSERT_TRUE(dut.add(hash, {1, 2, 3}));
  }

  EXPECT_FALSE(dut.add(ProgramLibrary::kMost + 1, {1, 2, 3}));
  EXPECT_TRUE(dut.add(1, {1, 2, 3})) << "is there already";
  EXPECT_EQ(dut.find(ProgramLibrary::kMost + 1).size, 0);
}

}  // namespace
}  // namespace lab::experiment_programs_test
