/// What this machine is and can do, read from the system: the facts the doctor judges, and the
/// checks a run makes before it starts anything.
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
  std::string fix;  ///< the line to type
};

/// Why LCM's multicast cannot work on this machine; nothing when a datagram sent to the group with
/// ttl 0 came back. Takes under a millisecond when all is well and 0.3 s when a firewall swallows
/// the datagram.
[[nodiscard]] std::optional<Problem> diagnoseMulticast();

/// The same as one line: the problem and what mends it.
[[nodiscard]] std::optional<std::string> multicastProblem();

/// The interface by which multicast leaves ("lo", "eth0"); nothing without a route or without the
/// program `ip`.
[[nodiscard]] std::optional<std::string> multicastInterface();

/// Why messages with ttl 0 might leave this machine all the same, and what prevents it; empty: they
/// cannot.
[[nodiscard]] std::string unpinnedWarning();

/// The device in the answer of `ip route get`.
[[nodiscard]] std::optional<std::string> interfaceOfRoute(std::string_view answer);

/// Bytes that an unprivileged user can still write where `path` is or will be made; 0 when no
/// ancestor of it can be asked.
[[nodiscard]] std::int64_t freeBytes(const std::filesystem::path& path);

/// The first executable file of that name in $PATH.
[[nodiscard]] std::optional<std::filesystem::path> findProgram(std::string_view name);

/// Registrations of labs whose runner is no longer alive, in order of name: the files <pid>.json of
/// `folder` (lab_registry.hpp). An absent folder has none.
[[nodiscard]] std::vector<std::filesystem::path> staleRegistrations(
    const std::filesystem::path& folder);

/// UDP ports from 20000 to 59999 that listen on every address and to nobody in particular, as LCM's
/// sockets do, ascending, from the text of /proc/net/udp. Other programs do so too.
[[nodiscard]] std::vector<int> listeningPorts(std::string_view proc_net_udp);

struct MachineFacts {
  bool loopback_up = false;
  std::optional<Problem> multicast_problem;        ///< as diagnoseMulticast()
  std::optional<std::string> multicast_interface;  ///< as multicastInterface()
  std::int64_t receive_buffer = 0;                 ///< [byte] the largest a socket gets
  std::int64_t free_bytes = 0;                     ///< [byte] where runs go
  bool has_logger = false;                         ///< lcm-logger
  bool has_gnuplot = false;
  std::vector<std::filesystem::path> stale_registrations;
  std::vector<int> busy_ports;            ///< as listeningPorts(), where LCM's group has a listener
  std::optional<bool> clock_disciplined;  ///< by NTP or the like; nothing: the system does not say
  unsigned cpus = 0;
  bool has_ssh = false;
  bool has_gateway = false;          ///< dds_gateway, beside this program
  bool has_emulator = false;         ///< robot_emulator, likewise
  std::optional<int> fragment_time;  ///< [s] a message that lacks a fragment keeps its place
  int serial_lines = 0;              ///< plugged in
  std::vector<std::string> closed_serial_lines;  ///< of these, those we may not use
  int cameras = 0;
  std::vector<std::string> closed_cameras;
  bool has_display = false;  ///< X11 or Wayland, in this session
};

/// Device files of these patterns (as /dev/video*), and those of them that we may not read and
/// write.
struct Devices {
  int count = 0;
  std::vector<std::string> closed;
};
[[nodiscard]] Devices devices(const std::vector<std::string>& patterns);

/// Reads the facts. @param runs where runs are written @param registrations as
/// registryDirectory()
[[nodiscard]] MachineFacts survey(const std::filesystem::path& runs,
                                  const std::filesystem::path& registrations);

}  // namespace lab::runner
