/// The recordings of a reproduction judged: against the exact law, and against the paper's formula.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/report/reproduction/reproduction_data.hpp"

namespace lab::report {

/// By id of the set.
using Reproduction = std::map<std::string, SetData, std::less<>>;

/// The measured curve of a set, SI units: that of its recording, or the mean of an ensemble with
/// the standard error of its scatter. z is as analysis::curves() has it, with Student's t of the
/// members turned into a normal deviate.
[[nodiscard]] std::vector<analysis::CurvePoint> curveOf(const SetData& set, bool angular);

/// How far the paper's formula at the measured speed is from what was measured [standard errors,
/// the systematic floor of 0.2 % in them].
[[nodiscard]] double paperDeviation(const SetData& set, const analysis::CurvePoint& point,
                                    bool angular);

/// The named quantity: of the fit of the exact law where there is one, else the live one; of an
/// ensemble the mean of the live ones with the standard error of their scatter. SI units.
[[nodiscard]] std::optional<analysis::Estimate> estimateOf(const SetData& set,
                                                           const std::string& name);

/// Every estimator's answer for what the paper speaks of: for the table.
[[nodiscard]] std::vector<analysis::Estimate> estimatesOf(const SetData& set);

/// What the paper does: a line through the origin on the lags from epsilon to 10 epsilon, least
/// squares, over 2 (angular MSD: D_r) or 4 (MSD: D). nan where there are no such lags.
[[nodiscard]] double lineThroughOrigin(const SetData& set, bool angular);

/// "ε = 0.5 s" or "V = 7 cm/s": the parameter in which the panel's curves differ.
[[nodiscard]] std::string curveLabel(const PaperPanel& panel, const PaperSet& set);

enum class PaperVerdict { kNone, kRejected, kNotRejected, kUndecided };

struct PanelVerdict {
  analysis::VerdictKind exact = analysis::VerdictKind::kUndecided;
  double max_z = 0;
  std::string exact_text;  ///< a sentence, without the verdict's word
  PaperVerdict paper = PaperVerdict::kNone;
  std::string paper_text;  ///< empty: the panel tests none
};
[[nodiscard]] PanelVerdict judgePanel(const PaperPanel& panel, const Reproduction& reproduction);

[[nodiscard]] std::string verdictWord(analysis::VerdictKind kind);

}  // namespace lab::report
