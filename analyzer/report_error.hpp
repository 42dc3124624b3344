#pragma once

#include <stdexcept>

namespace lab::report {

/// The report cannot be made. The text has what was found, what was expected and a remedy.
class ReportError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lab::report
