#include "analyzer/laws/own_laws.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include "analyzer/laws/si_dimension.hpp"
#include "robot/language/formula.hpp"

namespace lab::analysis {
namespace {

constexpr double kCmPerMetre = 100;

class NoLaw : public Law {
 public:
  NoLaw(const Program& program, double wheel_base, std::string reason)
      : Law(program.name.empty() ? "program" : program.name, {}, wheel_base),
        reason_(std::move(reason)) {}

  [[nodiscard]] std::string title() const override { return "no law"; }
  [[nodiscard]] std::string whyNoVerdict() const override { return reason_; }
  [[nodiscard]] std::string characteristicEstimate() const override { return "v"; }

 private:
  std::string reason_;
};

std::vector<LawParameter> parametersOf(const Program& program) {
  std::vector<LawParameter> parameters;
  for (const ProgramParameter& one : program.parameters) {
    parameters.push_back({one.name, one.name, one.unit, one.value});
  }
  return parameters;
}

/// The parameters in the units of programs.
std::vector<language::Parameter> languageParameters(const Program& program) {
  std::vector<language::Parameter> parameters;
  for (const ProgramParameter& one : program.parameters) {
    const language::Dimension dimension = dimensionOf(one.unit);
    parameters.push_back(
        {one.name, one.value * std::pow(kCmPerMetre, dimension.length), dimension});
  }
  return parameters;
}

/// What laws have in common that know the byte code.
class ProgramCodeLaw : public Law {
 public:
  ProgramCodeLaw(const Program& program, const RobotBody& body)
      : Law(program.name, parametersOf(program), body.wheel_base),
        code_(std::make_shared<const std::vector<std::uint8_t>>(program.code)),
        body_(body),
        free_(!program.reads_surroundings),
        hold_(holdFacts(code_, body)) {}

  [[nodiscard]] bool equals(const Law& other) const override {
    const auto* same = dynamic_cast<const ProgramCodeLaw*>(&other);
    return same != nullptr && Law::equals(other) && *code_ == *same->code_ && body_ == same->body_;
  }
  [[nodiscard]] double drawTime() const override { return hold_.mean; }
  [[nodiscard]] double changeTime() const override { return hold_.mean; }
  [[nodiscard]] double longestChange() const override { return 8 * hold_.mean; }
  [[nodiscard]] double steadyHold() const override {
    return hold_.turning_scatter > 0 ? hold_.constant : 0;
  }
  [[nodiscard]] double relativeAngularError(double tau, double observed) const override {
    return std::sqrt((4 * tau / 3 + hold_.turning_scatter) / observed);
  }
  [[nodiscard]] std::string characteristicEstimate() const override { return "v"; }
  [[nodiscard]] std::unique_ptr<Motion> motion() const override {
    return free_ && std::isfinite(hold_.mean) ? programMotion(code_, body_) : nullptr;
  }

 private:
  ByteCode code_;
  RobotBody body_;
  bool free_;
  HoldFacts hold_;
};

class FormulaCurves : public LawCurves {
 public:
  using Formula = std::optional<language::Formula>;

  FormulaCurves(Formula msd, Formula angular, double diffusivity)
      : msd_(std::move(msd)), angular_(std::move(angular)), diffusivity_(diffusivity) {}

  [[nodiscard]] double msd(double tau) const override {
    return msd_ ? (*msd_)(tau) / (kCmPerMetre * kCmPerMetre) : units::kNan;
  }
  [[nodiscard]] double angularMsd(double tau) const override {
    return angular_ ? (*angular_)(tau) : units::kNan;
  }
  /// Half the second derivative of the MSD, by differences.
  [[nodiscard]] double velocityCorrelation(double s) const override {
    const double step = 1e-3 * s + 1e-5;
    return (msd(s + step) - 2 * msd(s) + msd(std::abs(s - step))) / (2 * step * step);
  }
  [[nodiscard]] double diffusivity() const override { return diffusivity_; }

 private:
  Formula msd_;
  Formula angular_;
  double diffusivity_;
};

class FormulaLaw : public ProgramCodeLaw {
 public:
  FormulaLaw(const Program& program, const RobotBody& body)
      : ProgramCodeLaw(program, body), text_(program.law) {
    const std::vector<language::Parameter> parameters = languageParameters(program);
    const auto formula = [&](const std::string& key, const std::string& text) {
      return text.empty() ? FormulaCurves::Formula()
                          : language::Formula(text, parameters, language::formulaDimension(key),
                                              language::isCurve(key));
    };
    if (const auto d_r = formula("D_r", text_.rotational_diffusivity)) d_r_ = (*d_r)();
    double diffusivity = units::kNan;
    if (const auto d = formula("D", text_.diffusivity)) {
      diffusivity = (*d)() / (kCmPerMetre * kCmPerMetre);
    }
    curves_ = std::make_shared<const FormulaCurves>(
        formula("msd", text_.msd), formula("angular_msd", text_.angular_msd), diffusivity);
  }

  [[nodiscard]] bool equals(const Law& other) const override {
    const auto* same = dynamic_cast<const FormulaLaw*>(&other);
    return same != nullptr && ProgramCodeLaw::equals(other) && text_ == same->text_;
  }
  [[nodiscard]] std::string title() const override { return "own formulas"; }
  [[nodiscard]] std::string reference() const override { return "the program's formulas"; }
  [[nodiscard]] std::shared_ptr<const LawCurves> curves(const Turning&) const override {
    return curves_;
  }
  [[nodiscard]] double rotationalDiffusivity() const override { return d_r_; }
  [[nodiscard]] double persistenceTime() const override { return 1 / d_r_; }

 private:
  LawText text_;
  double d_r_ = units::kNan;
  std::shared_ptr<const LawCurves> curves_;
};

class SimulatedLaw : public ProgramCodeLaw {
 public:
  using ProgramCodeLaw::ProgramCodeLaw;

  [[nodiscard]] std::string title() const override { return "simulated reference"; }
  [[nodiscard]] std::string reference() const override { return "the simulated reference"; }
  [[nodiscard]] bool isSimulated() const override { return true; }
};

}  // namespace

std::shared_ptr<const Law> makeNoLaw(const Program& program, double wheel_base,
                                     const std::string& reason) {
  return std::make_shared<const NoLaw>(program, wheel_base, reason);
}

std::shared_ptr<const Law> makeFormulaLaw(const Program& program, const RobotBody& body) {
  return std::make_shared<const FormulaLaw>(program, body);
}

std::shared_ptr<const Law> makeSimulatedLaw(const Program& program, const RobotBody& body) {
  return std::make_shared<const SimulatedLaw>(program, body);
}

}  // namespace lab::analysis
