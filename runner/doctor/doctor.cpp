#include "runner/doctor/doctor.hpp"

#include <algorithm>
#include <ostream>

#include "common/process/installation.hpp"
#include "common/text/printable.hpp"

namespace lab::runner {
namespace {

using Level = Finding::Level;

constexpr std::int64_t kBufferNeeded = 4194304;       // [byte] recv_buf_size of the lab's URL
constexpr std::int64_t kDiskWarning = 2'000'000'000;  // [byte]
constexpr std::int64_t kDiskError = 100'000'000;      // [byte]

Finding loopback(const MachineFacts& facts) {
  if (facts.loopback_up) return {Level::kOk, "the loopback interface is up", ""};
  return {Level::kError, "the loopback interface is down", "sudo ip link set dev lo up"};
}

Finding multicast(const MachineFacts& facts) {
  if (!facts.multicast_problem) return {Level::kOk, "multicast comes back to this machine", ""};
  return {Level::kError, facts.multicast_problem->what, facts.multicast_problem->fix};
}

/// With ttl 0 the kernel keeps messages on this machine only as long as the multicast interface
/// does not change.
Finding pinnedRoute(const MachineFacts& facts) {
  const std::string by = facts.multicast_interface.value_or("");
  if (by == "lo") return {Level::kOk, "multicast is routed over lo: messages cannot leave", ""};
  const std::string fix = "sudo ip route add 224.0.0.0/4 dev lo";
  if (by.empty()) return {Level::kWarning, "no interface is known by which multicast leaves", fix};
  return {Level::kWarning,
          "multicast is routed over " + by +
              ": when that connection changes during a run, its messages leave this machine",
          fix + "  # until the next restart; not where network.ttl is 1"};
}

Finding receiveBuffer(const MachineFacts& facts) {
  const std::string what =
      "sockets get a receive buffer of " + std::to_string(facts.receive_buffer / 1024) + " kB";
  if (facts.receive_buffer >= kBufferNeeded) return {Level::kOk, what, ""};
  return {Level::kWarning, what + ", 4096 kB are needed: bursts of messages will be lost",
          "echo net.core.rmem_max=4194304 | sudo tee /etc/sysctl.d/60-active-lab.conf && "
          "sudo sysctl -p /etc/sysctl.d/60-active-lab.conf"};
}

Finding disk(const MachineFacts& facts, const std::filesystem::path& runs) {
  const std::string what =
      std::to_string(facts.free_bytes / 1'000'000) + " MB are free in " + runs.string();
  const std::string fix = "du -sh '" + runs.string() + "'/*  # what to move away";
  if (facts.free_bytes < kDiskError) {
    return {Level::kError, what + ": a recording would be cut off", fix};
  }
  if (facts.free_bytes < kDiskWarning) {
    return {Level::kWarning, what + ": not enough for a long recording", fix};
  }
  return {Level::kOk, what, ""};
}

Finding program(bool found, const std::string& name, const std::string& package, Level level,
                const std::string& consequence) {
  if (found) return {Level::kOk, name + " is installed", ""};
  return {level, name + " is not installed: " + consequence,
          "sudo apt-get install --no-install-recommends " + package};
}

/// Some programs are packages of their own. In a clone, ./lab builds programs when they are first
/// needed.
Finding part(bool found, const std::string& name, const std::string& consequence) {
  if (found) return {Level::kOk, name + " is there", ""};
  if (!installation().packaged && installation().may_build) {
    return {Level::kOk, name + " is not built yet: ./lab builds it for the first run that needs it",
            ""};
  }
  return {
      Level::kWarning,
      name + (installation().packaged ? " is not installed: " : " is not built: ") + consequence,
      installation().installHint(name, "")};
}

Finding clockState(const MachineFacts& facts) {
  if (facts.clock_disciplined.value_or(false)) return {Level::kOk, "the clock is disciplined", ""};
  return {Level::kWarning,
          facts.clock_disciplined ? "the clock is not disciplined by any time server"
                                  : "the system does not say whether the clock is disciplined",
          "sudo timedatectl set-ntp true"};
}

Finding processors(const MachineFacts& facts) {
  const std::string what = std::to_string(facts.cpus) + (facts.cpus == 1 ? " CPU" : " CPUs");
  if (facts.cpus != 1) return {Level::kOk, what, ""};
  return {Level::kWarning, what + ": a lab in real time may run late",
          installation().command + " run --virtual-time"};
}

Finding ports(const MachineFacts& facts) {
  if (facts.busy_ports.empty()) return {Level::kOk, "no other LCM bus is in use", ""};
  std::string list;
  for (const int port : facts.busy_ports) list.append(" ").append(std::to_string(port));
  return {Level::kOk, "an LCM bus is in use; UDP ports that are taken:" + list, ""};
}

/// An IP datagram that lost a fragment occupies the kernel's reassembly memory for ipfrag_time.
/// When that memory is full, no fragmented datagram arrives any more.
Finding fragments(const MachineFacts& facts) {
  constexpr int kEnough = 3;  // [s]
  if (!facts.fragment_time) return {Level::kOk, "the system does not say ipfrag_time", ""};
  const std::string what = "a message that lost a fragment is discarded after " +
                           std::to_string(*facts.fragment_time) + " s (ipfrag_time)";
  if (*facts.fragment_time <= kEnough) return {Level::kOk, what, ""};
  return {Level::kWarning,
          what + ": where LCM or DDS crosses a network that loses frames, long messages stall",
          "echo net.ipv4.ipfrag_time=1 | sudo tee /etc/sysctl.d/61-active-lab.conf && "
          "sudo sysctl -p /etc/sysctl.d/61-active-lab.conf"};
}

Finding deviceRights(int count, const std::vector<std::string>& closed, const std::string& what,
                     const std::string& group) {
  if (count == 0) return {Level::kOk, "no " + what + " is connected", ""};
  if (closed.empty()) {
    return {
        Level::kOk,
        std::to_string(count) + " " + what + (count == 1 ? "" : "s") + ", accessible to this user",
        ""};
  }
  std::string list;
  for (const std::string& path : closed) list += (list.empty() ? "" : ", ") + path;
  return {Level::kWarning, "this user has no access to " + list,
          "sudo usermod -aG " + group + " $USER  # then log out and in again"};
}

Finding display(const MachineFacts& facts) {
  if (facts.has_display) return {Level::kOk, "a display is there", ""};
  return {Level::kWarning,
          "no display in this session: the projector stays in memory (projector.display = "
          "\"headless\")",
          "export DISPLAY=:0  # if a user is logged in at the projector's desktop"};
}

const char* labelOf(Level level) {
  switch (level) {
    case Level::kOk:
      return "ok    ";
    case Level::kWarning:
      return "warn  ";
    case Level::kError:
      break;
  }
  return "FIX   ";
}

}  // namespace

std::vector<Finding> judge(const MachineFacts& facts, const DoctorOptions& options) {
  std::vector<Finding> findings{
      loopback(facts),
      multicast(facts),
      pinnedRoute(facts),
      receiveBuffer(facts),
      ports(facts),
      disk(facts, options.runs),
      program(facts.has_logger, "lcm-logger", "liblcm-bin", Level::kWarning,
              "no recording by hand"),
      program(facts.has_gnuplot, "gnuplot", "gnuplot-nox", Level::kError, "no figures are drawn"),
      clockState(facts),
      processors(facts),
      fragments(facts),
      deviceRights(facts.serial_lines, facts.closed_serial_lines, "serial line", "dialout"),
      deviceRights(facts.cameras, facts.closed_cameras, "camera", "video"),
      display(facts),
      program(facts.has_ssh, "ssh", "openssh-client", Level::kWarning,
              "no service can be placed on another host"),
      part(facts.has_gateway, "dds_gateway", "no ROS 2, and no other hosts over DDS"),
      part(facts.has_emulator, "robot_emulator", "no robots with body = \"firmware\""),
  };
  for (const std::filesystem::path& file : facts.stale_registrations) {
    findings.push_back({Level::kWarning, "a lab ended without removing " + file.string(),
                        "rm '" + file.string() + "'"});
  }
  return findings;
}

std::vector<Finding> examine(const DoctorOptions& options) {
  return judge(survey(options.runs, options.registrations), options);
}

void print(std::ostream& out, const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    out << labelOf(finding.level) << printableLines(finding.what) << '\n';
    if (!finding.fix.empty()) out << "      " << printableLines(finding.fix) << '\n';
  }
}

int exitCode(const std::vector<Finding>& findings) {
  const bool broken = std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.level == Level::kError;
  });
  return broken ? 2 : 0;
}

}  // namespace lab::runner
