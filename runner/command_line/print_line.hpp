/// Lines on the terminal.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace lab::runner {

/// Prints a line on stdout. On a terminal it replaces the progress line, which is then printed
/// again below it.
void printLine(std::string_view text);

/// Prints the faults of a run, one line each.
void printFaults(const std::vector<std::string>& faults);

/// Calls `print`. When nobody reads stdout any more (`lab run ... | head`), stdout is redirected to
/// /dev/null and the run continues.
void evenWithoutReader(const std::function<void()>& print);

}  // namespace lab::runner
