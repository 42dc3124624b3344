#pragma once

#include <string>
#include <utility>
#include <vector>

#include "analyzer/laws.hpp"

namespace lab::analysis {

// Programs of the paper's figures, SI units.

inline ProgramLaw abpLaw(double eta, double epsilon, double v = 0.03,
                         double wheel_base = kPaperWheelBase) {
  return closedForm("abp", {{"v", v}, {"epsilon", epsilon}, {"eta", eta}}, wheel_base);
}

/// Noisy ABP, or BP for va = 0.
inline ProgramLaw noisyLaw(double va, double amplitude, double epsilon,
                           double wheel_base = kPaperWheelBase) {
  std::vector<std::pair<std::string, double>> values{{"V", amplitude}, {"epsilon", epsilon}};
  if (va == 0) return closedForm("bp", values, wheel_base);
  values.emplace_back("va", va);
  return closedForm("noisy_abp", values, wheel_base);
}

inline ProgramLaw rtpLaw(double gamma, double tau_t, double v = 0.05) {
  return closedForm("rtp", {{"v", v}, {"gamma", gamma}, {"tau_t", tau_t}}, kPaperWheelBase);
}

}  // namespace lab::analysis
