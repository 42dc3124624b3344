/// Compares the recordings of a reproduction with the exact law and the paper's formula.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/report/reproduction/reproduction_data.hpp"

namespace lab::report {

/// Data by id of the set.
using Reproduction = std::map<std::string, SetData, std::less<>>;

/// The measured curve of a set, SI units: that of its recording, or the mean of an ensemble with
/// the standard error from its scatter. z is defined as in analysis::curves(); for an ensemble,
/// Student's t is converted to a normal deviate.
[[nodiscard]] std::vector<analysis::CurvePoint> curveOf(const SetData& set, bool angular);

/// The deviation of the measurement from the paper's formula at the measured speed, in standard
/// errors that include the systematic floor of 0.2 %.
[[nodiscard]] double paperDeviation(const SetData& set, const analysis::CurvePoint& point,
                                    bool angular);

/// The named quantity: from the fit of the exact law if there is one, else the live estimate; for
/// an ensemble the mean of the live estimates with the standard error from their scatter. SI units.
[[nodiscard]] std::optional<analysis::Estimate> estimateOf(const SetData& set,
                                                           const std::string& name);

/// The results of all estimators for the quantities of the paper, for the table.
[[nodiscard]] std::vector<analysis::Estimate> estimatesOf(const SetData& set);

/// The method of the paper: a line through the origin on the lags from epsilon to 10 epsilon, least
/// squares, over 2 (angular MSD: D_r) or 4 (MSD: D). nan if there are no such lags.
[[nodiscard]] double lineThroughOrigin(const SetData& set, bool angular);

/// "ε = 0.5 s" or "V = 7 cm/s": the parameter that differs between the curves of the panel.
[[nodiscard]] std::string curveLabel(const PaperPanel& panel, const PaperSet& set);

enum class PaperVerdict { kNone, kRejected, kNotRejected, kUndecided };

struct PanelVerdict {
  analysis::VerdictKind exact = analysis::VerdictKind::kUndecided;
  double max_z = 0;
  std::string exact_text;  ///< a sentence, without the word of the verdict
  PaperVerdict paper = PaperVerdict::kNone;
  std::string paper_text;  ///< empty: no formula is tested
};
[[nodiscard]] PanelVerdict judgePanel(const PaperPanel& panel, const Reproduction& reproduction);

[[nodiscard]] std::string verdictWord(analysis::VerdictKind kind);

}  // namespace lab::report
