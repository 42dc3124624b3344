#include "runner/command_line/command_main.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "analyzer/report_error.hpp"
#include "common/bus/bus_error.hpp"
#include "common/command_line/parse_arguments.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/keys/experiment_key_table.hpp"
#include "common/process/installation.hpp"
#include "common/text/printable.hpp"
#include "runner/command_line/build_facts.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {
namespace {

constexpr std::array<ProgramCommand, 12> kProgramCommands{{
    {"preview", "lab-preview", "Draw the light script as pictures, without a run"},
    {"calibrate", "lab-calibrate", "Calibrate camera, projector, light or motors"},
    {"analyze", "lab-analyze",
     "Make summary, report, trajectories and figures from a log or a file of poses"},
    {"export", "lab-export",
     "Write a run as MCAP, HDF5 or CSV, for Rerun, Foxglove, pandas, trackpy, TRex"},
    {"theory", "lab-analyze",
     "Print the theoretical curves of a motion model and the paper's formulas as CSV"},
    {"track", "lab-track", "Track all robots in a movie or in pictures, without a lab"},
    {"reproduce", "lab-reproduce",
     "Reproduce the paper's figures 2, 3, 4 in virtual time, on one page"},
    {"sweep", "lab-sweep", "Run an experiment at many points: tables and figures of a campaign"},
    {"queue", "lab-sweep", "Run several campaigns one after another"},
    {"twin", "lab-twin", "Compare a run with simulations of the same experiment, its twins"},
    {"program", "lab-program", "List, show, check and trace motion programs"},
    {"doctor", "lab-doctor",
     "Check this machine; for each problem print the command that fixes it"},
}};

/// Whether no file can have this name, which is the user's to change; not a full disk.
bool isWrongName(const std::error_code& code) {
  return code == std::errc::too_many_symbolic_link_levels || code == std::errc::filename_too_long ||
         code == std::errc::not_a_directory || code == std::errc::invalid_argument;
}

/// What the system says of a file, without the names of C++ functions.
std::string fileErrorText(const std::filesystem::filesystem_error& error) {
  const std::string file = error.path1().string();
  if (file.empty()) return "found an empty name of a file, expected a path";
  return fmt::format("{}: {}", file, error.code().message());
}

/// Whether the output is a file that has not taken all of it. A reader or a terminal that has gone
/// is no fault.
bool isOutputIncomplete() {
  std::cout.flush();
  const bool complete = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
  struct stat facts {};
  return !complete && fstat(STDOUT_FILENO, &facts) == 0 && S_ISREG(facts.st_mode);
}

int guarded(const std::function<int()>& command) {
  try {
    return command();
  } catch (const ExperimentError& error) {
    std::cerr << printableLines(error.what()) << "\n";
    return kBadInput;
  } catch (const UserError& error) {
    std::cerr << "lab: " << printableLines(error.what()) << "\n";
    return kBadInput;
  } catch (const report::ReportError& error) {
    std::cerr << "lab: " << printableLines(error.what()) << "\n";
    return kBadInput;
  } catch (const BusError& error) {
    std::cerr << "lab: " << printableLines(error.what()) << "\n";
    return kBadInput;
  } catch (const std::filesystem::filesystem_error& error) {
    std::cerr << "lab: " << printableLines(fileErrorText(error)) << "\n";
    return isWrongName(error.code()) ? kBadInput : kFailed;
  } catch (const std::exception& error) {
    std::cerr << "lab: " << printableLines(error.what()) << "\n";
    return kFailed;
  }
}

}  // namespace

const ProgramCommand* findProgramCommand(const std::string& name) {
  for (const ProgramCommand& command : kProgramCommands) {
    if (name == command.name) return &command;
  }
  return nullptr;
}

const char* summaryOf(const std::string& command) {
  const ProgramCommand* found = findProgramCommand(command);
  if (found == nullptr) throw std::out_of_range(command);
  return found->summary;
}

void becomeProgram(const std::string& program, char** argv) {
  const std::filesystem::path file = installation().programs / program;
  const std::string path = file.string();
  std::vector<char*> arguments;
  // exec takes char* and does not write through it.
  arguments.push_back(const_cast<char*>(path.c_str()));
  for (char** argument = argv + 1; *argument != nullptr; ++argument) arguments.push_back(*argument);
  arguments.push_back(nullptr);
  execv(path.c_str(), arguments.data());
  const int error = errno;
  throw UserError(fmt::format(
      "this command needs {}, which {}: {}", path,
      error == ENOENT ? "does not exist"
                      : std::string("cannot be executed (") + std::strerror(error) + ")",
      installation().installHint(program, "./lab build builds everything")));
}

std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv) {
  try {
    return parseArguments(app, argc, argv, {"lab", keys::keyMeantBy});
  } catch (const ArgumentError& error) {
    throw UserError(error.what());
  }
}

int runCommands(int argc, char** argv, const AddCommands& add) {
  CLI::App app{"Active Lab: active matter with light-driven robots, real or simulated",
               installation().command};
  app.set_version_flag("--version", buildFacts(), "Version, commit, compiler and libraries");
  app.require_subcommand(1);
  Chosen chosen;
  add(app, chosen);
  if (const std::optional<int> code = parseCommandLine(app, argc, argv)) return *code;
  return chosen();
}

int guardedMain(const std::function<int()>& command) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("lab"));
  std::signal(SIGPIPE,
              SIG_IGN);  // a run goes on when the reader of its output ends (lab run | head)
  std::signal(SIGXFSZ, SIG_IGN);  // writing beyond the limit of file size returns an error instead
  spdlog::set_pattern("%^%l%$: %v");
  const int exit_code = guarded(command);
  if (exit_code != kDone || !isOutputIncomplete()) return exit_code;
  std::cerr << "lab: the output cannot be written: is the disk full?\n";
  return kFailed;
}

int commandMain(int argc, char** argv, const AddCommands& add) {
  return guardedMain([&] { return runCommands(argc, argv, add); });
}

}  // namespace lab::runner
