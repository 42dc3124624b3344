#include "analyzer/laws.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

/// x - 1 + exp(-x), also at small x.
double persistentShape(double x) {
  return x < 1e-3 ? x * x / 2 * (1 - x / 3 * (1 - x / 4 * (1 - x / 5))) : x + std::expm1(-x);
}

/// The MSD of a velocity correlation c0 exp(-rate s).
double exponentialMsd(double c0, double rate, double tau) {
  return rate == 0 ? c0 * tau * tau : 2 * c0 / (rate * rate) * persistentShape(rate * tau);
}

bool definesLaw(const ProgramLaw& law) {
  switch (law.kind) {
    case ProgramKind::kAbp:
      return law.epsilon > 0;
    case ProgramKind::kNoisyAbp:
    case ProgramKind::kBp:
      return law.epsilon > 0 && law.wheel_base > 0;
    case ProgramKind::kRtp:
      return law.gamma > 0 && law.tau_t > 0;
    case ProgramKind::kNone:
    case ProgramKind::kWheels:
      break;
  }
  return false;
}

/// Cached: building a HeldNoise takes thousands of sines, and a live analysis asks for the same few
/// laws repeatedly.
std::shared_ptr<const HeldNoise> heldNoise(const ProgramLaw& law) {
  constexpr std::size_t kKept = 128;  // more than the programs of an analysis
  thread_local std::vector<std::pair<ProgramLaw, std::shared_ptr<const HeldNoise>>> kept;
  thread_local std::size_t oldest = 0;
  for (const auto& [known, noise] : kept) {
    if (known == law) return noise;
  }
  const double va = law.kind == ProgramKind::kBp ? 0.0 : law.va;
  auto noise = std::make_shared<const HeldNoise>(
      law.kind == ProgramKind::kAbp
          ? HeldNoise::uniformTurning(law.v, law.eta, law.epsilon)
          : HeldNoise::uniformWheels(va, law.V, law.wheel_base, law.epsilon));
  if (kept.size() < kKept) {
    kept.emplace_back(law, noise);
  } else {
    kept[oldest] = {law, noise};
    oldest = (oldest + 1) % kKept;
  }
  return noise;
}

}  // namespace

bool isHeldNoise(ProgramKind kind) {
  return kind == ProgramKind::kAbp || kind == ProgramKind::kNoisyAbp || kind == ProgramKind::kBp;
}

double rotationalDiffusivity(const ProgramLaw& law) {
  if (law.kind == ProgramKind::kAbp) {
    return law.epsilon * law.eta * law.eta / 6;
  }
  if (law.kind == ProgramKind::kNoisyAbp || law.kind == ProgramKind::kBp) {
    return law.epsilon * law.V * law.V / (3 * law.wheel_base * law.wheel_base);
  }
  return kNan;
}

double translationalDiffusivity(const ProgramLaw& law) {
  const bool noisy = law.kind == ProgramKind::kNoisyAbp || law.kind == ProgramKind::kBp;
  return noisy ? law.epsilon * law.V * law.V / 24 : kNan;
}

double meanSpeed(const ProgramLaw& law) {
  switch (law.kind) {
    case ProgramKind::kAbp:
    case ProgramKind::kRtp:
      return law.v;
    case ProgramKind::kNoisyAbp:
      return law.va;
    case ProgramKind::kBp:
      return 0;
    case ProgramKind::kNone:
    case ProgramKind::kWheels:
      break;
  }
  return kNan;
}

double neededWheelSpeed(const ProgramLaw& law, double largest_turn) {
  switch (law.kind) {
    case ProgramKind::kAbp:
      return std::abs(law.v) + 0.5 * law.eta * law.wheel_base;
    case ProgramKind::kNoisyAbp:
      return std::abs(law.va) + law.V;
    case ProgramKind::kBp:
      return law.V;
    case ProgramKind::kRtp:
      return std::max(std::abs(law.v), 0.5 * largest_turn * law.wheel_base / law.tau_t);
    case ProgramKind::kNone:
    case ProgramKind::kWheels:
      break;
  }
  return kNan;
}

ExactLaw::ExactLaw(const ProgramLaw& law, const Turning& turning)
    : law_(law), exists_(definesLaw(law)), rtp_(law.v, law.gamma, law.tau_t, turning) {
  if (exists_ && isHeldNoise(law.kind)) held_ = heldNoise(law);
}

double ExactLaw::msd(double tau) const {
  if (!exists_) {
    return kNan;
  }
  return held_ ? held_->msd(tau) : rtp_.msd(tau);
}

double ExactLaw::angularMsd(double tau) const {
  if (!exists_) {
    return kNan;
  }
  return held_ ? held_->angularMsd(tau) : rtp_.angularMsd(tau);
}

double ExactLaw::velocityCorrelation(double s) const {
  if (!exists_) {
    return kNan;
  }
  return held_ ? held_->velocityCorrelation(s) : rtp_.velocityCorrelation(s);
}

double ExactLaw::diffusivity() const {
  if (!exists_) {
    return kNan;
  }
  return held_ ? held_->diffusivity() : rtp_.diffusivity();
}

double ExactLaw::persistenceLength() const {
  if (exists_ && law_.kind == ProgramKind::kAbp && law_.v > 0) {
    // C(l) = g(l / v) and int_0^inf C_v ds = 2 D.
    return 2 * held_->diffusivity() / law_.v;
  }
  return exists_ && law_.kind == ProgramKind::kRtp ? rtp_.persistenceLength() : kNan;
}

double paperMsd(const ProgramLaw& law, double tau) {
  switch (law.kind) {
    case ProgramKind::kAbp:
      return exponentialMsd(law.v * law.v, rotationalDiffusivity(law), tau);
    case ProgramKind::kNoisyAbp:
      return 4 * translationalDiffusivity(law) * tau +
             exponentialMsd(law.va * law.va, rotationalDiffusivity(law), tau);
    case ProgramKind::kBp:
      return 4 * translationalDiffusivity(law) * tau;
    case ProgramKind::kRtp:
      return exponentialMsd(law.v * law.v / (1 + law.gamma * law.tau_t), law.gamma, tau);
    case ProgramKind::kNone:
    case ProgramKind::kWheels:
      break;
  }
  return kNan;
}

double paperAngularMsd(const ProgramLaw& law, double tau) {
  return 2 * rotationalDiffusivity(law) * tau;
}

}  // namespace lab::analysis
