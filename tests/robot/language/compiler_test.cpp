#include "robot/language/compiler.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/machine.hpp"
#include "robot/language/builtins.hpp"

namespace lab::language {
namespace {

ProgramText activeBrownian() {
  ProgramText text;
  text.name = "abp";
  text.parameters = {{"v", "5 cm/s"}, {"eta", "3 rad/s"}, {"epsilon", "0.5 s"}};
  PhaseText run;
  run.name = "run";
  run.forward = "v";
  run.turn = "uniform(-eta, eta)";
  run.hold = "epsilon";
  text.phases = {run};
  return text;
}

ProgramText runAndTumble() {
  ProgramText text;
  text.name = "rtp";
  text.parameters = {{"v", "5 cm/s"}, {"gamma", "3 1/s"}, {"tau_t", "0.5 s"}};
  PhaseText run;
  run.name = "run";
  run.forward = "v";
  run.hold = "exponential(1/gamma)";
  run.next = "tumble";
  PhaseText tumble;
  tumble.name = "tumble";
  tumble.turn = "uniform(-pi, pi) / tau_t";
  tumble.hold = "tau_t";
  tumble.next = "run";
  text.phases = {run, tumble};
  return text;
}

ProgramText runReverse() {
  ProgramText text;
  text.name = "run_reverse";
  text.parameters = {
      {"v", "5 cm/s"}, {"gamma", "0.5 1/s"}, {"eta", "0.4 rad/s"}, {"epsilon", "0.1 s"}};
  text.state = {{"sign", "1"}};
  PhaseText run;
  run.name = "run";
  run.set = {{"sign", "if(chance(gamma*epsilon), -sign, sign)"}};
  run.forward = "sign*v";
  run.turn = "uniform(-eta, eta)";
  run.hold = "epsilon";
  run.next = "run";
  text.phases = {run};
  return text;
}

std::string firstError(const ProgramText& text) {
  const CompiledProgram program = compile(text);
  return program.ok() ? "" : program.errors[0].key + ": " + program.errors[0].message;
}

TEST(Compiler, WritesByteCodeThatTheMachineAccepts) {
  for (const ProgramText& text : {activeBrownian(), runAndTumble(), runReverse()}) {
    const CompiledProgram program = compile(text);
    ASSERT_TRUE(program.ok()) << firstError(text);
    EXPECT_TRUE(program.warnings.empty()) << program.warnings[0].message;
    EXPECT_EQ(dynamics::checkByteCode(program.code.data(),
                                      static_cast<std::uint16_t>(program.code.size()))
                  .fault,
              dynamics::kValidByteCode);
    EXPECT_NE(program.hash, 0U);
    EXPECT_LT(program.code.size(), 60U);
  }
}

TEST(Compiler, KnowsTheRangesOfAPhase) {
  const CompiledProgram program = compile(activeBrownian());
  ASSERT_EQ(program.phases.size(), 1U);
  EXPECT_NEAR(program.phases[0].left.low, 5 - 3 * 3.75, 1e-9);
  EXPECT_NEAR(program.phases[0].right.high, 5 + 3 * 3.75, 1e-9);
  EXPECT_EQ(program.phases[0].hold.low, 0.5);
  EXPECT_GT(program.phases[0].cost, 0U);
}

TEST(Compiler, StateVariablesHaveTheRangeOfAllTheirValues) {
  // The sign is -1 or 1, so the wheels stay below the limit and there is no warning.
  const CompiledProgram program = compile(runReverse());
  ASSERT_TRUE(program.ok());
  EXPECT_NEAR(program.phases[0].left.magnitude(), 5 + 0.4 * 3.75, 1e-9);
}

/// Executes holds of a program without sensors.
void execute(const CompiledProgram& program, int holds,
             const std::function<void(const dynamics::PhaseResult&, std::uint8_t phase)>& take) {
  dynamics::Machine machine;
  dynamics::Rng rng(3);
  const dynamics::MachineInputs inputs;
  machine.start(program.code.data(), static_cast<std::uint8_t>(program.code.size()), inputs, rng);
  for (int i = 0; i < holds; ++i) {
    const dynamics::PhaseResult result = machine.next(inputs, rng);
    take(result, machine.phase());
  }
  EXPECT_EQ(machine.saturationCount(), 0U);
}

TEST(Compiler, AnActiveBrownianParticleTurnsUniformly) {
  double sum = 0;
  double squares = 0;
  constexpr int kHolds = 200000;
  execute(compile(activeBrownian()), kHolds, [&](const dynamics::PhaseResult& result, int) {
    EXPECT_NEAR((result.left_um_s + result.right_um_s) / 2.0, 50000, 1);
    EXPECT_EQ(result.duration_ms, 500U);
    const double turn = (result.right_um_s - result.left_um_s) / 75000.0;
    EXPECT_LE(std::abs(turn), 3.00002);
    sum += turn;
    squares += turn * turn;
  });
  // Uniform on [-3, 3]: variance 3, fourth moment 81 / 5.
  EXPECT_LT(std::abs(sum / kHolds) / std::sqrt(3.0 / kHolds), 4);
  EXPECT_LT(std::abs(squares / kHolds - 3) / std::sqrt((81.0 / 5 - 9) / kHolds), 4);
}

TEST(Compiler, ARunAndTumbleParticleAlternates) {
  double runs_ms = 0;
  constexpr int kHolds = 200000;
  execute(compile(runAndTumble()), kHolds, [&](const dynamics::PhaseResult& result, int phase) {
    if (phase == 0) {
      EXPECT_EQ(result.left_um_s, 50000);
      EXPECT_EQ(result.right_um_s, 50000);
      runs_ms += result.duration_ms;
    } else {
      EXPECT_EQ(result.left_um_s + result.right_um_s, 0);
      EXPECT_EQ(result.duration_ms, 500U);
    }
  });
  const double runs = kHolds / 2.0;
  EXPECT_LT(std::abs(runs_ms / runs - 1000.0 / 3) / (1000.0 / 3 / std::sqrt(runs)), 4);
}

TEST(Compiler, ARunReverseParticleReversesAtItsRate) {
  int reversals = 0;
  int last = 1;
  constexpr int kHolds = 400000;
  execute(compile(runReverse()), kHolds, [&](const dynamics::PhaseResult& result, int) {
    const int sign = result.left_um_s + result.right_um_s > 0 ? 1 : -1;
    reversals += sign != last ? 1 : 0;
    last = sign;
  });
  const double p = 0.05;
  EXPECT_LT(std::abs(reversals - p * kHolds) / std::sqrt(p * (1 - p) * kHolds), 4);
}

using Change = std::function<void(ProgramText&)>;
struct Wrong {
  const char* name;
  Change change;
  const char* key;
  const char* message;
};

void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.name; }

class WrongProgram : public testing::TestWithParam<Wrong> {};

TEST_P(WrongProgram, IsRefusedWithKeyAndReason) {
  ProgramText text = runReverse();
  GetParam().change(text);
  const CompiledProgram program = compile(text);
  ASSERT_FALSE(program.ok());
  EXPECT_TRUE(program.code.empty());
  EXPECT_EQ(program.errors[0].key, GetParam().key);
  EXPECT_NE(program.errors[0].message.find(GetParam().message), std::string::npos)
      << program.errors[0].message;
  EXPECT_EQ(program.errors[0].message.find('\n'), std::string::npos);
}

PhaseText& run(ProgramText& text) { return text.phases[0]; }

INSTANTIATE_TEST_SUITE_P(
    All, WrongProgram,
    testing::Values(
        Wrong{"unit of a sum", [](ProgramText& p) { run(p).forward = "v + gamma"; },
              "phases.run.forward",
              "'gamma' is a number in 1/s, expected a number in cm/s like 'v'"},
        Wrong{"unit of the speed", [](ProgramText& p) { run(p).forward = "eta"; },
              "phases.run.forward", "is a number in 1/s, expected a number in cm/s"},
        Wrong{"unit of the turn", [](ProgramText& p) { run(p).turn = "v"; }, "phases.run.turn",
              "expected a number in 1/s"},
        Wrong{"unit of the hold", [](ProgramText& p) { run(p).hold = "gamma"; }, "phases.run.hold",
              "expected a number in s"},
        Wrong{"unit of a state", [](ProgramText& p) { run(p).set[0].second = "v"; },
              "phases.run.set.sign", "expected a number without unit"},
        Wrong{"unit of an angle", [](ProgramText& p) { run(p).forward = "v*sin(v)"; },
              "phases.run.forward", "the angle 'v' is a number in cm/s"},
        Wrong{"unit of a probability",
              [](ProgramText& p) { run(p).set[0].second = "if(chance(gamma), 1, 2)"; },
              "parameters.gamma",
              "found a number in 1/s, but phases.run.set.sign needs 'gamma' to be a number without "
              "unit: change the unit here, or the expression there"},
        Wrong{"unit of a probability of two",
              [](ProgramText& p) { run(p).set[0].second = "if(chance(gamma/epsilon), 1, 2)"; },
              "phases.run.set.sign",
              "the probability 'gamma/epsilon' is a number in 1/s^2"},
        Wrong{"root of no square", [](ProgramText& p) { run(p).forward = "sqrt(v)"; },
              "phases.run.forward", "expected a square"},
        Wrong{"unknown name", [](ProgramText& p) { run(p).forward = "w"; }, "phases.run.forward",
              "unknown name 'w'; this program has epsilon, eta, gamma, v, sign, run"},
        Wrong{"unknown function", [](ProgramText& p) { run(p).forward = "log(v)"; },
              "phases.run.forward", "unknown function 'log'; there are if, min"},
        Wrong{"wrong number of arguments", [](ProgramText& p) { run(p).turn = "uniform(eta)"; },
              "phases.run.turn", "has 1 arguments, expected uniform(a, b)"},
        Wrong{"function without brackets", [](ProgramText& p) { run(p).turn = "uniform"; },
              "phases.run.turn", "is a function: write uniform(a, b)"},
        Wrong{"condition as a number", [](ProgramText& p) { run(p).forward = "v * (v > v)"; },
              "phases.run.forward", "is a condition, expected a number beside '*'"},
        Wrong{"number as a condition", [](ProgramText& p) { run(p).forward = "if(v, v, v)"; },
              "phases.run.forward", "expected a condition as the first argument of 'if'"},
        Wrong{"phase as a number", [](ProgramText& p) { run(p).forward = "run"; },
              "phases.run.forward", "found a condition or a phase"},
        Wrong{"number as a phase", [](ProgramText& p) { run(p).next = "1"; }, "phases.run.next",
              "found a number, expected a phase: run"},
        Wrong{"missing phase", [](ProgramText& p) { run(p).next = "tumble"; }, "phases.run.next",
              "unknown name 'tumble'"},
        Wrong{"no phases", [](ProgramText& p) { p.phases.clear(); }, "phases",
              "found no phase, expected at least one"},
        Wrong{"no hold", [](ProgramText& p) { run(p).hold.clear(); }, "phases.run", "has no hold"},
        Wrong{"hold of zero", [](ProgramText& p) { run(p).hold = "0"; }, "phases.run.hold",
              "holds for 0 s, expected 1 ms to 3600 s"},
        Wrong{"hold always below a millisecond",
              [](ProgramText& p) { run(p).hold = "uniform(0, 0.4 ms)"; }, "phases.run.hold",
              "is never longer than 0.4 ms"},
        Wrong{"hold of a third of a millisecond more",
              [](ProgramText& p) { run(p).hold = "33.3 ms"; }, "phases.run.hold",
              "holds for 33.3 ms, expected whole milliseconds such as 33 ms"},
        Wrong{"hold of half a millisecond", [](ProgramText& p) { run(p).hold = "0.5 ms"; },
              "phases.run.hold", "expected whole milliseconds such as 1 ms"},
        Wrong{"unknown key of a law",
              [](ProgramText& p) {
                p.law = {{"msd", "v*v*tau*tau"}, {"D_t", "v*v*epsilon"}};
              },
              "law.D_t", "found an unknown key, allowed: msd, angular_msd, D, D_r"},
        Wrong{"law that cannot be judged",
              [](ProgramText& p) {
                p.law = {{"D", "v*v*epsilon"}};
              },
              "law", "has no formula that can be judged, expected msd or angular_msd"},
        Wrong{"hold too long", [](ProgramText& p) { run(p).hold = "3601 s"; }, "phases.run.hold",
              "holds for 3601 s"},
        Wrong{"negative hold", [](ProgramText& p) { run(p).hold = "uniform(-1 s, 1 s)"; },
              "phases.run.hold", "can be -1 s"},
        Wrong{"wheels too fast", [](ProgramText& p) { run(p).forward = "30 cm/s"; }, "phases.run",
              "found a wheel speed of 31.5 cm/s, expected at most 27 cm/s, which the wheels reach"},
        Wrong{"wheels slightly too fast", [](ProgramText& p) {
                run(p).forward = "27.001 cm/s";
                run(p).turn = "";
              }, "phases.run", "found a wheel speed of 27.001 cm/s, expected at most 27 cm/s"},
        Wrong{"hold slightly too long", [](ProgramText& p) { run(p).hold = "3600.01 s"; },
              "phases.run.hold", "holds for 3600.01 s"},
        Wrong{"probability slightly above 1",
              [](ProgramText& p) { run(p).forward = "if(chance(1.0000001), v, 0)"; },
              "phases.run.forward", "is 1.0000001, expected 0 to 1"},
        Wrong{"too fast after a draw",
              [](ProgramText& p) { run(p).forward = "if(chance(0.5), 30 cm/s, v)"; }, "phases.run",
              "expected at most 27 cm/s"},
        Wrong{"turn too fast",
              [](ProgramText& p) {
                run(p).forward = "v";
                run(p).turn = "uniform(-10, 10) * 1/s";
              },
              "phases.run", "found a wheel speed of"},
        Wrong{"both speed pairs", [](ProgramText& p) { run(p).left = "v"; }, "phases.run",
              "has both wheel speeds"},
        Wrong{"set of a parameter", [](ProgramText& p) { run(p).set[0].first = "v"; },
              "phases.run.set.v", "'v' is not a state variable"},
        Wrong{"then without until", [](ProgramText& p) { run(p).then = "run"; }, "phases.run.then",
              "needs `until`"},
        Wrong{"until is a number", [](ProgramText& p) { run(p).until = "ir(0)"; },
              "phases.run.until", "expected a condition"},
        Wrong{"no such sensor", [](ProgramText& p) { run(p).until = "ir(6) > 0.5"; },
              "phases.run.until", "expected a whole number from 0 to 5"},
        Wrong{"sensor number that is not constant",
              [](ProgramText& p) { run(p).until = "ir(sign) > 0.5"; }, "phases.run.until",
              "expected a whole number from 0 to 5"},
        Wrong{"division by zero", [](ProgramText& p) { run(p).forward = "v / 0"; },
              "phases.run.forward", "division by zero"},
        Wrong{"probability above 1",
              [](ProgramText& p) { run(p).set[0].second = "if(chance(1.5), 1, -1)"; },
              "phases.run.set.sign", "expected 0 to 1"},
        Wrong{"negative mean", [](ProgramText& p) { run(p).hold = "exponential(-1 s)"; },
              "phases.run.hold", "expected more than 0"},
        Wrong{"choose of none", [](ProgramText& p) { run(p).forward = "v * choose(0)"; },
              "phases.run.forward", "choose(n) found n = '0', expected a whole number of 1 or more"},
        Wrong{"choose of no whole number",
              [](ProgramText& p) { run(p).forward = "v * choose(2.5)/4"; }, "phases.run.forward",
              "choose(n) found n = '2.5', expected a whole number"},
        Wrong{"always too fast by a draw",
              [](ProgramText& p) {
                run(p).forward = "v";
                run(p).turn = "choose(5)*10 rad/s - 200 rad/s";
              }, "phases.run",
              "found a wheel speed of 755 cm/s, expected at most 27 cm/s"},
        Wrong{"too fast in one of five draws",
              [](ProgramText& p) {
                run(p).forward = "v";
                run(p).turn = "choose(5)*2 rad/s";
              }, "phases.run",
              "found a wheel speed of 35 cm/s"},
        Wrong{"too fast whatever the light",
              [](ProgramText& p) { run(p).forward = "100 cm/s + light*1 cm/s"; }, "phases.run",
              "found a wheel speed of 101.5 cm/s"},
        Wrong{"too fast by a draw whatever the light",
              [](ProgramText& p) { run(p).forward = "uniform(-40, 40)*1 cm/s + light*1 cm/s"; },
              "phases.run", "found a wheel speed of 41.5 cm/s"},
        Wrong{"too fast with either speed",
              [](ProgramText& p) { run(p).forward = "if(light > 0.5, 40 cm/s, 30 cm/s)"; },
              "phases.run", "found a wheel speed of 31.5 cm/s"},
        Wrong{"mean of a speed too fast",
              [](ProgramText& p) { run(p).forward = "normal(30 cm/s, 1 cm/s)"; }, "phases.run",
              "found a wheel speed of 31.5 cm/s"},
        Wrong{"too fast in light and draw",
              [](ProgramText& p) { run(p).forward = "uniform(-10, 10)*(3 cm/s + light*1 cm/s)"; },
              "phases.run", "found a wheel speed of 31.5 cm/s"},
        Wrong{"hold too long whatever the light",
              [](ProgramText& p) { run(p).hold = "4000 s + light*1 s"; }, "phases.run.hold",
              "can be 4000 s, expected at most 3600 s, or forever"},
        Wrong{"hold over light too long",
              [](ProgramText& p) { run(p).hold = "4000 s/light"; }, "phases.run.hold",
              "can be 4000 s, expected at most 3600 s"},
        Wrong{"mean of a hold too long",
              [](ProgramText& p) { run(p).hold = "exponential(4000 s)"; }, "phases.run.hold",
              "can be 4000 s, expected at most 3600 s"},
        Wrong{"hold negative by a draw whatever the light",
              [](ProgramText& p) { run(p).hold = "uniform(-3 s, 3 s) + light*1 s"; },
              "phases.run.hold", "can be -2 s, expected 0 or more"},
        Wrong{"name of a function", [](ProgramText& p) { p.parameters[0].first = "uniform"; },
              "parameters.uniform", "has a meaning in the language"},
        Wrong{"name of numbered inputs", [](ProgramText& p) { p.state[0].first = "sense"; },
              "state.sense", "has a meaning in the language"},
        Wrong{"Greek name", [](ProgramText& p) { p.parameters[0].first = "tau_\u03b3"; },
              "parameters.tau_\u03b3",
              "expected letters (a to z), digits and _, not a digit first; write tau_gamma"},
        Wrong{"Greek letter in an expression",
              [](ProgramText& p) { run(p).forward = "v*\u03b7/eta"; }, "phases.run.forward",
              "found '\u03b7'; names are written in ASCII; write eta"},
        Wrong{"mean of a draw from a rate",
              [](ProgramText& p) { run(p).hold = "exponential(gamma)"; }, "phases.run.hold",
              "is a number in 1/s, expected a number in s; an exponential draw takes its mean: "
              "write exponential(1/gamma)"},
        Wrong{"power of a unit that is no number",
              [](ProgramText& p) { run(p).forward = "5 cm^v"; }, "phases.run.forward",
              "found 'v', expected a whole number from 1 to 9 as the power of 'cm'"},
        Wrong{"forever in a sum", [](ProgramText& p) { run(p).hold = "forever + 1 s"; },
              "phases.run.hold", "'forever' can only stand alone"},
        Wrong{"forever as a speed", [](ProgramText& p) { run(p).forward = "forever"; },
              "phases.run.forward", "can only be a hold"},
        Wrong{"number too large", [](ProgramText& p) { run(p).forward = "40000 cm/s"; },
              "phases.run.forward", "too large"},
        Wrong{"draw in a parameter",
              [](ProgramText& p) { p.parameters[0].second = "uniform(1, 2)"; }, "parameters.v",
              "expected a number with its unit"},
        Wrong{"reserved name", [](ProgramText& p) { p.parameters[0].first = "cm"; },
              "parameters.cm", "has a meaning in the language"},
        Wrong{"name used twice", [](ProgramText& p) { p.state[0].first = "v"; }, "state.v",
              "is used twice"},
        Wrong{"name with a hyphen", [](ProgramText& p) { p.state[0].first = "a-b"; }, "state.a-b",
              "is not a name"},
        Wrong{"too many states",
              [](ProgramText& p) {
                for (int i = 0; i < 8; ++i) p.state.emplace_back("x" + std::to_string(i), "0");
              },
              "state", "found 9 state variables, a robot has 8"},
        Wrong{"too many phases",
              [](ProgramText& p) {
                for (int i = 0; i < 8; ++i) {
                  p.phases.push_back(run(p));
                  p.phases.back().name = "p" + std::to_string(i);
                }
              },
              "phases", "found 9 phases, a robot has 8"},
        Wrong{"too slow",
              [](ProgramText& p) { run(p).forward = "normal(0,v)+normal(0,v)+normal(0,v)"; },
              "phases.run", "ms on the robot, at most 5 ms"},
        Wrong{"too long",
              [](ProgramText& p) {
                for (int i = 0; i < 7; ++i) {
                  p.phases.push_back(run(p));
                  p.phases.back().name = "p" + std::to_string(i);
                }
              },
              "", "bytes of byte code, expected at most 176"},
        Wrong{"stack too deep",
              [](ProgramText& p) {
                std::string deep = "light";
                for (int i = 0; i < 12; ++i) deep = "light + (" + deep + ")";
                run(p).forward = "v * (" + deep + ") / 100";
              },
              "phases.run", "places on the stack, a robot has 12"},
        Wrong{"unit of a parameter", [](ProgramText& p) { p.parameters[0].second = "5 s"; },
              "parameters.v",
              "found a number in s, but phases.run.forward needs 'v' to be a number in cm/s"},
        Wrong{"parameter without unit", [](ProgramText& p) { p.parameters[1].second = "0.5"; },
              "parameters.gamma",
              "found a number without unit, but phases.run.set.sign needs 'gamma' to be a number "
              "in 1/s"},
        Wrong{"number where a phase is wanted",
              [](ProgramText& p) { run(p).next = "if(chance(0.5), v, run)"; }, "phases.run.next",
              "'v' is a number in cm/s, expected a phase to go to"},
        Wrong{"units of two parameters",
              [](ProgramText& p) {
                p.parameters[0].second = "5 s";
                p.parameters[2].second = "5 s";
              },
              "phases.run.forward", "is a number in s, expected a number in cm/s"},
        Wrong{"power", [](ProgramText& p) { run(p).forward = "v^2"; }, "phases.run.forward",
              "found '^'; only units have powers (cm^2): write a product"},
        Wrong{"power of stars", [](ProgramText& p) { run(p).forward = "v**2"; },
              "phases.run.forward", "found '**'; only units have powers"},
        Wrong{"question mark", [](ProgramText& p) { run(p).forward = "light > 1 ? v : 0"; },
              "phases.run.forward", "found '?'; a choice is written if(condition, a, b)"},
        Wrong{"degrees as a sign", [](ProgramText& p) { run(p).turn = "5\u00b0/s"; },
              "phases.run.turn", "found '\u00b0'; degrees are written 'deg'"},
        Wrong{"decimal comma", [](ProgramText& p) { run(p).forward = "0,5*v"; },
              "phases.run.forward", "found '0,5'; decimals are written with a point: '0.5'"},
        Wrong{"decimal commas in a draw",
              [](ProgramText& p) { run(p).turn = "uniform(-0,5, 0,5)*eta"; }, "phases.run.turn",
              "has 4 arguments, expected uniform(a, b); decimals are written with a point"},
        Wrong{"hertz", [](ProgramText& p) { p.parameters[1].second = "2 Hz"; },
              "parameters.gamma", "found 'Hz' after a number: write 1/s for it; the units are m"},
        Wrong{"kilometres an hour", [](ProgramText& p) { run(p).forward = "5 m/h"; },
              "phases.run.forward", "unknown name 'h': write 60 min for this unit"},
        Wrong{"unknown unit", [](ProgramText& p) { run(p).forward = "5 cn/s"; },
              "phases.run.forward", "found 'cn' after a number, expected a unit (m, cm"},
        Wrong{"unknown name in next", [](ProgramText& p) { run(p).next = "if(chance(0.5), v2, run)"; },
              "phases.run.next", "unknown name 'v2', expected a phase: run"},
        Wrong{"unknown name in the condition of next",
              [](ProgramText& p) { run(p).next = "if(chance(gama*epsilon), run, run)"; },
              "phases.run.next", "unknown name 'gama'; this program has epsilon, eta"},
        Wrong{"draw upside down", [](ProgramText& p) { run(p).turn = "uniform(eta, -eta)"; },
              "phases.run.turn",
              "the draw begins above its end: 'eta' is 0.4 1/s, '-eta' is -0.4 1/s"},
        Wrong{"negative deviation", [](ProgramText& p) { run(p).turn = "normal(0, -eta)"; },
              "phases.run.turn", "the deviation '-eta' is -0.4 1/s, expected 0 or more"},
        Wrong{"no expression", [](ProgramText& p) { run(p).forward = "v +"; }, "phases.run.forward",
              "found the end of the text"}));

struct Doubtful {
  const char* name;
  Change change;
  const char* message;
};

void PrintTo(const Doubtful& doubtful, std::ostream* out) { *out << doubtful.name; }

class DoubtfulProgram : public testing::TestWithParam<Doubtful> {};

TEST_P(DoubtfulProgram, IsCompiledWithAWarning) {
  ProgramText text = runReverse();
  GetParam().change(text);
  const CompiledProgram program = compile(text);
  ASSERT_TRUE(program.ok()) << firstError(text);
  ASSERT_FALSE(program.warnings.empty());
  EXPECT_NE(program.warnings[0].message.find(GetParam().message), std::string::npos)
      << program.warnings[0].message;
}

INSTANTIATE_TEST_SUITE_P(
    All, DoubtfulProgram,
    testing::Values(
        Doubtful{"division by a sensor",
                 [](ProgramText& p) { run(p).forward = "min(v, v*0.1/light)"; },
                 "'light' can be 0"},
        Doubtful{"fast in bright light only",
                 [](ProgramText& p) { run(p).forward = "if(light > 0.5, 30 cm/s, v)"; },
                 "can ask for a wheel speed of"},
        Doubtful{"normal speed", [](ProgramText& p) { run(p).forward = "normal(v, v)"; },
                 "can ask for a wheel speed of"},
        Doubtful{"root of a negative state",
                 [](ProgramText& p) { run(p).forward = "v * sqrt(sign)"; }, "can be negative"},
        Doubtful{"probability of a sensor",
                 [](ProgramText& p) { run(p).forward = "if(chance(2*light), v, 0)"; },
                 "can lie outside 0 to 1"},
        Doubtful{"hold shorter than its evaluation", [](ProgramText& p) { run(p).hold = "2 ms"; },
                 "is 2 ms, but the robot needs up to "},
        Doubtful{"short draws of the hold",
                 [](ProgramText& p) { run(p).hold = "exponential(1 ms)"; },
                 "is 1 ms, but the robot needs up to "},
        Doubtful{"short holds of two phases",
                 [](ProgramText& p) {
                   p.phases.push_back(run(p));
                   p.phases[1].name = "again";
                   run(p).next = "again";
                   run(p).hold = "3 ms";
                   p.phases[1].hold = "1 ms";
                   p.phases[1].next = "run";
                 },
                 "because it computes for at most half of its time"},
        Doubtful{"long hold", [](ProgramText& p) { run(p).hold = "exponential(1000 s)"; },
                 "it is then limited"}));

TEST(Compiler, UnitsHavePowersAsMessagesWriteThem) {
  for (const char* unit : {"cm^2/s", "cm*cm/s", "cm^3/(cm*s)", "cm^2 / s^1", "cm^2*s/s^2"}) {
    ProgramText text = runReverse();
    text.parameters.emplace_back("D", std::string("3 ") + unit);
    run(text).forward = "D/1 cm";
    const CompiledProgram program = compile(text);
    ASSERT_TRUE(program.ok()) << unit << ": " << firstError(text);
    EXPECT_EQ(program.parameters.back().value, 3);
    EXPECT_EQ(unitText(program.parameters.back().dimension), "cm^2/s");
  }
  EXPECT_EQ(unitText({1, -2, -1}), "cm/(s^2*volt)");
}

TEST(Compiler, ADivisorThatCanBeZeroKeepsItsSign) {
  ProgramText text = runReverse();
  run(text).hold = "1 s/light";
  EXPECT_EQ(compile(text).phases[0].hold.low, 1);
  EXPECT_EQ(compile(text).phases[0].hold.high, kLargestNumber);
  run(text).hold = "max(1 s/(0 - light), 1 s)";
  EXPECT_EQ(compile(text).phases[0].hold.low, 1);
  EXPECT_EQ(compile(text).phases[0].hold.high, 1);
}

// A phase may have no duration: what is drawn to be 0 is neither limited nor counted.
TEST(Compiler, DrawnHoldsMayBeZero) {
  for (const char* hold : {"choose(3)*1 s", "if(chance(0.5), 0 s, 1 s)"}) {
    ProgramText text = runReverse();
    run(text).hold = hold;
    const CompiledProgram program = compile(text);
    ASSERT_TRUE(program.ok()) << firstError(text);
    EXPECT_TRUE(program.warnings.empty());
    int zero = 0;
    execute(program, 100, [&](const dynamics::PhaseResult& result, std::uint8_t) {
      zero += result.duration_ms == 0 ? 1 : 0;
    });
    EXPECT_GT(zero, 10);
  }
}

TEST(Compiler, AProgramMayCallItsDirectionSign) {
  EXPECT_TRUE(isReserved("uniform"));
  EXPECT_FALSE(isReserved("sign"));
}

// The robot makes up for a short hold in a long one.
TEST(Compiler, DoesNotWarnOfAShortHoldAmongLongOnes) {
  ProgramText text = runReverse();
  text.phases.push_back(run(text));
  text.phases[1].name = "hop";
  run(text).next = "hop";
  text.phases[1].hold = "1 ms";
  text.phases[1].next = "run";
  const CompiledProgram program = compile(text);
  ASSERT_TRUE(program.ok()) << firstError(text);
  EXPECT_TRUE(program.warnings.empty());
}

// The warning is the machine's own: without it, nothing is lengthened.
TEST(Compiler, WarnsOfHoldsThatTheMachineLengthens) {
  for (int ms = 1; ms <= 12; ++ms) {
    ProgramText text = runReverse();
    run(text).hold = std::to_string(ms) + " ms";
    run(text).set[0].second = "if(chance(0.5), -sign, sign)";
    const CompiledProgram program = compile(text);
    ASSERT_TRUE(program.ok()) << firstError(text);
    dynamics::Machine machine;
    dynamics::Rng rng(3);
    const dynamics::MachineInputs inputs;
    machine.start(program.code.data(), static_cast<std::uint8_t>(program.code.size()), inputs, rng);
    for (int i = 0; i < 1000; ++i) static_cast<void>(machine.next(inputs, rng));
    EXPECT_EQ(machine.saturationCount() > 0, !program.warnings.empty()) << ms;
  }
}

TEST(Compiler, SuggestsNames) {
  const auto nearest = [](std::string_view word, const std::vector<std::string>& words) {
    for (const std::string& one : words) {
      if (one.size() == word.size() + 1 && one.substr(1) == word) return "; did you mean " + one;
    }
    return std::string();
  };
  const auto messageOf = [&](const Change& change) {
    ProgramText text = runReverse();
    change(text);
    const CompiledProgram program = compile(text, dynamics::WheelLimits(), nearest);
    return program.ok() ? "" : program.errors[0].message;
  };
  EXPECT_TRUE(
      messageOf([](ProgramText& p) { run(p).turn = "ta"; }).ends_with("; did you mean eta"));
  EXPECT_TRUE(messageOf([](ProgramText& p) {
                run(p).turn = "qrt(1)*eta";
              }).ends_with("; did you mean sqrt"));
  EXPECT_TRUE(
      messageOf([](ProgramText& p) { run(p).next = "un"; }).ends_with("; did you mean run"));
  EXPECT_TRUE(messageOf([](ProgramText& p) {
                run(p).set[0].first = "ign";
              }).ends_with("; did you mean sign"));
  EXPECT_TRUE(messageOf([](ProgramText& p) {
                p.law = {{"msd", "v*v*au*tau"}};
              }).ends_with("; did you mean tau"));
}

std::vector<std::string> unusedKeys(const ProgramText& text) {
  const CompiledProgram compiled = compile(text);
  EXPECT_TRUE(compiled.ok());
  std::vector<std::string> keys;
  for (const Problem& unused : compiled.unused) keys.push_back(unused.key);
  return keys;
}

TEST(Compiler, WarnsOfPartsThatNothingUses) {
  ProgramText text = runReverse();
  EXPECT_TRUE(unusedKeys(text).empty());
  text.parameters.insert(text.parameters.begin(), {"half", "1 rad"});
  text.parameters.emplace_back("twice", "2*half");
  EXPECT_EQ(unusedKeys(text), (std::vector<std::string>{"parameters.half", "parameters.twice"}));
  text.law = {{"angular_msd", "twice*twice*0 + tau*0/epsilon"}};
  EXPECT_TRUE(unusedKeys(text).empty()) << "a formula uses it, and it uses the other";

  text = runAndTumble();
  text.state = {{"count", "0"}};
  text.phases[0].next = "run";
  EXPECT_EQ(unusedKeys(text), (std::vector<std::string>{"state.count", "phases.tumble"}));
}

TEST(Compiler, WarnsOfConditionsThatAreAlwaysTheSame) {
  const auto with = [](const char* condition) {
    ProgramText text = activeBrownian();
    text.phases[0].until = condition;
    return unusedKeys(text);
  };
  const std::vector<std::string> one{"phases.run.until"};
  for (const char* never : {"light > 1", "light < 0", "ir(0) >= 1.5", "light <= -0.1",
                            "light_front > 0.5 and light > 1", "not (light >= 0)",
                            "light > 1 or ir(2) < 0", "chance(0)"}) {
    EXPECT_EQ(with(never), one) << never;
  }
  for (const char* always : {"light >= 0", "not light > 1", "ir(0) < 2"}) {
    EXPECT_EQ(with(always), one) << always;
  }
  for (const char* sometimes : {"light > 0.999", "light >= 1", "light < 0.001", "chance(0.5)",
                                "light > 0.5 and ir(0) < 0.5", "light == 1"}) {
    EXPECT_TRUE(with(sometimes).empty()) << sometimes;
  }
}

}  // namespace
}  // namespace lab::language
