/// The estimates of a program with their errors and intervals.
#pragma once

#include <string>
#include <vector>

#include "analyzer/curves/block_errors.hpp"
#include "analyzer/curves/estimator.hpp"
#include "analyzer/laws.hpp"

namespace lab::analysis {

/// One quantity with its error, SI units. If it could not be determined, value is nan and the note
/// has the reason.
struct Estimate {
  std::string name;
  std::string unit;
  double value = 0;
  double sigma = 0;  ///< Standard error.
  double low95 = 0;  ///< 95 % interval; by Student's t for few blocks.
  double high95 = 0;
  double theory = 0;  ///< Value of the programmed parameters; nan: none.
  double n_eff = 0;   ///< Number of independent blocks (or tumbles) in sigma.
  std::string note;   ///< The estimator, and what limits its validity.
};

/// All estimates of a program with their theoretical values, in the order of display.
[[nodiscard]] std::vector<Estimate> estimate(const ProgramLaw& law, const BlockData& data);

/// The same with the estimators of these data.
[[nodiscard]] std::vector<Estimate> estimate(const Estimator& estimator, const BlockData& data);

/// The names of the estimates that a program has, before anything is measured.
[[nodiscard]] std::vector<std::string> estimateNames(const ProgramLaw& law);

}  // namespace lab::analysis
