#include "dashboard/health/process_meter.hpp"

#include <unistd.h>

#include <array>
#include <fstream>
#include <limits>
#include <sstream>

#include "common/math/units.hpp"

namespace lab::dashboard {

std::optional<ProcessTimes> readProcess(std::int32_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  // The process name is in parentheses and may itself contain any character. Field 3 follows the
  // last parenthesis (proc(5): utime 14, stime 15, starttime 22, rss 24).
  const std::size_t bracket = line.rfind(')');
  if (bracket == std::string::npos) return std::nullopt;
  std::istringstream fields(line.substr(bracket + 1));
  std::string skipped;
  std::int64_t user = 0;
  std::int64_t system = 0;
  std::int64_t pages = 0;
  ProcessTimes times;
  for (int field = 3; field < 14; ++field) fields >> skipped;
  fields >> user >> system;
  for (int field = 16; field < 22; ++field) fields >> skipped;
  fields >> times.begun >> skipped >> pages;
  if (!fields) return std::nullopt;
  times.cpu = static_cast<double>(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  times.memory = static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return times;
}

std::string ownHost() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::map<std::int32_t, ProcessUse> ProcessMeter::measure(const std::vector<std::int32_t>& pids,
                                                         std::int64_t now) {
  std::map<std::int32_t, ProcessUse> uses;
  std::map<std::int32_t, ProcessTimes> times;
  const double span = units::seconds(now - before_utime_);
  for (const std::int32_t pid : pids) {
    const std::optional<ProcessTimes> process = read_(pid);
    if (!process) continue;
    ProcessUse& use = uses[pid];
    use.memory_MB = process->memory * 1e-6;
    use.cpu_percent = std::numeric_limits<double>::quiet_NaN();
    const auto before = before_.find(pid);
    if (before != before_.end() && before->second.begun == process->begun && span > 0) {
      use.cpu_percent = (process->cpu - before->second.cpu) / span / units::kPercent;
    }
    times[pid] = *process;
  }
  before_ = std::move(times);
  before_utime_ = now;
  return uses;
}

}  // namespace lab::dashboard
