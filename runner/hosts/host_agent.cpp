#include "runner/hosts/host_agent.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <lab/service_status_t.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/files/scratch_folder.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/process/installation.hpp"
#include "common/process/orphan_guard.hpp"
#include "common/process/pipe.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/doctor/machine.hpp"
#include "runner/hosts/agent_lock.hpp"
#include "runner/hosts/host_contract.hpp"
#include "runner/hosts/json_lines.hpp"
#include "runner/live/local_process.hpp"
#include "runner/runs/lab_registry.hpp"
#include "runner/runs/network.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kAgentTick_us = 50'000;
constexpr std::int64_t kInitialTimeout_us = 60'000'000;  // until "begin" sets the timeout
constexpr int kKillTimeout_ms = 3000;
constexpr std::size_t kMostBytesQueued = 4'000'000;  // [byte] above: output is not read on
constexpr std::size_t kLongestServiceLine = 65'536;  // [byte] longer lines are split
constexpr int kFinalFlush_ms = 1000;
constexpr int kFlushPeriod_ms = 10;

/// A temporary folder that is removed even if this process is killed: a forked child process
/// waits until the pipe from this process closes, and then removes the folder.
class HostFolder {
 public:
  HostFolder() {
    path_ = makeUniqueFolder(fs::temp_directory_path(), "active-lab-host");
    if (path_.empty()) {
      throw UserError("cannot make a folder in " + fs::temp_directory_path().string());
    }
    Pipe pipe = makePipe();
    const pid_t cleaner = fork();
    if (cleaner == 0) clean(pipe.out.get(), pipe.in.get());
    alive_pipe_ = std::move(pipe.in);
  }
  ~HostFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  HostFolder(const HostFolder&) = delete;
  HostFolder& operator=(const HostFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  [[noreturn]] void clean(int wait_for, int own_end) const {
    setsid();
    for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGPIPE}) ::signal(signal, SIG_IGN);
    for (int descriptor = 0; descriptor < 3; ++descriptor)
      close(descriptor);  // ssh waits while one of them is open
    close(own_end);
    char unused = 0;
    while (read(wait_for, &unused, 1) < 0 && errno == EINTR) {
    }
    // Services that are ending may still write files, so the folder is removed again later.
    std::error_code error;
    for (const int pause_ms : {0, 1000, 3000}) {
      if (!fs::exists(path_, error)) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
      fs::remove_all(path_, error);
    }
    _exit(0);
  }

  fs::path path_;
  FileDescriptor alive_pipe_;
};

class Agent {
 public:
  Agent(fs::path programs, const HostFolder& folder)
      : programs_(std::move(programs)), folder_(folder), lines_(STDIN_FILENO, STDOUT_FILENO) {}

  void execute() {
    lines_.send(toJson(ownHello()));
    last_receive_us_ = loop_.now();
    loop_.onSignals({SIGINT, SIGTERM, SIGHUP}, [this](int) { loop_.stop(); });
    loop_.onReadable(STDIN_FILENO, [this] { receive(); });
    loop_.every(kAgentTick_us, loop_.now(), [this] { update(); });
    loop_.every(kHostHeartbeat_ms * 1000, loop_.now(), [this] {
      lines_.send({{"say", "alive"}, {"utime", wallClock()}});
    });
    loop_.run();
    endAll();
    lines_.send({{"say", "left"}});
    for (int waited = 0; lines_.waiting() > 0 && !lines_.closed() && waited < kFinalFlush_ms;
         waited += kFlushPeriod_ms) {
      std::this_thread::sleep_for(std::chrono::milliseconds(kFlushPeriod_ms));
      lines_.flush();
    }
  }

 private:
  struct Running {
    std::string name;
    std::unique_ptr<LocalProcess> process;
    fs::path output;
    std::streamoff read = 0;
    std::string partial_line;  ///< output since the last end of line
    bool end_reported = false;
    bool ready = false;
  };

  void receive() {
    lines_.receive(
        [this](const Json& request) {
          last_receive_us_ = loop_.now();
          try {
            handle(request);
          } catch (const std::exception& error) {
            reportTrouble(error.what());
          }
        },
        [this](const std::string&) { reportTrouble("a line that is not JSON"); });
    if (lines_.closed()) loop_.stop();
  }

  void reportTrouble(const std::string& text) { lines_.send({{"say", "trouble"}, {"text", text}}); }

  void handle(const Json& request) {
    const std::string what = request.value("do", "");
    if (what == "ping") {
      lines_.send({{"say", "pong"}, {"asked", request.at("utime")}, {"utime", wallClock()}});
    } else if (what == "begin") {
      begin(request);
    } else if (what == "file") {
      append(request);
    } else if (what == "start") {
      start(request);
    } else if (what == "end" || what == "kill") {
      Running* service = find(request.at("service"));
      if (service == nullptr || !service->process->running()) return;
      what == "end" ? service->process->terminate() : service->process->kill();
    } else if (what == "stop") {
      loop_.stop();
    } else if (what != "alive") {
      reportTrouble("unknown request: " + what);
    }
  }

  void begin(const Json& request) {
    timeout_us_ = static_cast<std::int64_t>(request.at("patience_s").get<double>() * 1e6);
    if (const auto problem = multicastProblem()) throw UserError(*problem);
    const int wanted = request.value("port", 0);
    const int ttl = request.value("ttl", 0);
    const int port = choosePort(wanted);
    if (wanted == 0) port_lock_.emplace(port);
    url_ = lcmUrl(port, ttl);
    bus_ = std::make_unique<LcmBus>(url_);
    bus_->subscribe(channels::kServiceStatus,
                    [this](const Packet& packet) { onServiceStatus(packet); });
    loop_.onReadable(bus_->fileDescriptor(), [this] { bus_->drain(); });
    registration_.emplace(
        RunningLab{request.value("name", "lab"), url_, getpid(), folder_.path().string()});
    agent_lock_.emplace(request.value("name", "lab") + "-" + request.value("host", "host"));
    std::string warning;
    if (ttl == 0 && multicastInterface().value_or("") != "lo") warning = unpinnedWarning();
    lines_.send({{"say", "begun"}, {"url", url_}, {"warning", warning}});
  }

  void append(const Json& request) {
    const fs::path name = fs::path(request.at("path").get<std::string>()).lexically_normal();
    if (name.is_absolute() || name.empty() || *name.begin() == "..") {
      throw UserError("a path outside the folder of the run: " + name.string());
    }
    fs::create_directories((folder_.path() / name).parent_path());
    std::ofstream file(folder_.path() / name, std::ios::binary | std::ios::app);
    file << decodedBytes(request.at("data").get<std::string>()) << std::flush;
    if (!file) throw UserError("cannot write " + name.string() + ": is the disk full?");
  }

  void start(const Json& request) {
    if (!bus_) throw UserError("start before begin");
    const std::string name = request.at("service");
    if (name.empty() || name.find('/') != std::string::npos)
      throw UserError("not a service: " + name);
    const fs::path program = programs_ / name;
    if (access(program.c_str(), X_OK) != 0) {
      throw UserError(program.string() + " does not exist: " +
                      installation().installHint(name, "build the lab there (./lab build)"));
    }
    std::vector<std::string> arguments{
        program.string(),
        "--experiment",
        (folder_.path() / request.at("experiment").get<std::string>()).string(),
        "--lcm-url",
        url_,
        "--clock-offset-us",
        std::to_string(loop_.clockOffset())};
    if (request.value("uses_ports", false)) {
      arguments.insert(arguments.end(), {"--ports", (folder_.path() / files::kPorts).string()});
    }
    for (const std::string& argument : request.value("arguments", std::vector<std::string>{})) {
      arguments.push_back(argument);
    }
    std::erase_if(services_, [&](const auto& service) { return service->name == name; });
    auto service = std::make_unique<Running>();
    service->name = name;
    service->output = folder_.path() / fmt::format("{}.{}.txt", name, ++starts_);
    service->process = std::make_unique<LocalProcess>(arguments, service->output);
    if (const pid_t pid = service->process->pid(); pid > 0) guard_.watch(pid);
    services_.push_back(std::move(service));
    lines_.send({{"say", "started"}, {"service", name}});
  }

  Running* find(const std::string& name) {
    for (const auto& service : services_) {
      if (service->name == name) return service.get();
    }
    return nullptr;
  }

  void onServiceStatus(const Packet& packet) {
    service_status_t status{};
    if (!decode(packet.data, status) || status.state != service_status_t::READY) return;
    Running* service = find(status.sender);
    if (service == nullptr || service->ready || service->process->pid() != status.pid) return;
    service->ready = true;
    lines_.send({{"say", "ready"}, {"service", service->name}});
  }

  void update() {
    for (const auto& service : services_) {
      const bool running = service->process->running();
      forwardOutput(*service);
      if (running || service->end_reported) continue;
      service->end_reported = true;
      lines_.send(
          {{"say", "ended"}, {"service", service->name}, {"how", service->process->ending()}});
    }
    lines_.flush();
    if (lines_.closed() || loop_.now() - last_receive_us_ > timeout_us_) loop_.stop();
  }

  /// Sends what the service has printed since the last call.
  /// @return whether there was new output
  bool forwardOutput(Running& service) {
    if (lines_.waiting() > kMostBytesQueued) return false;
    std::ifstream file(service.output, std::ios::binary);
    file.seekg(service.read);
    std::string text(65536, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    service.read += file.gcount();
    service.partial_line += text;
    if (service.partial_line.size() > kLongestServiceLine &&
        service.partial_line.find('\n') == std::string::npos) {
      service.partial_line += '\n';
    }
    std::size_t begin = 0;
    for (std::size_t end = 0; (end = service.partial_line.find('\n', begin)) != std::string::npos;
         begin = end + 1) {
      lines_.send({{"say", "line"},
                   {"service", service.name},
                   {"text", service.partial_line.substr(begin, end - begin)}});
    }
    service.partial_line.erase(0, begin);
    return !text.empty();
  }

  /// Ends dds_gateway last, because the last messages of the other services pass through it.
  void endAll() {
    std::stable_partition(services_.begin(), services_.end(),
                          [](const auto& service) { return service->name != "dds_gateway"; });
    for (const auto& service : services_) {
      service->process->terminate();
      service->process->waitOrKill(kKillTimeout_ms);
      while (forwardOutput(*service)) {
      }
      if (service->partial_line.empty()) continue;
      lines_.send({{"say", "line"}, {"service", service->name}, {"text", service->partial_line}});
      service->partial_line.clear();
    }
    update();
  }

  fs::path programs_;
  const HostFolder& folder_;
  OrphanGuard guard_;
  AsioLoop loop_;
  JsonLines lines_;
  std::optional<AgentLock> agent_lock_;
  std::optional<PortLock> port_lock_;
  std::string url_;
  std::unique_ptr<LcmBus> bus_;
  std::optional<Registration> registration_;
  std::vector<std::unique_ptr<Running>> services_;
  std::int64_t last_receive_us_ = 0;
  std::int64_t timeout_us_ = kInitialTimeout_us;
  int starts_ = 0;
};

}  // namespace

int hostAgent(const fs::path& programs) {
  const HostFolder folder;
  Agent(programs, folder).execute();
  return kDone;
}

}  // namespace lab::runner
