#include "analyzer/laws/law_of.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <vector>

#include "analyzer/laws.hpp"
#include "analyzer/laws/closed_forms.hpp"
#include "analyzer/laws/own_laws.hpp"

namespace lab::analysis {
namespace {

ProgramLaw without(const Program& program, double wheel_base, const std::string& reason) {
  return ProgramLaw(makeNoLaw(program, wheel_base, reason), program.hash);
}

/// Why the motion has no law in free space; empty: it has one.
std::string dependence(const Program& program) {
  if (program.reads_surroundings) {
    return "The program reads light, infrared sensors or senses, so its motion depends on the "
           "surroundings and has no law in free space.";
  }
  if (readsInput(program.code, dynamics::kBattery)) {
    return "The program reads the battery, so its motion depends on the charge.";
  }
  if (readsInput(program.code, dynamics::kId)) {
    return "The program reads the robot's number, so each robot moves in another way.";
  }
  // phase_time and heading begin anew, so that the motion becomes stationary; these grow.
  if (readsInput(program.code, dynamics::kTime) || readsInput(program.code, dynamics::kDistance)) {
    return "The program reads the time or the distance since its start, so it moves differently "
           "early and late, and contacts with walls and robots and each change of the program "
           "select which part of its motion is seen.";
  }
  return {};
}

/// The law with the speed that the motors can do. One that is always the same lies between their
/// steps; those of draws nearly average out.
ProgramLaw atSteps(const ProgramLaw& law, const Program& program, const RobotBody& body) {
  constexpr double kSignificance = 4;
  if (!body.pwm_steps || program.code.empty() || law->speedParameter().empty()) return law;
  if (!(law->meanSpeed() > 0)) return law;
  const SpeedSteps steps =
      speedSteps(std::make_shared<const std::vector<std::uint8_t>>(program.code), body);
  const bool shifted = std::abs(steps.relative) > kSignificance * steps.sigma;
  const double speed = law->meanSpeed() * (shifted ? 1 + steps.relative : 1);
  return law.withSpeed(speed).withSpeedScatter(steps.scatter);
}

}  // namespace

ProgramLaw lawOf(const Program& program, double wheel_base) {
  RobotBody body;
  body.wheel_base = wheel_base;
  return lawOf(program, body);
}

ProgramLaw lawOf(const Program& program, const RobotBody& body) {
  if (program.hash == 0) return {};
  const LawText& text = program.law;
  const bool names_law = !text.name.empty() || !text.msd.empty() || !text.angular_msd.empty();
  if (const std::string reason = dependence(program); !reason.empty()) {
    return without(program, body.wheel_base,
                   reason + (names_law ? " The law that its file gives is not used." : ""));
  }
  try {
    if (!text.name.empty()) {
      const ProgramLaw law(closedForm(text.name, text.parameters, body.wheel_base), program.hash);
      return atSteps(law, program, body);
    }
    if (!text.msd.empty() || !text.angular_msd.empty()) {
      return ProgramLaw(makeFormulaLaw(program, body), program.hash);
    }
  } catch (const std::exception& problem) {
    return without(program, body.wheel_base, problem.what());
  }
  std::shared_ptr<const Law> law = makeSimulatedLaw(program, body);
  if (law->motion() == nullptr) {
    return without(program, body.wheel_base,
                   "The program holds its wheel speeds for ever, so there is nothing to judge.");
  }
  return ProgramLaw(std::move(law), program.hash);
}

std::string coefficientsText(const Program& program, double wheel_base) {
  constexpr double kCm = 100;
  const ProgramLaw law = lawOf(program, wheel_base);
  const ExactLaw exact(law);
  std::string text;
  const auto add = [&text](const char* name, double value, const char* unit) {
    if (!std::isfinite(value)) return;
    std::array<char, 80> part{};
    std::snprintf(part.data(), part.size(), "%s%s = %.4g %s", text.empty() ? "" : ", ", name, value,
                  unit);
    text += part.data();
  };
  if (law->rotationalDiffusivity() == 0) return "drives straight";
  if (const auto runs = law->runs()) add("mean run", runs->speed / runs->rate * kCm, "cm");
  add("D_r", law->rotationalDiffusivity(), "rad^2/s");
  add(law->isDiffusive() ? "D" : "D_t", law->translationalDiffusivity() * kCm * kCm, "cm^2/s");
  if (!law->held()) add("D", exact.diffusivity() * kCm * kCm, "cm^2/s");
  if (law->held()) add("L_s", exact.persistenceLength() * kCm, "cm");
  return text;
}

std::string referenceText(const Program& program, double wheel_base) {
  const ProgramLaw law = lawOf(program, wheel_base);
  if (!law.known()) return "not judged: it stands";
  std::string reason = law->whyNoVerdict();
  if (reason.empty()) return "judged by " + law->reference();
  if (reason.ends_with('.')) reason.pop_back();
  if (reason.starts_with("The ")) reason[0] = 't';
  return "not judged: " + reason;
}

ProgramLaw lawOfUnknown(std::uint32_t hash, const std::string& name, double wheel_base) {
  Program program;
  program.hash = hash;
  program.name = name;
  return without(program, wheel_base, "The definition of the program is not known.");
}

}  // namespace lab::analysis
