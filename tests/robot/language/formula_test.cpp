#include "robot/language/formula.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "robot/language/compiler.hpp"

namespace lab::language {
namespace {

using testing::HasSubstr;

const Dimension kArea = product(kLength, kLength);
const std::vector<Parameter> kParameters{
    {"v", 5, kSpeed}, {"D_r", 0.5, kRate}, {"L", 200, kLength}};

std::string problemOf(const std::string& text, const Dimension& dimension, bool curve) {
  try {
    const Formula formula(text, kParameters, dimension, curve);
  } catch (const SyntaxError& error) {
    return std::to_string(error.offset()) + ": " + error.what();
  }
  return "none";
}

TEST(Formula, IsEvaluatedInDoublePrecision) {
  const Formula dut("2*v*v/(D_r*D_r)*(D_r*tau - 1 + exp(-D_r*tau))", kParameters, kArea, true);
  for (const double tau : {0.01, 0.5, 3.0, 1e4}) {
    const double x = 0.5 * tau;
    EXPECT_DOUBLE_EQ(dut(tau), 2 * 25 / 0.25 * (x - 1 + std::exp(-x))) << tau;
  }
}

// Numbers of programs end at 32768; those of laws do not.
TEST(Formula, HasNoLimitOfTheRobotsNumbers) {
  const Formula dut("L*L*L*L/(1 cm*1 cm)", kParameters, kArea, false);
  EXPECT_DOUBLE_EQ(dut(), 1.6e9);
}

TEST(Formula, HasTheFunctionsOfPrograms) {
  const auto value = [](const std::string& text) {
    return Formula(text, kParameters, kPure, true)(3);
  };
  EXPECT_DOUBLE_EQ(value("if(tau > 2 s and not (tau > 4 s), 1, 2)"), 1);
  EXPECT_DOUBLE_EQ(value("if(tau < 2 s or tau >= 4 s, 1, 2)"), 2);
  EXPECT_DOUBLE_EQ(value("min(2, max(1, 1.5)) + clamp(7, 0, 4) - abs(-1) + sign(-3)"), 3.5);
  EXPECT_DOUBLE_EQ(value("sqrt(D_r*D_r*tau*tau)"), 1.5);
  EXPECT_DOUBLE_EQ(value("sin(pi/2) + cos(0) + atan2(0, 1)"), 2);
  EXPECT_DOUBLE_EQ(value("pow(2, 10) + log(exp(3))"), 1027);
}

TEST(Formula, ChecksUnitsAndNames) {
  EXPECT_EQ(problemOf("4*v*tau", kArea, true),
            "0: the formula is a number in cm, expected a number in cm^2");
  EXPECT_EQ(problemOf("v*v*tau*tau + L", kArea, true),
            "14: 'L' is a number in cm, expected a number in cm^2 like 'v*v*tau*tau'");
  EXPECT_EQ(problemOf("L*L*exp(-tau)", kArea, true),
            "8: '-tau' is a number in s, expected a number without unit");
  EXPECT_THAT(problemOf("v*v/D_r*uniform(0, 1)", kArea, false),
              HasSubstr("8: unknown function 'uniform'; a formula has if, min"));
  EXPECT_THAT(problemOf("v*v/D_r*tau", quotient(kArea, kTime), false),
              HasSubstr("8: unknown name 'tau'; a formula has v, D_r, L, pi and the units"));
  EXPECT_THAT(problemOf("light*L*L", kArea, true), HasSubstr("a formula has tau (the lag), v"));
  EXPECT_THAT(problemOf("min(1)", kPure, true), HasSubstr("has 1 arguments, expected min(a, b)"));
  EXPECT_THAT(problemOf("if(v, 1, 2)", kPure, true), HasSubstr("expected a condition in if("));
  EXPECT_THAT(problemOf("v > 1 cm/s", kPure, true), HasSubstr("the formula is a condition"));
  EXPECT_EQ(problemOf("0", kArea, true), "none");
}

TEST(Formula, IsCheckedWithItsProgram) {
  ProgramText text;
  text.name = "own";
  text.parameters = {{"v", "5 cm/s"}, {"tau", "1 s"}};
  PhaseText run;
  run.name = "run";
  run.forward = "v";
  run.hold = "tau";
  text.phases = {run};
  text.law = {{"msd", "v*v*tau*tau"}, {"D", "v*v"}};
  const CompiledProgram dut = compile(text);
  ASSERT_EQ(dut.errors.size(), 2U);
  EXPECT_EQ(dut.errors[0].key, "parameters.tau");
  EXPECT_EQ(dut.errors[1].key, "law.D");
  EXPECT_THAT(dut.errors[1].message, HasSubstr("expected a number in cm^2/s"));
}

}  // namespace
}  // namespace lab::language
