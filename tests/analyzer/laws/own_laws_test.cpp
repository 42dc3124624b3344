#include "analyzer/laws/own_laws.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "analyzer/laws.hpp"
#include "tests/analyzer/program_films.hpp"

namespace lab::analysis {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Mean and error of a curve over films.
struct Ensemble {
  std::vector<double> mean;
  std::vector<double> error;
};

Ensemble ensembleOf(const ProgramLaw& law, const std::vector<int>& lags, double period,
                    double duration, int films) {
  Ensemble result;
  std::vector<double> sum(2 * lags.size());
  std::vector<double> squares(2 * lags.size());
  RecordingPoses poses;
  for (int film = 0; film < films; ++film) {
    simulateRecording({law, duration, period, 0, 0, 0}, static_cast<std::uint64_t>(film) + 1,
                      poses);
    const std::vector<double> curves = recordingCurves(poses, lags);
    for (std::size_t i = 0; i < curves.size(); ++i) {
      sum[i] += curves[i];
      squares[i] += curves[i] * curves[i];
    }
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double mean = sum[i] / films;
    result.mean.push_back(mean);
    result.error.push_back(std::sqrt((squares[i] / films - mean * mean) / (films - 1)));
  }
  return result;
}

// The byte code in integers follows the law of the closed form.
TEST(ProgramMotion, HasTheCurvesOfTheClosedForms) {
  const std::vector<int> lags{1, 3, 10, 30, 100, 300};
  for (const char* name : {"abp", "noisy_abp", "bp", "rtp"}) {
    const Program program = shippedProgram(name, {}, kWidestWheels);
    const ExactLaw exact(lawOf(program, kPaperWheelBase));
    const ProgramLaw dut = lawOf(withoutLaw(name), kPaperWheelBase);
    ASSERT_TRUE(dut->isSimulated()) << name;
    // A period that does not lock to the holds.
    const double period = 0.0503;
    const Ensemble films = ensembleOf(dut, lags, period, 1200, 100);
    for (std::size_t i = 0; i < lags.size(); ++i) {
      const double tau = lags[i] * period;
      const std::size_t k = lags.size() + i;
      EXPECT_NEAR(films.mean[i], exact.msd(tau), 4 * films.error[i] + 1e-4 * exact.msd(tau))
          << name << " " << tau;
      EXPECT_NEAR(films.mean[k], exact.angularMsd(tau),
                  4 * films.error[k] + 1e-4 * exact.angularMsd(tau))
          << name << " " << tau;
    }
  }
}

TEST(ProgramMotion, KeepsTheStepsOfTheMotors) {
  // 5 cm/s is 47.2 levels of 27 cm/s / 255.
  RobotBody body;
  body.pwm_steps = true;
  const auto motion =
      lawOf(withoutLaw("abp", {{"v", "5 cm/s"}, {"eta", "0 rad/s"}}), body)->motion();
  Random random(1);
  EXPECT_NEAR(motion->first(random).speed, 0.27 * 47 / 255, 1e-12);
}

/// Turns for a second, then stands until it has been in the phase for three.
Program waiting() {
  Program program = toProgram(readProgram(R"(
parameters = {v = "5 cm/s"}
[phases.run]
forward = "v"
hold = "1 s"
next = "wait"
[phases.wait]
hold = "forever"
until = "phase_time >= 3 s"
then = "run"
)",
                                          "waiting.toml", "waiting"));
  return program;
}

TEST(ProgramMotion, LooksAtTheConditionOfAHold) {
  const auto motion = lawOf(waiting(), kPaperWheelBase)->motion();
  ASSERT_NE(motion, nullptr);
  Random random(5);
  double standing = 0;
  double running = motion->first(random).duration;
  int runs = 1;
  while (runs < 20) {
    const Arc arc = motion->next(random);
    if (arc.speed > 0) {
      running += arc.duration;
      ++runs;
    } else {
      standing += arc.duration;
    }
  }
  EXPECT_NEAR(running, 20, 1e-9);
  EXPECT_GE(standing, 19 * 3.0);
  EXPECT_LE(standing, 19 * 3.02);
  // A hold counts once, however often its condition is looked at.
  EXPECT_NEAR(lawOf(waiting(), kPaperWheelBase)->drawTime(), 2, 0.05);
}

Program withFormulas() {
  Program program = withoutLaw("abp", {{"v", "3 cm/s"}, {"eta", "3 rad/s"}, {"epsilon", "0.5 s"}});
  program.law.msd =
      "2*v*v/(epsilon*eta*eta/6*epsilon*eta*eta/6)*"
      "(epsilon*eta*eta/6*tau - 1 + exp(-epsilon*eta*eta/6*tau))";
  program.law.angular_msd =
      "if(tau < epsilon, eta*eta/3*tau*tau*(1 - tau/(3*epsilon)), "
      "epsilon*eta*eta/3*(tau - epsilon/3))";
  program.law.diffusivity = "v*v/(2*epsilon*eta*eta/6)";
  program.law.rotational_diffusivity = "epsilon*eta*eta/6";
  return program;
}

TEST(FormulaLaw, EvaluatesTheFormulasOfTheProgram) {
  const ProgramLaw dut = lawOf(withFormulas(), kPaperWheelBase);
  const ProgramLaw abp =
      lawOf(shippedProgram("abp", {{"v", "3 cm/s"}, {"eta", "3 rad/s"}, {"epsilon", "0.5 s"}}),
            kPaperWheelBase);
  const ExactLaw exact(dut);
  ASSERT_TRUE(exact.exists());
  EXPECT_FALSE(dut->isSimulated());
  EXPECT_DOUBLE_EQ(dut->rotationalDiffusivity(), 0.75);
  EXPECT_DOUBLE_EQ(exact.diffusivity(), 0.03 * 0.03 / 1.5);
  for (const double tau : {0.1, 0.7, 5.0, 60.0}) {
    EXPECT_NEAR(exact.msd(tau) / abp->paperMsd(tau), 1, 1e-12) << tau;
    EXPECT_NEAR(exact.angularMsd(tau) / ExactLaw(abp).angularMsd(tau), 1, 1e-12) << tau;
    EXPECT_NEAR(exact.velocityCorrelation(tau), 9e-4 * std::exp(-0.75 * tau), 1e-8) << tau;
  }
}

TEST(FormulaLaw, SaysWhatIsWrongInAFormula) {
  Program program = withFormulas();
  program.law.msd = "v*tau";
  const ProgramLaw dut = lawOf(program, kPaperWheelBase);
  EXPECT_FALSE(ExactLaw(dut).exists());
  EXPECT_THAT(dut->whyNoVerdict(), HasSubstr("expected a number in cm^2"));
}

TEST(FormulaLaw, IsJudgedLikeAClosedForm) {
  Program program = withFormulas();
  const BlockData film =
      filmOf(withoutLaw("abp", {{"v", "3 cm/s"}, {"eta", "3 rad/s"}, {"epsilon", "0.5 s"}}),
             lawOf(program, kPaperWheelBase), 3);
  // The paper's formula neglects that draws are held: in an hour that is seen.
  const ProgramResult dut = judgeFilm(lawOf(program, kPaperWheelBase), film);
  EXPECT_GE(dut.verdict.judged, 5);
  EXPECT_EQ(dut.verdict.kind, VerdictKind::kDisagrees);
  EXPECT_FALSE(dut.verdict.angular);
  EXPECT_THAT(dut.fit.value().refusal, HasSubstr("no parameters"));
}

// Its angular MSD alone is exact. The noise of the heading is 4 times the turn within a frame.
TEST(FormulaLaw, IsJudgedWithTheNoiseOfTheHeading) {
  const std::vector<language::NamedText> paper{
      {"v", "3 cm/s"}, {"eta", "3 rad/s"}, {"epsilon", "0.5 s"}};
  Program program = withFormulas();
  program.law.msd.clear();
  program.law.diffusivity.clear();
  FilmOptions options;
  options.duration = 900;
  options.sigma_theta = 0.03;
  const ProgramLaw law = lawOf(program, bodyFor(options));
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const BlockData film = filmOf(withoutLaw("abp", paper), law, seed, options);
    for (const ProgramResult& dut :
         {judgeFilm(law, film), analyse(law, film, {}, {}, Depth::kLive)}) {
      EXPECT_GE(dut.verdict.judged, 5);
      EXPECT_EQ(dut.verdict.kind, VerdictKind::kAgrees) << seed << ": " << dut.verdict.max_z;
      EXPECT_NEAR(dut.curves.angular_msd[0].noise / (2 * 0.03 * 0.03), 1, 0.1);
    }
  }
  // Another noise of the motion is still found.
  options.duration = 3600;
  const Program faster =
      withoutLaw("abp", {{"v", "3 cm/s"}, {"eta", "3.2 rad/s"}, {"epsilon", "0.5 s"}});
  const ProgramResult dut = judgeFilm(law, filmOf(faster, law, 3, options));
  EXPECT_EQ(dut.verdict.kind, VerdictKind::kDisagrees);
  EXPECT_TRUE(dut.verdict.angular);
}

TEST(LawOf, GivesTheReasonWhereThereCanBeNoLaw) {
  const auto reason = [](const Program& program) {
    return lawOf(program, kPaperWheelBase)->whyNoVerdict();
  };
  EXPECT_THAT(reason(shippedProgram("phototaxis")), HasSubstr("reads light"));
  EXPECT_THAT(reason(shippedProgram("vicsek")),
              HasSubstr("reads light, infrared sensors or senses"));
  EXPECT_THAT(reason(shippedProgram("wheels")), HasSubstr("for ever"));
  Program unknown = withoutLaw("abp");
  unknown.law.name = "abb";
  EXPECT_THAT(reason(unknown), HasSubstr("found \"abb\", expected one of abp, noisy_abp, bp, rtp"));
  unknown.law = {"abp", {{"v", 0.03}}, "", "", "", ""};
  EXPECT_THAT(reason(unknown), HasSubstr("law \"abp\": parameter epsilon (s) is missing"));
  EXPECT_EQ(reason(withoutLaw("run_reverse")), "");
}

/// A program with one parameter, the law of abp, and an expression that reads something.
Program reading(const std::string& law, const std::string& forward) {
  const std::string text = "law = " + law + R"toml(
parameters = {v = "3 cm/s", epsilon = "0.5 s", eta = "3 rad/s"}
[phases.run]
turn = "uniform(-eta, eta)"
hold = "epsilon"
forward = ")toml" + forward +
                           "\"\n";
  return toProgram(readProgram(text, "reading.toml", "reading"));
}

// A law in free space would be a wrong verdict there.
TEST(LawOf, UsesNoGivenLawWhereTheMotionDependsOnMoreThanTheProgram) {
  const std::string formulas = R"toml({msd = "v*v*tau*tau", angular_msd = "eta*eta*tau*tau"})toml";
  for (const std::string& law : {std::string("\"abp\""), formulas}) {
    ASSERT_TRUE(ExactLaw(lawOf(reading(law, "v"), kPaperWheelBase)).exists()) << law;
    for (const auto& [forward, reason] : std::vector<std::pair<std::string, std::string>>{
             {"v*(0.5 + light)", "reads light"},
             {"v*(0.5 + light_front)", "reads light"},
             {"if(ir(0) > 0.5, 0 cm/s, v)", "reads light, infrared sensors"},
             {"if(sense(0) > 3, 0 cm/s, v)", "infrared sensors or senses"},
             {"if(battery > 3 volt, v, v/2)", "reads the battery"},
             {"if(id > 3, v, v/2)", "reads the robot's number"},
             {"v*time/(time + 60 s)", "contacts with walls and robots and each change"},
             {"if(distance > 1 m, v, v/2)", "the distance since its start"}}) {
      const Program program = reading(law, forward);
      const ProgramLaw dut = lawOf(program, kPaperWheelBase);
      EXPECT_FALSE(ExactLaw(dut).exists()) << law << " " << forward;
      EXPECT_FALSE(dut->isSimulated()) << law << " " << forward;
      EXPECT_THAT(dut->whyNoVerdict(),
                  AllOf(HasSubstr(reason), HasSubstr("The law that its file gives is not used.")));
      EXPECT_THAT(referenceText(program, kPaperWheelBase), HasSubstr("not judged: "));
    }
  }
}

TEST(LawOf, GivesNoVerdictForAFilmOfAProgramThatReadsLightAndNamesALaw) {
  const ProgramLaw law = lawOf(reading("\"abp\"", "v*(0.5 + light)"), kPaperWheelBase);
  const ProgramResult dut = judgeFilm(law, filmOf(withoutLaw("abp"), law, 3, {.duration = 600}));
  EXPECT_EQ(dut.verdict.kind, VerdictKind::kUndecided);
  EXPECT_EQ(dut.verdict.judged, 0);
}

TEST(LawOf, SaysBeforeARunWhatTheMotionIsComparedWith) {
  const auto text = [](const Program& program) { return referenceText(program, kPaperWheelBase); };
  EXPECT_EQ(text(shippedProgram("abp")), "judged by the exact law");
  EXPECT_EQ(text(withoutLaw("abp")), "judged by the simulated reference");
  EXPECT_EQ(text(withFormulas()), "judged by the program's formulas");
  EXPECT_THAT(text(shippedProgram("phototaxis")),
              HasSubstr("not judged: the program reads light, infrared sensors or senses"));
}

TEST(LawOf, TellsProgramsApart) {
  const ProgramLaw abp = lawOf(withoutLaw("abp"), kPaperWheelBase);
  EXPECT_EQ(abp, lawOf(withoutLaw("abp"), kPaperWheelBase));
  EXPECT_FALSE(abp == lawOf(withoutLaw("abp", {{"v", "4 cm/s"}}), kPaperWheelBase));
  EXPECT_FALSE(abp == lawOf(shippedProgram("abp"), kPaperWheelBase));
  EXPECT_FALSE(abp == lawOf(withoutLaw("abp"), 0.08));
}

}  // namespace
}  // namespace lab::analysis
