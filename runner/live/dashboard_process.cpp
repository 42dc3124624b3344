#include "runner/live/dashboard_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <system_error>

#include "common/experiment/service_placement.hpp"
#include "common/process/installation.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/print_line.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr int kTimeout_ms = 2000;
constexpr const char* kBuild = "./lab build builds it";

}  // namespace

void writePrivately(const fs::path& path, const std::string& text) {
  std::error_code error;
  fs::remove(path, error);  // an existing file would keep its permissions
  const int file = open(path.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
  const bool written =
      file >= 0 && write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (file >= 0) close(file);
  if (!written) fmt::print(stderr, "lab: cannot write the page's address to {}\n", path.string());
}

void DashboardProcess::start(const Say& say) {
  std::error_code error;
  fs::remove(options_.address_file, error);
  if (!fs::exists(options_.program, error)) {
    giveUp(fmt::format("{} does not exist: {}", options_.program.string(),
                       installation().installHint(std::string(kObserverService), kBuild)),
           say);
    return;
  }
  try {
    startProcess();
  } catch (const std::exception& problem) {
    giveUp(problem.what(), say);
  }
}

void DashboardProcess::startProcess() {
  std::vector<std::string> arguments{options_.program.string(),
                                     "--lcm-url",
                                     options_.url,
                                     "--runs",
                                     options_.runs.string(),
                                     "--address-file",
                                     options_.address_file.string()};
  if (!options_.experiment.empty()) {
    arguments.insert(arguments.end(), {"--experiment", options_.experiment.string()});
  }
  if (options_.port != 0) {
    arguments.insert(arguments.end(), {"--port", std::to_string(options_.port)});
  }
  if (options_.this_machine_only) arguments.emplace_back("--this-machine-only");
  process_ = std::make_unique<LocalProcess>(arguments, options_.output, LocalProcess::Death::kKill);
}

void DashboardProcess::giveUp(const std::string& why, const Say& say) {
  given_up_ = true;
  process_.reset();
  say(fmt::format("no dashboard: {}; everything else continues", why));
}

void DashboardProcess::supervise(std::int64_t now, const Say& say) {
  if (!process_) return;
  findAddress();
  if (process_->running()) return;
  if (!restart_utime_) {
    const std::string ending = process_->ending();
    restart_utime_ = limit_.noteDeath(now);
    if (!restart_utime_) {
      giveUp(fmt::format("its process {} (the last time: {}); see {}", tooOftenText(), ending,
                         options_.output.string()),
             say);
      return;
    }
    say(fmt::format("dashboard died ({}) and {}", ending, restartText(*restart_utime_ - now)));
  }
  if (now < *restart_utime_) return;
  restart_utime_.reset();
  try {
    startProcess();
  } catch (const std::exception& problem) {
    giveUp(problem.what(), say);
  }
}

void DashboardProcess::findAddress() {
  // The address may change: a restarted dashboard may find its port taken.
  std::ifstream file(options_.address_file);
  std::string address;
  if (!std::getline(file, address) || address.empty() || address == address_) return;
  address_ = address;
  printLine(fmt::format("web      {}", address_));
  if (!options_.address_copy.empty()) writePrivately(options_.address_copy, address_ + "\n");
}

void DashboardProcess::end() {
  if (process_) {
    process_->terminate();
    process_->waitOrKill(kTimeout_ms);
    process_.reset();
  }
  std::error_code error;
  fs::remove(options_.address_file, error);
  fs::remove(fs::path(options_.address_file) += ".part",
             error);  // left when it was ended while writing
  if (!options_.address_copy.empty() && !address_.empty()) {
    fs::remove(options_.address_copy, error);
  }
}

bool wantsDashboard(std::optional<bool> asked, bool virtual_time, const char* ci) {
  if (asked.value_or(false) && virtual_time) {
    throw UserError(
        "--web: a run in virtual time has no dashboard; leave out --web or "
        "--virtual-time");
  }
  if (asked || virtual_time) return asked.value_or(false);
  return ci == nullptr || *ci == '\0';
}

}  // namespace lab::runner
