#include "analyzer/report/reproduction/reproduction_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analyzer/curves/statistics.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

using analysis::CurvePoint;
using analysis::Estimate;
using analysis::ProgramResult;
using analysis::VerdictKind;
using units::kCm;
using units::kNan;
using units::kPercents;

constexpr double kFloor = 0.002;  // share of the law below which no deviation counts
constexpr double kAgreeZ = 4;
constexpr double kRejects = 1e-3;  // largest p of a rejected formula
constexpr int kMinJudged = 5;

const ProgramResult& resultOf(const SetData& set) { return set.recordings.front().result; }

const std::vector<CurvePoint>& pointsOf(const RecordingData& recording, bool angular) {
  return angular ? recording.result.curves.angular_msd : recording.result.curves.msd;
}

const Estimate* find(const std::vector<Estimate>& estimates, const std::string& name) {
  for (const Estimate& estimate : estimates) {
    if (estimate.name == name) return &estimate;
  }
  return nullptr;
}

/// The square of the measured over the programmed speed, by which the MSD of a program with one
/// speed scales.
double speedScale(const ProgramResult& result) {
  const auto one_speed = result.law->constantSpeed();
  const Estimate* speed = find(result.estimates, "v");
  if (!one_speed || speed == nullptr || !std::isfinite(speed->value)) return 1;
  const double ratio = speed->value / *one_speed;
  return std::abs(ratio - 1) <= analysis::CurveOptions{}.speed_tolerance ? ratio * ratio : 1;
}

double scaleOf(const SetData& set, bool angular) {
  if (angular) return 1;
  double sum = 0;
  for (const RecordingData& recording : set.recordings) sum += speedScale(recording.result);
  return sum / static_cast<double>(set.recordings.size());
}

struct Scatter {
  double mean = kNan;
  double error = kNan;  ///< of the mean
};

Scatter scatterOf(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  Scatter scatter{0, 0};
  for (const double value : values) scatter.mean += value / n;
  for (const double value : values) {
    scatter.error += (value - scatter.mean) * (value - scatter.mean);
  }
  scatter.error = std::sqrt(scatter.error / (n - 1) / n);
  return scatter;
}

bool known(const CurvePoint& point) {
  return point.windows > 0 && std::isfinite(point.value) && point.value > 0;
}

std::string probability(double p) {
  return p < 1e-12  ? "p < 1e-12"
         : p < 1e-3 ? fmt::format("p = {:.0e}", p)
                    : fmt::format("p = {:.2g}", p);
}

/// The deviations of a set, or of several.
struct Deviations {
  double max_z = 0;
  double tau = 0;
  int judged = 0;
  double paper = 0;  ///< largest deviation from the paper's formula, in standard errors
  double paper_tau = 0;
  double off = 0;  ///< largest relative difference of the paper's formula from the exact law
  double off_tau = 0;
};

void addDeviations(const SetData& set, bool angular, double from, Deviations& all) {
  for (const CurvePoint& point : curveOf(set, angular)) {
    if (!known(point) || !point.judged) continue;
    ++all.judged;
    if (std::abs(point.z) > all.max_z) {
      all.max_z = std::abs(point.z);
      all.tau = point.tau;
    }
    if (point.tau < from || !std::isfinite(point.paper)) continue;
    const double off = point.paper / point.exact - 1;
    if (std::abs(off) > std::abs(all.off)) {
      all.off = off;
      all.off_tau = point.tau;
    }
    const double deviation = std::abs(paperDeviation(set, point, angular));
    if (deviation > all.paper) {
      all.paper = deviation;
      all.paper_tau = point.tau;
    }
  }
}

const SetData* findSet(const Reproduction& reproduction, const std::string& id) {
  const auto found = reproduction.find(id);
  return found == reproduction.end() || found->second.recordings.empty() ? nullptr : &found->second;
}

std::string recordingWord(const SetData& set) {
  return set.recordings.size() > 1
             ? fmt::format("{} recordings", set.recordings.size())
             : fmt::format("this recording of {}", durationText(resultOf(set).observed));
}

/// Compares curves with both laws.
PanelVerdict judgeCurves(const PaperPanel& panel, const std::vector<const SetData*>& sets) {
  const bool angular = panel.kind == PanelKind::kAngularMsd;
  PanelVerdict verdict;
  Deviations all;
  std::vector<std::string> exact_p;
  std::vector<std::string> paper;
  bool rejected = false;
  bool tested = false;
  bool differs = false;
  for (const SetData* set : sets) {
    Deviations own;
    const analysis::ProgramLaw& law = resultOf(*set).law;
    // By the paper itself, its straight lines hold above epsilon.
    const bool straight = angular || law->isDiffusive();
    const double hold = law->held().value_or(analysis::HeldDraws{}).hold;
    addDeviations(*set, angular, straight ? 2 * hold : 0, own);
    if (own.max_z > all.max_z) {
      all.max_z = own.max_z;
      all.tau = own.tau;
    }
    all.judged += own.judged;
    const std::string label = sets.size() > 1 ? curveLabel(panel, set->set) + ": " : "";
    const auto& fit = resultOf(*set).fit;
    const bool single = set->recordings.size() == 1;
    if (single && fit && fit->exact && std::isfinite(fit->exact->p_value)) {
      exact_p.push_back(fmt::format("{}{}", label, probability(fit->exact->p_value)));
    }
    if (own.judged == 0 || std::abs(own.off) < 1e-6) continue;
    differs = true;
    std::string comparison =
        fmt::format("{}{:+.{}f} % from the exact law at {} s", label, own.off * kPercents,
                    std::abs(own.off) < 0.1 ? 1 : 0, shortText(own.off_tau));
    if (!angular && single && fit && fit->paper && std::isfinite(fit->paper->p_value)) {
      tested = true;
      const bool out = fit->paper->p_value < kRejects;
      rejected = rejected || out;
      comparison += fmt::format(", {} ({}, {:.1f} σ)", out ? "rejected" : "not rejected",
                                probability(fit->paper->p_value), std::abs(fit->paper->deviate));
    } else {
      tested = true;
      const bool out = own.paper > kAgreeZ;
      rejected = rejected || out;
      comparison +=
          fmt::format(", {} (largest deviation {:.1f} σ, at {} s)",
                      out ? "rejected" : "not rejected", own.paper, shortText(own.paper_tau));
    }
    paper.push_back(comparison);
  }
  verdict.max_z = all.max_z;
  if (all.judged >= kMinJudged) {
    verdict.exact = all.max_z < kAgreeZ ? VerdictKind::kAgrees : VerdictKind::kDisagrees;
  }
  verdict.exact_text = all.judged == 0
                           ? "too few independent windows to judge"
                           : fmt::format("max |z| = {:.1f} (at {} s) of {}", all.max_z,
                                         shortText(all.tau), countText(all.judged, "lag"));
  if (!exact_p.empty()) {
    verdict.exact_text += fmt::format("; test of both curves: {}", fmt::join(exact_p, ", "));
  }
  if (all.judged == 0) {
    verdict.paper = PaperVerdict::kUndecided;
    verdict.paper_text = panel.formula + ": nothing to test it with";
  } else if (!differs) {
    verdict.paper = PaperVerdict::kNotRejected;
    verdict.paper_text = fmt::format("The paper’s {} is the exact law here", panel.formula);
  } else {
    verdict.paper = !tested    ? PaperVerdict::kUndecided
                    : rejected ? PaperVerdict::kRejected
                               : PaperVerdict::kNotRejected;
    verdict.paper_text =
        fmt::format("The paper’s {}{}: {}", panel.formula,
                    angular || resultOf(*sets.front()).law->isDiffusive() ? " from 2 ε on" : "",
                    fmt::join(paper, "; "));
  }
  return verdict;
}

PanelVerdict judgePersistence(const PaperPanel& panel, const std::vector<const SetData*>& sets) {
  PanelVerdict verdict;
  int judged = 0;
  double paper = 0;
  double off = 0;
  for (const SetData* set : sets) {
    const auto length = estimateOf(*set, "L_s");
    if (!length || !std::isfinite(length->value) || !(length->sigma > 0)) continue;
    ++judged;
    const analysis::ProgramLaw& law = resultOf(*set).law;
    const double formula = law->meanSpeed() / law->rotationalDiffusivity();
    verdict.max_z =
        std::max(verdict.max_z, std::abs(length->value - length->theory) / length->sigma);
    paper = std::max(paper, std::abs(length->value - formula) / length->sigma);
    off = std::max(off, std::abs(formula / length->theory - 1));
  }
  if (judged == 0) {
    verdict.exact_text = "no persistence length could be measured";
    return verdict;
  }
  verdict.exact = verdict.max_z < kAgreeZ ? VerdictKind::kAgrees : VerdictKind::kDisagrees;
  verdict.exact_text = fmt::format("L_s as the integral of C(l): max |z| = {:.1f} of {}",
                                   verdict.max_z, countText(judged, "value"));
  verdict.paper = paper > kAgreeZ ? PaperVerdict::kRejected : PaperVerdict::kNotRejected;
  verdict.paper_text = fmt::format(
      "The paper’s {}: at most {:.1f} % from the exact integral, {} (largest deviation {:.1f} σ)",
      panel.formula, off * kPercents,
      verdict.paper == PaperVerdict::kRejected ? "rejected" : "not rejected", paper);
  return verdict;
}

PanelVerdict judgeRuns(const std::vector<const SetData*>& sets) {
  PanelVerdict verdict;
  const auto gamma = estimateOf(*sets.front(), "gamma");
  if (!gamma || !std::isfinite(gamma->value) || !(gamma->sigma > 0)) {
    verdict.exact_text = "too few tumbles to judge";
    return verdict;
  }
  verdict.max_z = std::abs(gamma->value - gamma->theory) / gamma->sigma;
  verdict.exact = verdict.max_z < kAgreeZ ? VerdictKind::kAgrees : VerdictKind::kDisagrees;
  verdict.exact_text = fmt::format(
      "γ = {} /s, 95 % from {} to {}, z = {:.1f}, from {}", valueText(gamma->value, gamma->sigma),
      valueText(gamma->low95, gamma->sigma), valueText(gamma->high95, gamma->sigma), verdict.max_z,
      recordingWord(*sets.front()));
  return verdict;
}

}  // namespace

std::vector<CurvePoint> curveOf(const SetData& set, bool angular) {
  std::vector<CurvePoint> curve = pointsOf(set.recordings.front(), angular);
  if (set.recordings.size() < 2) return curve;
  for (const RecordingData& recording : set.recordings) {
    curve.resize(std::min(curve.size(), pointsOf(recording, angular).size()));
  }
  const auto recordings = static_cast<double>(set.recordings.size());
  for (std::size_t i = 0; i < curve.size(); ++i) {
    CurvePoint& mean = curve[i];
    std::vector<double> values;
    std::vector<double> off;
    mean.tau = mean.noise = mean.exact = mean.paper = mean.windows = 0;
    for (const RecordingData& recording : set.recordings) {
      const CurvePoint& point = pointsOf(recording, angular)[i];
      const double scale = angular ? 1 : speedScale(recording.result);
      mean.tau += point.tau / recordings;
      mean.noise += point.noise / recordings;
      mean.exact += point.exact / recordings;
      mean.paper += point.paper / recordings;
      mean.windows += point.windows;
      mean.judged = mean.judged && point.judged;
      values.push_back(point.value);
      off.push_back(point.value - point.noise - point.exact * scale);
    }
    const Scatter value = scatterOf(values);
    const Scatter deviation = scatterOf(off);
    mean.value = value.mean;
    mean.sigma = value.error;
    mean.z = analysis::normalDeviate(
        deviation.mean / std::hypot(deviation.error, kFloor * mean.exact), recordings - 1);
  }
  return curve;
}

double paperDeviation(const SetData& set, const CurvePoint& point, bool angular) {
  const double formula = point.paper * scaleOf(set, angular);
  return (point.value - point.noise - formula) / std::hypot(point.sigma, kFloor * formula);
}

std::optional<Estimate> estimateOf(const SetData& set, const std::string& name) {
  if (set.recordings.size() > 1) {
    const Estimate* first = find(resultOf(set).estimates, name);
    if (first == nullptr) return std::nullopt;
    Estimate mean = *first;
    std::vector<double> values;
    for (const RecordingData& recording : set.recordings) {
      const Estimate* one = find(recording.result.estimates, name);
      if (one != nullptr && std::isfinite(one->value)) values.push_back(one->value);
    }
    if (values.size() < 2) return std::nullopt;
    const Scatter scatter = scatterOf(values);
    const double half =
        analysis::studentQuantile(static_cast<double>(values.size() - 1)) * scatter.error;
    mean.value = scatter.mean;
    mean.sigma = scatter.error;
    mean.low95 = scatter.mean - half;
    mean.high95 = scatter.mean + half;
    mean.note = fmt::format("mean of {} recordings; {}", values.size(), mean.note);
    return mean;
  }
  const ProgramResult& result = resultOf(set);
  if (result.fit && result.fit->fitted()) {
    for (const auto* list : {&result.fit->derived, &result.fit->parameters}) {
      const Estimate* fitted = find(*list, name);
      if (fitted != nullptr && std::isfinite(fitted->value)) return *fitted;
    }
  }
  const Estimate* live = find(result.estimates, name);
  if (live == nullptr) return std::nullopt;
  return *live;
}

std::vector<Estimate> estimatesOf(const SetData& set) {
  std::vector<Estimate> all;
  for (const std::string& name : set.set.estimates) {
    const auto best = estimateOf(set, name);
    if (!best) continue;
    all.push_back(*best);
    if (set.recordings.size() > 1) continue;
    const Estimate* live = find(resultOf(set).estimates, name);
    if (live != nullptr && live->note != best->note && std::isfinite(live->value)) {
      all.push_back(*live);
    }
  }
  return all;
}

double lineThroughOrigin(const SetData& set, bool angular) {
  const double epsilon = resultOf(set).law->held().value_or(analysis::HeldDraws{}).hold;
  double upper = 0;
  double lower = 0;
  for (const CurvePoint& point : curveOf(set, angular)) {
    if (!known(point) || point.tau < 0.999 * epsilon || point.tau > 10.001 * epsilon) continue;
    upper += point.tau * point.value;
    lower += point.tau * point.tau;
  }
  return lower > 0 ? upper / lower / (angular ? 2 : 4) : kNan;
}

std::string curveLabel(const PaperPanel& panel, const PaperSet& set) {
  if (panel.curves.size() < 2) return "measured";
  for (const analysis::LawParameter& one : set.law->parameters()) {
    if (one.name != panel.varied) continue;
    const DisplayUnit unit = displayUnit(one.unit);
    // As the paper writes them.
    return fmt::format("{} = {:g} {}", one.symbol == "τt" ? "τ_t" : one.symbol,
                       one.value * unit.factor, unit.text == "1/s" ? "/s" : unit.text);
  }
  return set.id;
}

PanelVerdict judgePanel(const PaperPanel& panel, const Reproduction& reproduction) {
  std::vector<const SetData*> sets;
  for (const std::string& id : panel.curves) {
    if (const SetData* set = findSet(reproduction, id)) sets.push_back(set);
  }
  if (sets.empty()) return {};
  switch (panel.kind) {
    case PanelKind::kPersistence:
      return judgePersistence(panel, sets);
    case PanelKind::kRunTumble:
      return judgeRuns(sets);
    case PanelKind::kTrajectory:
      return {};
    default:
      return judgeCurves(panel, sets);
  }
}

std::string verdictWord(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::kAgrees:
      return "agrees with the exact law";
    case VerdictKind::kDisagrees:
      return "deviates from the exact law";
    default:
      return "undecided";
  }
}

}  // namespace lab::report
