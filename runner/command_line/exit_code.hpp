#pragma once

#include <stdexcept>

namespace lab::runner {

/// What `lab` returns to the shell.
enum ExitCode : int {
  kDone = 0,
  kFailed = 1,    ///< it ran, and what it should show did not come about
  kBadInput = 2,  ///< nothing was started: the text says what to change
  kMarked = 3,    ///< the run had to be closed early; its data are kept and marked
};

/// Something the user can mend; nothing was started. The text says where and how.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lab::runner
