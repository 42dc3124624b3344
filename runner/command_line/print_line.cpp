#include "runner/command_line/print_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <system_error>

#include "common/text/printable.hpp"

namespace lab::runner {

void evenWithoutReader(const std::function<void()>& print) {
  try {
    print();
  } catch (const std::system_error&) {
    if (std::freopen("/dev/null", "w", stdout) == nullptr) return;
  }
}

void printLine(std::string_view text) {
  evenWithoutReader([text] {
    fmt::print("{}{}\n", isatty(STDOUT_FILENO) == 1 ? "\r\033[K" : "", printable(text));
    std::fflush(stdout);
  });
}

void printFaults(const std::vector<std::string>& faults) {
  for (const std::string& fault : faults) fmt::print("fault    {}\n", printable(fault));
}

}  // namespace lab::runner
