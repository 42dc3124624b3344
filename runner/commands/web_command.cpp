#include <fmt/format.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>

#include "common/bus/lcm_bus.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/process/child_process.hpp"
#include "common/text/printable.hpp"
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
/// @return xdg-open, which ends by itself; nothing: not started
std::unique_ptr<ChildProcess> openInBrowser(const std::string& address, const fs::path& redirect) {
  const auto opener = findProgram("xdg-open");
  if (!opener) {
    printLine("web      there is no xdg-open: open the address yourself");
    return nullptr;
  }
  writePrivately(redirect, fmt::format("<!DOCTYPE html><meta charset=\"utf-8\">"
                                       "<meta http-equiv=\"refresh\" content=\"0;url={}\">\n",
                                       address));
  try {
    return std::make_unique<ChildProcess>(
        ChildSettings{.arguments = {opener->string(), redirect.string()},
                      .group = ChildSettings::Group::kSession,
                      .death_signal = 0});
  } catch (const std::system_error&) {
    printLine("web      xdg-open cannot be started: open the address yourself");
    return nullptr;
  }
}

/// Prints a line when xdg-open failed. @param opener reset once it has ended
void superviseOpener(std::unique_ptr<ChildProcess>& opener) {
  if (!opener || opener->running()) return;
  if (opener->code() != 0) printLine("web      xdg-open failed: open the address yourself");
  opener.reset();
}

/// Prints the output of the dashboard on stderr: there is no run folder in which to look.
void showOutput(const fs::path& output) {
  std::ifstream file(output);
  for (std::string line; std::getline(file, line);) fmt::print(stderr, "{}\n", printable(line));
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
                         .address_file = registryFile(kPageFile),
                         .output = output.path()});
  const auto say = [](const std::string& what) { printLine("web      " + what); };
  bool opened = !options.open;
  std::unique_ptr<ChildProcess> opener;
  page.start(say);
  loop.onSignals({SIGINT, SIGTERM, SIGHUP}, [&loop](int) { loop.stop(); });
  loop.every(kSuperviseWeb_us, loop.now(), [&] {
    page.supervise(loop.now(), say);
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
