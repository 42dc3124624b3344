/// The error of files that a user writes: experiments and calibrations.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace lab {

/// A file of the user that cannot be used. what() has a line for each problem, e.g.
/// "experiments/x.toml:12: robots[2].x_cm: found 130, allowed 3.75 to 116.25 (inside the arena)".
class ExperimentError : public std::runtime_error {
 public:
  explicit ExperimentError(std::vector<std::string> problems);

  [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::string> problems_;
};

}  // namespace lab
