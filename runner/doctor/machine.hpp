/// Facts about this machine, read from the system: for `lab doctor`, and for the checks before a
/// run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab::runner {

struct Problem {
  std::string what;
  std::string fix;  ///< command to type
};

/// Sends a datagram with ttl 0 to LCM's multicast group and waits for it.
/// @return why LCM's multicast does not work; nothing if the datagram came back. Takes less than
///   1 ms on success and 0.3 s if a firewall drops the datagram.
[[nodiscard]] std::optional<Problem> diagnoseMulticast();

/// diagnoseMulticast() as one line: the problem and the fix.
[[nodiscard]] std::optional<std::string> multicastProblem();

/// The interface of the multicast route ("lo", "eth0"); nothing without a route or without the
/// program `ip`.
[[nodiscard]] std::optional<std::string> multicastInterface();

/// @return why messages with ttl 0 could leave this machine, and how to prevent it; empty if they
///   cannot
[[nodiscard]] std::string unpinnedWarning();

/// The interface in the output of `ip route get`.
[[nodiscard]] std::optional<std::string> interfaceOfRoute(std::string_view answer);

/// Free bytes for an unprivileged user on the file system of `path`, which need not exist yet;
/// 0 if unknown.
[[nodiscard]] std::int64_t freeBytes(const std::filesystem::path& path);

/// The first executable file with this name in $PATH.
[[nodiscard]] std::optional<std::filesystem::path> findProgram(std::string_view name);

/// Registrations (files <pid>.json, see lab_registry.hpp) of runners that no longer exist, sorted
/// by name. Empty if `folder` does not exist.
[[nodiscard]] std::vector<std::filesystem::path> staleRegistrations(
    const std::filesystem::path& folder);

/// UDP ports from 20000 to 59999 that are bound to all addresses or to LCM's group and not
/// connected, as LCM's sockets are; ascending. Other programs may have such sockets too.
/// @param proc_net_udp text of /proc/net/udp
[[nodiscard]] std::vector<int> listeningPorts(std::string_view proc_net_udp);

struct MachineFacts {
  bool loopback_up = false;
  std::optional<Problem> multicast_problem;        ///< as diagnoseMulticast()
  std::optional<std::string> multicast_interface;  ///< as multicastInterface()
  std::int64_t receive_buffer = 0;  ///< [byte] largest receive buffer that a socket can get
  std::int64_t free_bytes = 0;      ///< [byte] on the disk of the runs
  bool has_logger = false;          ///< lcm-logger
  bool has_gnuplot = false;
  std::vector<std::filesystem::path> stale_registrations;
  std::vector<int> busy_ports;            ///< as listeningPorts(), if LCM's group has a member
  std::optional<bool> clock_disciplined;  ///< by NTP or similar; nothing if unknown
  unsigned cpus = 0;
  bool has_ssh = false;
  bool has_gateway = false;          ///< dds_gateway is installed beside this program
  bool has_emulator = false;         ///< robot_emulator is installed beside this program
  std::optional<int> fragment_time;  ///< [s] ipfrag_time; nothing if unknown
  int serial_lines = 0;              ///< number of connected lines
  std::vector<std::string> closed_serial_lines;  ///< those without access for this user
  int cameras = 0;
  std::vector<std::string> closed_cameras;
  bool has_display = false;  ///< X11 or Wayland display in this session
};

/// Device files that match the patterns (as /dev/video*), and those that this user cannot read and
/// write.
struct Devices {
  int count = 0;
  std::vector<std::string> closed;
};
[[nodiscard]] Devices devices(const std::vector<std::string>& patterns);

/// Reads the facts.
/// @param runs folder for the runs
/// @param registrations registryDirectory()
[[nodiscard]] MachineFacts survey(const std::filesystem::path& runs,
                                  const std::filesystem::path& registrations);

}  // namespace lab::runner
