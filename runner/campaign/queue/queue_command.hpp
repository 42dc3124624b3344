/// `lab queue`: campaigns one after another.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runner/command_line/command_main.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {

struct QueueOptions {
  std::filesystem::path campaigns = "campaigns";  ///< folder of the queue's file
  std::vector<std::string> arguments;             ///< of lab sweep, for add
  std::int64_t number = 0;                        ///< for remove
  bool live = false;                              ///< run: also campaigns on the real lab
  bool engines = false;  ///< run: also campaigns whose command lines start other programs
};

ExitCode addToQueue(const QueueOptions& options);
ExitCode listQueue(const QueueOptions& options);
ExitCode removeFromQueue(const QueueOptions& options);

/// Runs the campaigns that wait, one after another, until none is left or the user interrupts. A
/// campaign that fails does not keep the next one from running.
/// @throws UserError, before anything is started, if a campaign is not allowed by the options
ExitCode runQueue(const QueueOptions& options);

void addQueue(CLI::App& app, Chosen& chosen);

}  // namespace lab::runner::campaign
