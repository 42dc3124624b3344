#pragma once

#include <stdexcept>

namespace lab::report {

/// A report that cannot be made. The text says what was found, what was expected and a way out.
class ReportError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lab::report
