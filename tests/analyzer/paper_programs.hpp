#pragma once

#include "analyzer/laws.hpp"

namespace lab::analysis {

// Programs of the paper's figures, SI units.

inline ProgramLaw abpLaw(double eta, double epsilon, double v = 0.03) {
  ProgramLaw law;
  law.kind = ProgramKind::kAbp;
  law.v = v;
  law.eta = eta;
  law.epsilon = epsilon;
  return law;
}

/// Noisy ABP, or BP for va = 0.
inline ProgramLaw noisyLaw(double va, double amplitude, double epsilon) {
  ProgramLaw law;
  law.kind = va == 0 ? ProgramKind::kBp : ProgramKind::kNoisyAbp;
  law.va = va;
  law.V = amplitude;
  law.epsilon = epsilon;
  return law;
}

inline ProgramLaw rtpLaw(double gamma, double tau_t, double v = 0.05) {
  ProgramLaw law;
  law.kind = ProgramKind::kRtp;
  law.v = v;
  law.gamma = gamma;
  law.tau_t = tau_t;
  return law;
}

}  // namespace lab::analysis
