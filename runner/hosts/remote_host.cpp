#include "runner/hosts/remote_host.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/experiment/service_placement.hpp"
#include "common/loop/wall_clock.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/doctor/machine.hpp"
#include "runner/hosts/host_agent.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;
using Steady = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int kPings = 11;
constexpr int kStep_ms = 5;
constexpr int kLeavePatience_ms = 6000;
constexpr double kDeaf = 2.0;               // [s] then nobody waits for its answer
constexpr std::size_t kChunk = 256 * 1024;  // [byte] of a file in one line
constexpr std::size_t kMostBytesWaiting = 8 * kChunk;
constexpr std::int64_t kMostNoise = 16384;  // [byte]

void closeIfOpen(int& descriptor) {
  if (descriptor >= 0) close(descriptor);
  descriptor = -1;
}

}  // namespace

/// A service that runs there. What a host that is silent does is not known: it is taken to run.
class RemoteService final : public ServiceProcess {
 public:
  RemoteService(RemoteHost& host, std::string name)
      : host_(host), name_(std::move(name)), meeting_(host.meeting()) {}

  bool running() override {
    if (!ending_.empty()) return false;
    if (meeting_ != host_.meeting()) {
      // Nobody can start it again before the host is back.
      if (host_.state() == RemoteHost::State::kBegun) ending_ = kWithItsHost;
      return ending_.empty();
    }
    const RemoteHost::Told& told = host_.told_[name_];
    if (told.ended) ending_ = told.how;
    return ending_.empty();
  }
  [[nodiscard]] bool ready() const override {
    return meeting_ == host_.meeting() && host_.told_[name_].ready;
  }
  [[nodiscard]] const std::string& ending() const override { return ending_; }
  void terminate() override {
    if (reachable()) host_.order("end", name_);
  }
  bool waitOrKill(int patience_ms) override {
    bool killed = false;
    for (int waited = 0; reachable() && running(); waited += kStep_ms) {
      if (waited >= patience_ms && !killed) {
        host_.order("kill", name_);
        killed = true;
      }
      if (waited > 2 * patience_ms) break;
      std::this_thread::sleep_for(milliseconds(kStep_ms));
      host_.attend();
    }
    return killed;
  }

 private:
  [[nodiscard]] bool reachable() const {
    return meeting_ == host_.meeting() && host_.state() == RemoteHost::State::kBegun &&
           host_.silentFor() < kDeaf;
  }

  RemoteHost& host_;
  std::string name_;
  int meeting_;
  std::string ending_;
};

RemoteHost::RemoteHost(HostSpec spec, double max_clock_offset)
    : spec_(std::move(spec)), max_clock_offset_(max_clock_offset) {}

RemoteHost::~RemoteHost() { hangUp(); }

void RemoteHost::call() {
  hangUp();
  const auto ssh = findProgram("ssh");
  if (!ssh) throw UserError("ssh is not installed: sudo apt-get install openssh-client");
  std::array<int, 2> to{};
  std::array<int, 2> from{};
  errors_ = memfd_create("ssh", MFD_CLOEXEC);
  if (errors_ < 0 || pipe2(to.data(), O_CLOEXEC) != 0 || pipe2(from.data(), O_CLOEXEC) != 0) {
    throw UserError("no more files can be opened: ulimit -n");
  }
  // Silence is judged here, where the run knows how long to wait: ssh is not to hang up by itself.
  const std::vector<std::string> arguments{
      ssh->string(), "-T",
      "-o",          "BatchMode=yes",
      "-o",          "ConnectTimeout=10",
      "-o",          "ServerAliveInterval=0",
      "-o",          "TCPKeepAlive=no",
      "-o",          "ForwardX11=no",
      "-o",          "ForwardAgent=no",
      "-o",          "ControlPath=none",
      "-o",          "ClearAllForwardings=yes",
      "-o",          "RemoteCommand=none",
      "-o",          "AddressFamily=inet",  // DDS and LCM take no other here
      spec_.ssh,     agentCommand(spec_)};
  ssh_ =
      std::make_unique<ChildProcess>("ssh", arguments, "/proc/self/fd/" + std::to_string(errors_),
                                     ChildProcess::Streams{to[0], from[1]});
  close(to[0]);
  close(from[1]);
  input_ = to[1];
  output_ = from[0];
  lines_.emplace(output_, input_);
  clock_ = {};
  told_.clear();
  trouble_.clear();
  heard_ = Steady::now();
  spoke_ = heard_;
  state_ = State::kCalling;
}

void RemoteHost::hangUp() {
  lines_.reset();
  outbox_.clear();
  closeIfOpen(input_);  // the agent ends
  if (ssh_) {
    ssh_->terminate();
    ssh_->waitOrKill(1000);
  }
  ssh_.reset();
  closeIfOpen(output_);
  closeIfOpen(errors_);
}

double RemoteHost::silentFor() const {
  return std::chrono::duration<double>(Steady::now() - heard_).count();
}

std::string RemoteHost::complaint() const {
  std::string text(kMostNoise, '\0');
  const ssize_t size = errors_ < 0 ? 0 : pread(errors_, text.data(), text.size(), 0);
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return text;
}

void RemoteHost::attend() {
  if (!lines_) return;
  lines_->receive([this](const Json& said) { take(said); }, [](const std::string&) {});
  if (!lines_) return;
  const auto now = Steady::now();
  if (now - spoke_ >= milliseconds(kHostHeartbeat_ms) && state_ != State::kRefused) {
    spoke_ = now;
    if (lines_->waiting() < kMostBytesWaiting) lines_->send({{"do", "alive"}});
  }
  feed();
  lines_->flush();
  if (state_ == State::kRefused || ssh_->running()) return;
  state_ = State::kGone;
  if (trouble_.empty()) trouble_ = sshTrouble(spec_, complaint(), ssh_->ending());
  hangUp();
}

void RemoteHost::take(const Json& said) {
  heard_ = Steady::now();
  const std::string what = said.value("say", "");
  const std::string service = said.value("service", "");
  // What a host says is not to name files or to fill memory here.
  if (!service.empty() && std::ranges::find(kServiceNames, service) == kServiceNames.end()) return;
  if (what == "hello" && state_ == State::kCalling) {
    if (const auto hello = helloFrom(said)) meet(*hello);
  } else if (what == "pong" && state_ == State::kCalling) {
    measure(said);
  } else if (what == "begun" && state_ == State::kBeginning) {
    warning_ = said.value("warning", "");
    state_ = State::kBegun;
  } else if (what == "line") {
    write(service, said.value("text", ""));
  } else if (what == "ready") {
    told_[service].ready = true;
  } else if (what == "ended") {
    told_[service].ended = true;
    told_[service].how = said.value("how", "ended");
  } else if (what == "trouble") {
    trouble_ = "host " + spec_.name + ": " + said.value("text", "");
    if (state_ < State::kBegun) state_ = State::kRefused;
    write("host-agent", said.value("text", ""));
  }
}

void RemoteHost::meet(const HostHello& hello) {
  hello_ = hello;
  trouble_ = refusal(spec_, ownHello(), hello);
  if (!trouble_.empty()) {
    state_ = State::kRefused;
    return;
  }
  lines_->send({{"do", "ping"}, {"utime", wallClock()}});
}

void RemoteHost::measure(const Json& pong) {
  clock_.add(pong.value("asked", std::int64_t{0}), pong.value("utime", std::int64_t{0}),
             wallClock());
  if (clock_.count() < kPings) {
    lines_->send({{"do", "ping"}, {"utime", wallClock()}});
    return;
  }
  trouble_ = clockRefusal(spec_, clock_.best(), max_clock_offset_);
  state_ = trouble_.empty() ? State::kMet : State::kRefused;
  if (state_ == State::kMet) ++meeting_;
}

void RemoteHost::begin(const RunSetup& beginning) {
  state_ = State::kBeginning;
  logs_ = beginning.logs;
  if (!logs_.empty()) fs::create_directories(logs_);
  say({{"do", "begin"},
       {"name", beginning.name},
       {"host", spec_.name},
       {"port", beginning.port},
       {"ttl", beginning.ttl},
       {"patience_s", beginning.patience}});
  for (const HostFile& file : beginning.files) send(file);
}

void RemoteHost::say(Json message) {
  outbox_.emplace_back([this, message = std::move(message)] {
    lines_->send(message);
    return true;
  });
  if (lines_) feed();
}

/// A recording is larger than what may wait in memory: the rest goes with the next attend().
void RemoteHost::feed() {
  while (!outbox_.empty() && lines_->waiting() < kMostBytesWaiting) {
    if (outbox_.front()()) outbox_.pop_front();
  }
}

void RemoteHost::lose(const std::string& why) {
  hangUp();
  state_ = State::kGone;
  trouble_ = why;
}

void RemoteHost::send(const HostFile& file) {
  if (file.source.empty()) {
    say({{"do", "file"}, {"path", file.path}, {"data", encodedBytes(file.text)}});
    return;
  }
  const auto stream = std::make_shared<std::ifstream>(file.source, std::ios::binary);
  if (!*stream) throw UserError("cannot read " + file.source.string());
  outbox_.emplace_back([this, stream, path = file.path] {
    std::string bytes(kChunk, '\0');
    stream->read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(stream->gcount()));
    lines_->send({{"do", "file"}, {"path", path}, {"data", encodedBytes(bytes)}});
    return !*stream;
  });
}

std::unique_ptr<ServiceProcess> RemoteHost::start(const Order& order) {
  told_[order.service] = {};
  if (lines_) {
    say({{"do", "start"},
         {"service", order.service},
         {"experiment", order.experiment},
         {"uses_ports", order.uses_ports},
         {"arguments", order.arguments}});
  }
  return std::make_unique<RemoteService>(*this, order.service);
}

void RemoteHost::order(const char* what, const std::string& service) {
  if (lines_) say({{"do", what}, {"service", service}});
}

void RemoteHost::write(const std::string& service, const std::string& text) const {
  if (logs_.empty() || service.empty() || service.find('/') != std::string::npos) return;
  std::ofstream(logs_ / (service + ".txt"), std::ios::app) << text << '\n';
}

void RemoteHost::leave() {
  if (lines_ && state_ != State::kCalling && silentFor() < kDeaf) {
    lines_->send({{"do", "stop"}});
    for (int waited = 0; lines_ && ssh_->running() && waited < kLeavePatience_ms;
         waited += kStep_ms) {
      std::this_thread::sleep_for(milliseconds(kStep_ms));
      attend();
    }
  }
  hangUp();
  state_ = State::kGone;
}

}  // namespace lab::runner
