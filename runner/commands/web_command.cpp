#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/bus/lcm_bus.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/loop/asio_loop.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/print_line.hpp"
#include "runner/commands/commands.hpp"
#include "runner/doctor/machine.hpp"
#include "runner/live/dashboard_process.hpp"
#include "runner/runs/lab_registry.hpp"
#include "runner/runs/network.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kSuperviseWeb_us = 100'000;

/// Opens the address in the user's browser, which outlives this program. The address contains the
/// token, and other users can read command lines, so the browser gets a private file that redirects
/// to it.
/// @return pid of xdg-open, which ends by itself; 0: not started
pid_t openInBrowser(const std::string& address, const fs::path& redirect) {
  const auto opener = findProgram("xdg-open");
  if (!opener) {
    printLine("web      there is no xdg-open: open the address yourself");
    return 0;
  }
  writePrivately(redirect, fmt::format("<!DOCTYPE html><meta charset=\"utf-8\">"
                                       "<meta http-equiv=\"refresh\" content=\"0;url={}\">\n",
                                       address));
  std::string program = opener->string();
  std::string page = redirect.string();
  char* arguments[] = {program.data(), page.data(), nullptr};
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int stream : {0, 1, 2}) {
    posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_RDWR, 0);
  }
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  pid_t pid = 0;
  if (posix_spawn(&pid, program.c_str(), &files, &attributes, arguments, environ) != 0) {
    pid = 0;
    printLine("web      xdg-open cannot be started: open the address yourself");
  }
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return pid;
}

/// Prints a line when xdg-open failed. @param opener set to 0 once it has ended
void superviseOpener(pid_t& opener) {
  int status = 0;
  if (opener == 0 || waitpid(opener, &status, WNOHANG) == 0) return;
  opener = 0;
  if (status != 0) printLine("web      xdg-open shows no page: open the address yourself");
}

/// Prints the output of the dashboard on stderr: there is no run folder in which to look.
void showOutput(const fs::path& output) {
  std::ifstream file(output);
  for (std::string line; std::getline(file, line);) fmt::print(stderr, "{}\n", line);
}

}  // namespace

ExitCode web(const WebOptions& options) {
  if (const auto problem = multicastProblem()) throw UserError(*problem);
  const RegistryFile output(".web.txt");
  const RegistryFile redirect(".web.html");
  AsioLoop loop;
  DashboardProcess page({.program = options.programs / kObserverService,
                         .url = lcmUrl(choosePort(0)),
                         .runs = fs::absolute(options.runs),
                         .port = options.port,
                         .address_file = registryFile(".web"),
                         .output = output.path()});
  const auto say = [](const std::string& what) { printLine("web      " + what); };
  bool opened = !options.open;
  pid_t opener = 0;
  page.start(say);
  loop.onSignals({SIGINT, SIGTERM, SIGHUP}, [&loop](int) { loop.stop(); });
  loop.every(kSuperviseWeb_us, loop.now(), [&] {
    page.supervise(say);
    superviseOpener(opener);
    if (page.givenUp()) loop.stop();
    if (opened || page.address().empty()) return;
    opened = true;
    opener = openInBrowser(page.address(), redirect.path());
  });
  loop.run();
  const bool failed = page.givenUp();
  page.end();
  if (failed) showOutput(output.path());
  return failed ? kFailed : kDone;
}

}  // namespace lab::runner
