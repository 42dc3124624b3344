#pragma once

#include <termios.h>
#include <unistd.h>

namespace lab::runner {

/// While the object lives, keys are read without Return and without echo, if stdin is a terminal.
class RawTerminal {
 public:
  RawTerminal() : active_(tcgetattr(STDIN_FILENO, &before_) == 0) {
    if (!active_) return;
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  ~RawTerminal() {
    if (active_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  [[nodiscard]] bool active() const { return active_; }

 private:
  termios before_{};
  bool active_;
};

}  // namespace lab::runner
