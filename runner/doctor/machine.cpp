#include "runner/doctor/machine.hpp"

#include <arpa/inet.h>
#include <glob.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

#include "common/process/child_process.hpp"
#include "common/process/installation.hpp"
#include "common/process/output_tail.hpp"
#include "common/process/pipe.hpp"
#include "runner/runs/network.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGroup = "239.255.76.67";  // LCM's default group
constexpr int kProbeWait = 300;                  // [ms]
constexpr int kBufferAsked = 4194304;            // [byte] recv_buf_size of the lab's URL
constexpr const char* kRouteFix =
    "sudo ip link set dev lo up; sudo ip route add 224.0.0.0/4 dev lo";

class UdpSocket {
 public:
  UdpSocket() : handle_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~UdpSocket() {
    if (handle_ >= 0) close(handle_);
  }
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;
  [[nodiscard]] int handle() const { return handle_; }

 private:
  int handle_;
};

sockaddr_in addressOf(in_addr_t host, in_port_t port_in_network_order) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = host;
  address.sin_port = port_in_network_order;
  return address;
}

/// The type that the socket functions take for every address family.
sockaddr* generic(sockaddr_in& address) { return reinterpret_cast<sockaddr*>(&address); }

std::string systemError() { return std::generic_category().message(errno); }

bool loopbackUp() {
  const UdpSocket udp;
  ifreq request{};
  std::strncpy(request.ifr_name, "lo", IFNAMSIZ - 1);
  return ioctl(udp.handle(), SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

/// Requests a buffer and reads its size, because a container may hide /proc/sys/net/core/rmem_max.
/// The kernel returns twice the usable size (man 7 socket).
std::int64_t largestReceiveBuffer() {
  const UdpSocket udp;
  int bytes = kBufferAsked;
  socklen_t size = sizeof bytes;
  setsockopt(udp.handle(), SOL_SOCKET, SO_RCVBUF, &bytes, size);
  return getsockopt(udp.handle(), SOL_SOCKET, SO_RCVBUF, &bytes, &size) == 0 ? bytes / 2 : 0;
}

std::optional<bool> clockDisciplined() {
  timex query{};
  const int state = adjtimex(&query);
  if (state < 0) return std::nullopt;
  return state != TIME_ERROR && (query.status & STA_UNSYNC) == 0;
}

std::string textOf(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// /proc/net lists LCM's group as the hexadecimal digits of its address in network byte order.
std::string groupDigits() {
  std::array<char, 9> digits{};
  std::snprintf(digits.data(), digits.size(), "%08X", inet_addr(kGroup));
  return digits.data();
}

bool groupHasListener() {
  return textOf("/proc/net/igmp").find(groupDigits()) != std::string::npos;
}

}  // namespace

std::optional<Problem> diagnoseMulticast() {
  const UdpSocket udp;
  sockaddr_in own = addressOf(INADDR_ANY, 0);
  socklen_t size = sizeof own;
  if (bind(udp.handle(), generic(own), size) != 0 ||
      getsockname(udp.handle(), generic(own), &size) != 0) {
    return Problem{"no UDP socket can be opened: " + systemError(), "ulimit -n"};
  }
  const ip_mreq membership{{inet_addr(kGroup)}, {INADDR_ANY}};
  const unsigned char ttl = 0;
  sockaddr_in group = addressOf(inet_addr(kGroup), own.sin_port);
  const char probe = 'p';
  if (setsockopt(udp.handle(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) !=
          0 ||
      setsockopt(udp.handle(), IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl) != 0 ||
      sendto(udp.handle(), &probe, 1, 0, generic(group), sizeof group) != 1) {
    return Problem{"this machine has no multicast route (" + systemError() + ")", kRouteFix};
  }
  pollfd readable{udp.handle(), POLLIN, 0};
  if (poll(&readable, 1, kProbeWait) == 1) return std::nullopt;
  return Problem{"multicast does not come back to this machine: a firewall drops it",
                 std::string("sudo nft list ruleset  # allow UDP to ") + kGroup};
}

std::optional<std::string> multicastProblem() {
  const std::optional<Problem> problem = diagnoseMulticast();
  if (!problem) return std::nullopt;
  return problem->what + ": " + problem->fix;
}

std::optional<std::string> interfaceOfRoute(std::string_view answer) {
  std::istringstream words{std::string(answer)};
  for (std::string word; words >> word;) {
    if (word == "dev" && words >> word) return word;
  }
  return std::nullopt;
}

std::optional<std::string> multicastInterface() {
  constexpr std::chrono::seconds kTimeout{2};
  try {
    Pipe pipe = makePipe();
    ChildProcess ip({.arguments = {"ip", "route", "get", kGroup}, .output = pipe.in.get()});
    pipe.in = FileDescriptor();
    ip.waitFor(kTimeout);
    OutputTail answer(512);
    answer.open(std::move(pipe.out));
    answer.take();
    return interfaceOfRoute(answer.text());
  } catch (const std::system_error&) {
    return std::nullopt;
  }
}

std::string unpinnedWarning() {
  const std::string by = multicastInterface().value_or("lo");
  if (by == "lo") return {};
  return "multicast is routed over " + by +
         ": if that connection changes during the run, messages leave this machine; sudo ip "
         "route add 224.0.0.0/4 dev lo prevents it (lab doctor)";
}

std::int64_t freeBytes(const fs::path& path) {
  std::error_code error;
  for (fs::path place = fs::absolute(path, error); !place.empty(); place = place.parent_path()) {
    const fs::space_info space = fs::space(place, error);
    if (!error) return static_cast<std::int64_t>(space.available);
    if (place == place.root_path()) break;
  }
  return 0;
}

std::optional<fs::path> findProgram(std::string_view name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder) / name;
    std::error_code error;
    if (fs::is_regular_file(file, error) && access(file.c_str(), X_OK) == 0) return file;
  }
  return std::nullopt;
}

std::vector<fs::path> staleRegistrations(const fs::path& folder) {
  std::vector<fs::path> stale;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    pid_t owner = 0;
    std::istringstream(entry.path().stem().string()) >> owner;
    if (owner <= 0 || entry.path().extension() != ".json") continue;
    if (kill(owner, 0) != 0 && errno == ESRCH) stale.push_back(entry.path());
  }
  std::sort(stale.begin(), stale.end());
  return stale;
}

std::vector<int> listeningPorts(std::string_view proc_net_udp) {
  std::vector<int> ports;
  std::istringstream lines{std::string(proc_net_udp)};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::string slot, own, peer;
    fields >> slot >> own >> peer;
    // LcmBus and LCM 1.5 bind to the group, LCM 1.3.1 to any address.
    const bool listens = own.starts_with("00000000:") || own.starts_with(groupDigits() + ":");
    if (!listens || peer != "00000000:0000") continue;
    const int number = std::stoi(own.substr(own.find(':') + 1), nullptr, 16);
    if (number >= kFirstPort && number <= kLastPort) ports.push_back(number);
  }
  std::sort(ports.begin(), ports.end());
  ports.erase(std::unique(ports.begin(), ports.end()), ports.end());
  return ports;
}

Devices devices(const std::vector<std::string>& patterns) {
  Devices found;
  for (const std::string& pattern : patterns) {
    glob_t matches{};
    if (glob(pattern.c_str(), 0, nullptr, &matches) == 0) {
      for (std::size_t i = 0; i < matches.gl_pathc; ++i) {
        ++found.count;
        const char* path = matches.gl_pathv[i];
        if (access(path, R_OK | W_OK) != 0) found.closed.emplace_back(path);
      }
    }
    globfree(&matches);
  }
  return found;
}

MachineFacts survey(const fs::path& runs, const fs::path& registrations) {
  MachineFacts facts;
  facts.loopback_up = loopbackUp();
  facts.multicast_problem = diagnoseMulticast();
  facts.multicast_interface = multicastInterface();
  facts.receive_buffer = largestReceiveBuffer();
  facts.free_bytes = freeBytes(runs);
  facts.has_logger = findProgram("lcm-logger").has_value();
  facts.has_gnuplot = findProgram("gnuplot").has_value();
  facts.stale_registrations = staleRegistrations(registrations);
  if (groupHasListener()) facts.busy_ports = listeningPorts(textOf("/proc/net/udp"));
  facts.clock_disciplined = clockDisciplined();
  facts.cpus = std::thread::hardware_concurrency();
  facts.has_ssh = findProgram("ssh").has_value();
  facts.has_gateway = fs::exists(installation().programs / "dds_gateway");
  facts.has_emulator = fs::exists(installation().programs / "robot_emulator");
  int seconds = 0;
  if (std::istringstream(textOf("/proc/sys/net/ipv4/ipfrag_time")) >> seconds) {
    facts.fragment_time = seconds;
  }
  const Devices lines = devices({"/dev/ttyUSB*", "/dev/ttyACM*"});
  facts.serial_lines = lines.count;
  facts.closed_serial_lines = lines.closed;
  const Devices cameras = devices({"/dev/video*"});
  facts.cameras = cameras.count;
  facts.closed_cameras = cameras.closed;
  const auto is_set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  facts.has_display = is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
  return facts;
}

}  // namespace lab::runner
