#include "runner/doctor/doctor_hosts.hpp"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "common/experiment/service_placement.hpp"
#include "runner/hosts/remote_host.hpp"

namespace lab::runner {
namespace {

using Level = Finding::Level;
using Steady = std::chrono::steady_clock;

constexpr auto kTimeout = std::chrono::seconds(15);

bool isDecided(RemoteHost::State state) { return state != RemoteHost::State::kCalling; }

Finding findingOf(const RemoteHost& host) {
  if (host.state() == RemoteHost::State::kMet) {
    return {Level::kOk,
            fmt::format("host {} ({}): the same lab, clock {:+.2f} ms, known to {:.2f} ms",
                        host.spec().name, host.hello().host, host.clock().offset * 1e3,
                        host.clock().error * 1e3),
            ""};
  }
  const std::string& why = host.trouble();
  return {Level::kError, why.empty() ? "host " + host.spec().name + " does not answer" : why,
          "ssh " + host.spec().ssh + " true  # docs/hosts.md"};
}

}  // namespace

std::vector<Finding> examineHosts(const Experiment& experiment) {
  std::vector<std::unique_ptr<RemoteHost>> hosts;
  for (const std::string& name : hostsInUse(experiment)) {
    hosts.push_back(
        std::make_unique<RemoteHost>(hostSpec(experiment, name), experiment.link.max_clock_offset));
    hosts.back()->connect();
  }
  const auto deadline = Steady::now() + kTimeout;
  std::vector<Finding> findings;
  for (const auto& host : hosts) {
    while (!isDecided(host->state()) && Steady::now() < deadline) {
      for (const auto& any : hosts) any->attend();
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    findings.push_back(findingOf(*host));
  }
  for (const auto& host : hosts) host->disconnect();
  return findings;
}

}  // namespace lab::runner
