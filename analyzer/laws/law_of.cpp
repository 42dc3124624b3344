#include "analyzer/laws/law_of.hpp"

#include "analyzer/laws/closed_forms.hpp"

namespace lab::analysis {

ProgramLaw lawOf(const dynamics::RobotProgram& program, double wheel_base) {
  LawText text;
  switch (program.kind) {
    case dynamics::kAbp:
      text.name = "abp";
      text.parameters = {{"v", program.v}, {"epsilon", program.epsilon}, {"eta", program.eta}};
      break;
    case dynamics::kNoisyAbp:
      text.name = "noisy_abp";
      text.parameters = {{"va", program.va}, {"V", program.V}, {"epsilon", program.epsilon}};
      break;
    case dynamics::kBp:
      text.name = "bp";
      text.parameters = {{"V", program.V}, {"epsilon", program.epsilon}};
      break;
    case dynamics::kRtp:
      text.name = "rtp";
      text.parameters = {{"v", program.v}, {"gamma", program.gamma}, {"tau_t", program.tau_t}};
      break;
    default:
      break;
  }
  return lawOf(text, wheel_base);
}

ProgramLaw lawOf(const LawText& text, double wheel_base) {
  return text.name.empty() ? ProgramLaw() : closedForm(text.name, text.parameters, wheel_base);
}

}  // namespace lab::analysis
