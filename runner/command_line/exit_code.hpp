#pragma once

#include <stdexcept>

namespace lab::runner {

/// Exit codes of `lab`.
enum ExitCode : int {
  kDone = 0,
  kFailed = 1,       ///< it ran, but its result is negative or incomplete
  kBadInput = 2,     ///< nothing was started; the message says what to change
  kClosedEarly = 3,  ///< the run was closed early; its data up to then are kept
};

/// An error that the user can correct; nothing was started. The text says where and how.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lab::runner
