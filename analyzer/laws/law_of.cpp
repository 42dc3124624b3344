#include "analyzer/laws/law_of.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "analyzer/laws.hpp"
#include "analyzer/laws/closed_forms.hpp"

namespace lab::analysis {
namespace {

/// A program without a law.
class NoLaw : public Law {
 public:
  NoLaw(const std::string& program, double wheel_base, std::string reason)
      : Law(program.empty() ? "program" : program, {}, wheel_base), reason_(std::move(reason)) {}

  [[nodiscard]] std::string title() const override { return "no law"; }
  [[nodiscard]] std::string whyNoVerdict() const override { return reason_; }
  [[nodiscard]] std::string characteristicEstimate() const override { return "v"; }

 private:
  std::string reason_;
};

ProgramLaw without(const Program& program, double wheel_base, const std::string& reason) {
  return ProgramLaw(std::make_shared<const NoLaw>(program.name, wheel_base, reason), program.hash);
}

}  // namespace

ProgramLaw lawOf(const Program& program, double wheel_base) {
  if (program.hash == 0) return {};
  const LawText& text = program.law;
  if (!text.name.empty()) {
    try {
      return ProgramLaw(closedForm(text.name, text.parameters, wheel_base), program.hash);
    } catch (const std::invalid_argument& problem) {
      return without(program, wheel_base, problem.what());
    }
  }
  if (program.reads_surroundings) {
    return without(program, wheel_base,
                   "The program reads light, infrared sensors or senses, so its motion depends on "
                   "the surroundings and has no law in free space.");
  }
  return without(program, wheel_base, "The program has no law.");
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

ProgramLaw lawOfUnknown(std::uint32_t hash, const std::string& name, double wheel_base) {
  Program program;
  program.hash = hash;
  program.name = name;
  return without(program, wheel_base, "The definition of the program is not known.");
}

}  // namespace lab::analysis
