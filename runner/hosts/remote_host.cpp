#include "runner/hosts/remote_host.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>
#include <utility>

#include "common/bus/value_checker.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/files/file_text.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/process/pipe.hpp"
#include "common/text/json_text.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/doctor/machine.hpp"
#include "runner/hosts/host_agent.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;
using Steady = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int kPings = 11;  // within what ClockOffsetEstimator needs and keeps
static_assert(kPings >= int{ClockOffsetEstimator::kEnough} &&
              kPings <= int{ClockOffsetEstimator::kWindow});
constexpr int kStep_ms = 5;
constexpr int kDisconnectTimeout_ms = 6000;
constexpr milliseconds kSshEnds{1000};
constexpr double kUnresponsive = 2.0;       // [s] of silence; after it no answer is awaited
constexpr std::size_t kChunk = 256 * 1024;  // [byte] of a file per message
constexpr std::size_t kMostRequestBytes = 8 * kChunk;
constexpr std::size_t kMostLines = 1000;            // per attend(), which must not take long
constexpr std::size_t kMostLogBytes = 100'000'000;  // of the output of one service

}  // namespace

/// A service on the remote host. While the host is silent, the service counts as running.
class RemoteService final : public ServiceProcess {
 public:
  RemoteService(RemoteHost& host, std::string name)
      : host_(host), name_(std::move(name)), connection_(host.connection()) {}

  bool running() override {
    if (!ending_.empty()) return false;
    if (connection_ != host_.connection()) {
      // It cannot be started again before the host is back.
      if (host_.state() == RemoteHost::State::kBegun) ending_ = kWithItsHost;
      return ending_.empty();
    }
    const RemoteHost::ServiceReport& report = host_.reports_[name_];
    if (report.ended) ending_ = report.how;
    return ending_.empty();
  }
  [[nodiscard]] bool ready() const override {
    return connection_ == host_.connection() && host_.reports_[name_].ready;
  }
  [[nodiscard]] const std::string& ending() const override { return ending_; }
  void terminate() override {
    if (reachable()) host_.request("end", name_);
  }
  bool waitOrKill(int timeout_ms) override {
    bool killed = false;
    for (int waited = 0; reachable() && running(); waited += kStep_ms) {
      if (waited >= timeout_ms && !killed) {
        host_.request("kill", name_);
        killed = true;
      }
      if (waited > 2 * timeout_ms) break;
      std::this_thread::sleep_for(milliseconds(kStep_ms));
      host_.attend();
    }
    return killed;
  }

 private:
  [[nodiscard]] bool reachable() const {
    return connection_ == host_.connection() && host_.state() == RemoteHost::State::kBegun &&
           host_.silentFor() < kUnresponsive;
  }

  RemoteHost& host_;
  std::string name_;
  int connection_;
  std::string ending_;
};

RemoteHost::RemoteHost(HostSpec spec, double max_clock_offset)
    : spec_(std::move(spec)), max_clock_offset_(max_clock_offset) {}

RemoteHost::~RemoteHost() { closeConnection(); }

void RemoteHost::connect() {
  closeConnection();
  const auto ssh = findProgram("ssh");
  if (!ssh) throw UserError("ssh is not installed: sudo apt-get install openssh-client");
  // RemoteHosts decides when a silent connection is lost, so the timeouts of ssh are disabled.
  const std::vector<std::string> arguments{
      ssh->string(),
      "-T",
      "-o",
      "BatchMode=yes",
      "-o",
      "ConnectTimeout=10",
      "-o",
      "ServerAliveInterval=0",
      "-o",
      "TCPKeepAlive=no",
      "-o",
      "ForwardX11=no",
      "-o",
      "ForwardAgent=no",
      "-o",
      "ControlPath=none",
      "-o",
      "ClearAllForwardings=yes",
      "-o",
      "RemoteCommand=none",
      "-o",
      "AddressFamily=inet",  // this lab uses DDS and LCM over IPv4 only
      "--",
      spec_.ssh,
      agentCommand(spec_)};
  try {
    Pipe to = makePipe();
    Pipe from = makePipe();
    Pipe errors = makePipe();
    ssh_.emplace(ChildSettings{.arguments = arguments,
                               .input = to.out.get(),
                               .output = from.in.get(),
                               .errors = errors.in.get()});
    errors_.open(std::move(errors.out));
    input_ = std::move(to.in);
    output_ = std::move(from.out);
  } catch (const std::system_error& error) {
    throw UserError(std::string(error.what()) + ": is ulimit -n or ulimit -u too low?");
  }
  lines_.emplace(output_.get(), input_.get());
  round_trips_ = {};
  pongs_ = 0;
  reports_.clear();
  trouble_.clear();
  last_receive_ = Steady::now();
  last_alive_ = last_receive_;
  state_ = State::kCalling;
}

void RemoteHost::closeConnection() {
  lines_.reset();
  outbox_.clear();
  input_ = FileDescriptor();  // ends the agent
  if (ssh_) {
    ssh_->signal(SIGTERM);
    ssh_->waitFor(kSshEnds);
  }
  ssh_.reset();
  output_ = FileDescriptor();
  errors_.close();
}

double RemoteHost::silentFor() const {
  return std::chrono::duration<double>(Steady::now() - last_receive_).count();
}

void RemoteHost::attend() {
  if (!lines_) return;
  errors_.take();
  lines_->receive([this](const Json& message) { handle(message); }, [](const std::string&) {},
                  kMostLines);
  if (!lines_) return;
  const auto now = Steady::now();
  if (now - last_alive_ >= milliseconds(kHostHeartbeat_ms) && state_ != State::kRefused) {
    last_alive_ = now;
    if (lines_->waiting() < kMostRequestBytes) lines_->send({{"do", "alive"}});
  }
  sendQueued();
  lines_->flush();
  // The last lines may have the reason of the end.
  if (state_ == State::kRefused || ssh_->running() || lines_->hasLine()) return;
  state_ = State::kGone;
  errors_.take();
  if (trouble_.empty()) trouble_ = sshTrouble(spec_, errors_.text(), ssh_->ending());
  closeConnection();
}

void RemoteHost::handle(const Json& message) {
  last_receive_ = Steady::now();
  const std::string what = message.value("say", "");
  const std::string service = message.value("service", "");
  // The names become file names and map keys here, so only known services are accepted.
  if (!service.empty() && std::ranges::find(kServiceNames, service) == kServiceNames.end()) return;
  if (what == "hello" && state_ == State::kCalling) {
    if (const auto hello = helloFrom(message)) compare(*hello);
  } else if (what == "pong" && state_ == State::kCalling) {
    measure(message);
  } else if (what == "begun" && state_ == State::kBeginning) {
    warning_ = message.value("warning", "");
    state_ = State::kBegun;
  } else if (what == "line") {
    write(service, message.value("text", ""));
  } else if (what == "ready") {
    reports_[service].ready = true;
  } else if (what == "ended") {
    reports_[service].ended = true;
    reports_[service].how = message.value("how", "ended");
  } else if (what == "trouble") {
    trouble_ = "host " + spec_.name + ": " + message.value("text", "");
    if (state_ < State::kBegun) state_ = State::kRefused;
    write("host-agent", message.value("text", ""));
  }
}

void RemoteHost::compare(const HostHello& hello) {
  hello_ = hello;
  trouble_ = refusal(spec_, ownHello(), hello);
  if (!trouble_.empty()) {
    state_ = State::kRefused;
    return;
  }
  lines_->send({{"do", "ping"}, {"utime", wallClock()}});
}

void RemoteHost::measure(const Json& pong) {
  // The agent answers at once: a single time stands for arrival and answer.
  std::int64_t there = 0;
  std::int64_t asked = 0;
  try {
    there = wholeNumber<std::int64_t>(pong.at("utime"), 0, ValueChecker::kLatestUtime);
    asked = wholeNumber<std::int64_t>(pong.at("asked"), 0, ValueChecker::kLatestUtime);
  } catch (const std::exception& error) {
    trouble_ = fmt::format("host {}: found an answer of its lab host-agent without the time: {}",
                           spec_.name, error.what());
    state_ = State::kRefused;
    return;
  }
  round_trips_.add(asked, there, there, wallClock());
  if (++pongs_ < kPings) {
    lines_->send({{"do", "ping"}, {"utime", wallClock()}});
    return;
  }
  trouble_ = clockRefusal(spec_, clock(), max_clock_offset_);
  state_ = trouble_.empty() ? State::kMet : State::kRefused;
  if (state_ == State::kMet) ++connection_;
}

void RemoteHost::begin(const RunSetup& setup) {
  state_ = State::kBeginning;
  logs_ = setup.logs;
  if (!logs_.empty()) fs::create_directories(logs_);
  queue({{"do", "begin"},
         {"name", setup.name},
         {"host", spec_.name},
         {"port", setup.port},
         {"ttl", setup.ttl},
         {"patience_s", setup.patience}});
  for (const HostFile& file : setup.files) send(file);
}

void RemoteHost::queue(Json message) {
  outbox_.emplace_back([this, message = std::move(message)] {
    lines_->send(message);
    return true;
  });
  if (lines_) sendQueued();
}

/// Keeps at most kMostRequestBytes in memory; attend() sends the rest of large files later.
void RemoteHost::sendQueued() {
  while (!outbox_.empty() && lines_->waiting() < kMostRequestBytes) {
    if (outbox_.front()()) outbox_.pop_front();
  }
}

void RemoteHost::drop(const std::string& why) {
  closeConnection();
  state_ = State::kGone;
  trouble_ = why;
}

void RemoteHost::send(const HostFile& file) {
  if (file.source.empty()) {
    queue({{"do", "file"}, {"path", file.path}, {"data", encodedBytes(file.text)}});
    return;
  }
  const std::string problem = regularFileProblem(file.source, file_kinds::kAny);
  if (!problem.empty()) throw UserError(file.source.string() + ": " + problem);
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

std::unique_ptr<ServiceProcess> RemoteHost::start(const StartRequest& request) {
  reports_[request.service] = {};
  if (lines_) {
    queue({{"do", "start"},
           {"service", request.service},
           {"experiment", request.experiment},
           {"uses_ports", request.uses_ports},
           {"arguments", request.arguments}});
  }
  return std::make_unique<RemoteService>(*this, request.service);
}

void RemoteHost::request(const char* what, const std::string& service) {
  if (lines_) queue({{"do", what}, {"service", service}});
}

void RemoteHost::write(const std::string& service, const std::string& text) const {
  if (logs_.empty() || service.empty() || service.find('/') != std::string::npos) return;
  std::ofstream file(logs_ / (service + ".txt"), std::ios::app);
  file.seekp(0, std::ios::end);
  const auto size = static_cast<std::streamoff>(file.tellp());
  if (size < 0 || static_cast<std::size_t>(size) >= kMostLogBytes) return;
  const std::size_t left = kMostLogBytes - static_cast<std::size_t>(size);
  if (text.size() + 1 < left) {
    file << text << '\n';
  } else {  // filled to the limit, so that this is said once
    file << text.substr(0, left) << "\n[further output is left out: this file has "
         << kMostLogBytes / 1'000'000 << " MB]\n";
  }
}

void RemoteHost::disconnect() {
  if (lines_ && state_ != State::kCalling && silentFor() < kUnresponsive) {
    lines_->send({{"do", "stop"}});
    for (int waited = 0; lines_ && ssh_->running() && waited < kDisconnectTimeout_ms;
         waited += kStep_ms) {
      std::this_thread::sleep_for(milliseconds(kStep_ms));
      attend();
    }
  }
  closeConnection();
  state_ = State::kGone;
}

}  // namespace lab::runner
