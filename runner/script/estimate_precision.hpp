/// Whether the analyzer knows a number well enough.
#pragma once

#include <lab/analysis_t.hpp>
#include <lab/program_t.hpp>
#include <limits>
#include <string>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// One estimate of one program, as it was heard last.
class EstimatePrecision {
 public:
  /// @param until names the estimate
  EstimatePrecision(const Experiment& experiment, const Until& until);

  /// @return whether the message says something about it
  bool take(const analysis_t& analysis);

  [[nodiscard]] bool holds() const { return error_ <= until_.relative_error; }

  /// [1] standard error over value, nan: not determined.
  [[nodiscard]] double error() const { return error_; }

  /// How many times the data so far are needed yet: errors fall as 1 / sqrt(time). nan: not known.
  [[nodiscard]] double moreData() const;

  [[nodiscard]] const Until& until() const { return until_; }

  /// "relative error 0.12, wanted 0.05".
  [[nodiscard]] std::string progress() const;

 private:
  Until until_;
  program_t program_{};
  double error_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace lab::runner
