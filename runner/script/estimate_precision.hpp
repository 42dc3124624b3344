/// Checks whether an estimate of the analyzer has reached a relative error.
#pragma once

#include <lab/analysis_t.hpp>
#include <lab/program_id_t.hpp>
#include <limits>
#include <string>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// The latest value of one estimate of one program.
class EstimatePrecision {
 public:
  /// @param until names the estimate
  EstimatePrecision(const Experiment& experiment, const EndCondition& until);

  /// @return whether the message contains a value of the estimate
  bool take(const analysis_t& analysis);

  [[nodiscard]] bool holds() const { return error_ <= until_.relative_error; }

  /// Standard error divided by value; NaN if not determined.
  [[nodiscard]] double error() const { return error_; }

  /// Amount of data still needed relative to the data so far, as errors fall with 1 / sqrt(time).
  /// NaN if unknown.
  [[nodiscard]] double moreData() const;

  [[nodiscard]] const EndCondition& until() const { return until_; }

  /// "relative error 0.12, wanted 0.05".
  [[nodiscard]] std::string progress() const;

 private:
  EndCondition until_;
  program_id_t program_{};
  double error_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace lab::runner
