#include "runner/user_program/user_program.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

#include "light/field/image.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/print_line.hpp"
#include "runner/user_program/python.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFolder = "user_program";  // in the run
constexpr std::chrono::milliseconds kGrace{2000};
constexpr std::chrono::milliseconds kTick{50};

std::vector<std::string> wordsOf(const std::string& typed) {
  std::error_code error;
  if (fs::exists(typed, error)) return {typed};
  std::istringstream text(typed);
  std::vector<std::string> words{std::istream_iterator<std::string>(text), {}};
  return words;
}

std::string contentsOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

UserProgram findUserProgram(const std::string& typed) {
  const std::vector<std::string> words = wordsOf(typed);
  const fs::path file = words.empty() ? fs::path() : fs::path(words.front());
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    throw UserError(
        fmt::format("--with {}: there is no such file; expected a program of yours, as "
                    "script.py, or with arguments as \"script.py --gain 3\"",
                    typed));
  }
  UserProgram program;
  program.name = file.filename().string();
  program.arguments = words;
  program.arguments.front() = fs::absolute(file).string();
  if (file.extension() == ".py") {
    program.arguments.insert(program.arguments.begin(), pythonProgram());
    program.file = 1;
  } else if (access(file.c_str(), X_OK) != 0) {
    throw UserError(
        fmt::format("--with {}: this file is neither Python (.py) nor executable; chmod +x {}",
                    typed, file.string()));
  }
  const std::string bytes = contentsOf(file);
  program.digest =
      light::sha256({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  return program;
}

void adoptUserProgram(const UserProgram& program, const fs::path& run) {
  std::error_code error;
  fs::create_directories(run / kFolder, error);
  fs::copy_file(program.arguments[program.file], run / kFolder / program.name, error);
  if (error) {
    throw UserError(fmt::format("cannot copy {} into {}: {}", program.arguments[program.file],
                                run.string(), error.message()));
  }
}

std::string describe(const UserProgram& program) {
  std::string arguments;
  for (std::size_t i = program.file + 1; i < program.arguments.size(); ++i) {
    arguments += " " + program.arguments[i];
  }
  return fmt::format("user program {}{}, SHA-256 {}", program.name, arguments, program.digest);
}

UserProcess::UserProcess(const UserProgram& program, const fs::path& run,
                         std::vector<std::string> environment,
                         std::vector<std::pair<int, int>> handed_on)
    : name_(program.name) {
  environment.push_back("ACTIVE_LAB_DIRECTORY=" + fs::absolute(run).string());
  // Sets of texts have the same order in every run, and output is in order with that of the lab.
  environment.insert(environment.end(), {"PYTHONHASHSEED=0", "PYTHONUNBUFFERED=1"});
  ChildSettings settings{.arguments = program.arguments,
                         .environment = pythonEnvironment(std::move(environment)),
                         .output = ChildSettings::kInherited,
                         .errors = ChildSettings::kInherited,
                         .handed_on = std::move(handed_on)};
  try {
    child_ = std::make_unique<ChildProcess>(settings);
  } catch (const std::system_error& error) {
    throw UserError(fmt::format("--with {}: {}", name_, error.what()));
  }
}

void UserProcess::waitForEnd(const std::function<bool()>& in_a_hurry) {
  auto begin = std::chrono::steady_clock::now();
  bool said = false;
  bool hurry = false;
  bool terminated = false;
  while (!child_->waitFor(kTick)) {
    const auto now = std::chrono::steady_clock::now();
    if (!hurry && in_a_hurry()) {
      hurry = true;
      begin = now;
    }
    if (!hurry && !said && now - begin >= kSilentWait) {
      said = true;
      printLine(fmt::format("waiting for the end of {}: Ctrl-C ends it", name_));
    }
    if (!hurry || now - begin < kGrace) continue;
    child_->signalGroup(terminated ? SIGKILL : SIGTERM);
    terminated = true;
    begin = now;
  }
}

std::string UserProcess::problem() const {
  const std::string ending = child_->ending();
  if (ending.empty() || child_->code() == 0) return {};
  const std::string hint =
      pythonFolder().empty() ? "; the Python package active_lab is not there: " + pythonHint() : "";
  return fmt::format("the user program {} ended with {}{}", name_, ending, hint);
}

}  // namespace lab::runner
