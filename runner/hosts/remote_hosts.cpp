#include "runner/hosts/remote_hosts.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string_view>
#include <thread>

#include "common/experiment/experiment_file.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/text/printable.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {
namespace {

using Steady = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr auto kConnectTimeout = seconds(20);
constexpr auto kSilent = seconds(2);       // after this a fault is reported
constexpr auto kSure = milliseconds(500);  // a host that responds for this long is back
constexpr auto kReconnectPeriod = seconds(3);
constexpr auto kGiveUp =
    seconds(35);  // TCP retransmits within this time if a cable was out for 15 s
constexpr auto kLinkStatusTimeout = seconds(3);  // LINK_STATUS is sent once per second
// Answers are time-stamped when they are read, so a longer pause would count as network delay.
constexpr auto kStep = std::chrono::microseconds(200);

double inSeconds(Steady::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

std::string utcOf(Steady::time_point time) {
  const auto wall =
      std::chrono::system_clock::now() -
      std::chrono::duration_cast<std::chrono::system_clock::duration>(Steady::now() - time);
  return fmt::format("{:%H:%M:%S}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(wall)));
}

}  // namespace

RemoteHosts::RemoteHosts(const Experiment& experiment, const std::vector<std::string>& hosts)
    : experiment_(experiment), gateways_(joinsByGateways(experiment, hosts)) {
  std::random_device random;
  key_ = fmt::format("{:08x}{:08x}", random(), random());
  own_name_ = ownHello().host;
  if (own_name_.empty() || std::ranges::count(hosts, own_name_) != 0) own_name_ += "-runner";
  for (const std::string& host : hosts) {
    Host& entry = hosts_[host];
    entry.remote =
        std::make_unique<RemoteHost>(hostSpec(experiment, host), experiment.link.max_clock_offset);
    entry.remote->connect();
  }
  waitFor(RemoteHost::State::kMet, "does not answer");
  findAddresses();
}

void RemoteHosts::waitFor(RemoteHost::State state, const char* what) {
  const auto deadline = Steady::now() + kConnectTimeout;
  for (;;) {
    std::size_t done = 0;
    bool failed = false;
    attend();
    for (const auto& [name, host] : hosts_) {
      const auto now = host.remote->state();
      done += now == state ? 1 : 0;
      failed = failed || now == RemoteHost::State::kGone || now == RemoteHost::State::kRefused;
    }
    if (done == hosts_.size()) return;
    const bool late = Steady::now() > deadline;
    if (failed || late) break;
    std::this_thread::sleep_for(kStep);
  }
  std::string text;
  for (const auto& [name, host] : hosts_) {
    if (host.remote->state() == state) continue;
    std::string why = host.remote->trouble();
    if (why.empty() && Steady::now() > deadline) why = "host " + name + ": " + what;
    if (!why.empty()) text += (text.empty() ? "" : "\nlab: ") + why;
  }
  leave();
  throw UserError(text);
}

void RemoteHosts::findAddresses() {
  if (!gateways_) {
    for (const auto& [name, host] : hosts_) {
      const bool here = ownHello().multicast == "lo";
      if (!here && host.remote->hello().multicast != "lo") continue;
      throw UserError(fmt::format(
          "link.join = \"multicast\", and multicast is routed over lo {}, so that no message "
          "leaves; there: sudo ip route del 224.0.0.0/4 dev lo; or say join = \"dds\"",
          here ? "on this machine" : "on host " + name));
    }
    return;
  }
  own_address_ = experiment_.link.address;
  if (!own_address_.empty()) return;
  for (const auto& [name, host] : hosts_) {
    const auto ends = endsOf(host.remote->hello().ssh_connection);
    const std::string address = ends ? ends->here : "";
    if (!address.empty() && (own_address_.empty() || own_address_ == address)) {
      own_address_ = address;
      continue;
    }
    throw UserError(
        address.empty()
            ? "host " + name +
                  ": ssh does not say by which address it came; set link.address, and "
                  "hosts." +
                  name + ".address"
            : fmt::format("this machine is {} to some hosts and {} to host {}: set link.address to "
                          "the one that all of them reach",
                          own_address_, address, name));
  }
}

std::vector<std::string> RemoteHosts::names() const {
  std::vector<std::string> names;
  for (const auto& [name, host] : hosts_) names.push_back(name);
  return names;
}

std::vector<std::string> RemoteHosts::linkArguments(const std::string& host) const {
  std::vector<std::string> arguments{"--link-host", host.empty() ? own_name_ : host, "--link-key",
                                     key_};
  const auto add = [&](const std::string& name, const std::string& address) {
    arguments.insert(arguments.end(), {name == host ? "--link-address" : "--link-peer", address});
  };
  add("", own_address_);
  for (const auto& [name, peer] : hosts_) {
    const HostSpec& spec = peer.remote->spec();
    const auto ends = endsOf(peer.remote->hello().ssh_connection);
    add(name, !spec.address.empty() ? spec.address : ends ? ends->there : "");
  }
  return arguments;
}

RemoteHost::RunSetup RemoteHosts::runSetupFor(const RemoteHost& host) const {
  RemoteHost::RunSetup setup;
  const std::string& name = host.spec().name;
  setup.name = lab_;
  setup.port = gateways_ ? 0 : port_;
  setup.ttl = gateways_ ? 0 : experiment_.network.ttl;
  // After an outage TCP waits up to as long again before it retransmits.
  setup.patience = 2 * experiment_.link.patience + 5;
  setup.logs = logs_ / name;
  setup.files = filesFor(experiment_, directory_);
  setup.files.push_back(
      {files::kExperiment, {}, writeExperiment(experimentElsewhere(experiment_))});
  return setup;
}

void RemoteHosts::begin(const PreparedRun& run, const std::string& lab,
                        const std::filesystem::path& logs, int port) {
  experiment_ = run.experiment;
  directory_ = run.directory;
  lab_ = lab;
  logs_ = logs;
  port_ = port;
  for (auto& [name, host] : hosts_) host.remote->begin(runSetupFor(*host.remote));
  waitFor(RemoteHost::State::kBegun, "did not take the run's files");
  for (auto& [name, host] : hosts_) {
    host.heard = Steady::now();
    const std::string& warning = host.remote->warning();
    if (!warning.empty()) fmt::print(stderr, "warn     host {}: {}\n", name, printable(warning));
  }
}

void RemoteHosts::attend() {
  for (auto& [name, host] : hosts_) host.remote->attend();
}

void RemoteHosts::take(const link_status_t& status) {
  if (status.host == own_name_) {
    last_link_status_ = Steady::now();
  } else if (!hosts_.contains(status.host)) {
    return;  // of another lab on this bus
  }
  auto& peers = peers_[status.host];
  peers.clear();
  for (const link_peer_t& peer : status.peers) peers[peer.host] = peer;
}

std::string RemoteHosts::noDdsTraffic() const {
  return experiment_.link.security.empty()
             ? "nothing is heard over DDS; does a firewall let UDP through (docs/hosts.md)?"
             : "nothing is heard over DDS; does a firewall let UDP through (docs/hosts.md), and "
               "does the gateway there have certificates of the same CA (link.security, "
               "docs/security.md)?";
}

std::string RemoteHosts::notJoined() const {
  if (!gateways_) return {};
  std::vector<std::string> all = names();
  all.push_back(own_name_);
  for (const std::string& one : all) {
    const auto report = peers_.find(one);
    for (const std::string& other : all) {
      if (one == other) continue;
      if (report == peers_.end()) {
        if (one == own_name_) return "dds_gateway sends no LINK_STATUS";
        continue;  // its LINK_STATUS arrives only after the buses are joined
      }
      const auto peer = report->second.find(other);
      const bool known = peer != report->second.end();
      if (known && peer->second.state == link_peer_t::JOINED) continue;
      return fmt::format(
          "the buses of {} and {} are not joined: {}", one, other,
          known && !peer->second.trouble.empty() ? peer->second.trouble : noDdsTraffic());
    }
  }
  for (const std::string& one : names()) {
    if (!peers_.contains(one)) return "host " + one + " has not reported its link yet";
  }
  return {};
}

std::string RemoteHosts::trouble() const {
  for (const auto& [name, host] : hosts_) {
    if (!host.remote->trouble().empty()) return host.remote->trouble();
    if (host.remote->state() != RemoteHost::State::kBegun) return "host " + name + " is gone";
  }
  return {};
}

bool RemoteHosts::isWell(const Host& host) const {
  if (host.remote->state() != RemoteHost::State::kBegun) return false;
  if (!gateways_) return host.remote->silentFor() < inSeconds(kSilent);
  if (Steady::now() - last_link_status_ > kLinkStatusTimeout) return false;
  const auto own = peers_.find(own_name_);
  if (own == peers_.end()) return false;
  const auto peer = own->second.find(host.remote->spec().name);
  return peer != own->second.end() && peer->second.state == link_peer_t::JOINED;
}

/// The text of the fault: what failed, since when, and what the robots do.
std::string RemoteHosts::describeSilence(const Host& host) const {
  const std::string& name = host.remote->spec().name;
  std::string services;
  for (const std::string_view service : kServiceNames) {
    if (hostOf(experiment_, service) == name) {
      services += (services.empty() ? "" : ", ") + std::string(service);
    }
  }
  const bool robots =
      hostOf(experiment_, "sim_svc") == name || hostOf(experiment_, "robot_bridge") == name;
  const std::string since = " since " + utcOf(host.heard);
  const double stop_delay = std::max(experiment_.hardware.lease, experiment_.hardware.free_run);
  const std::string consequence = !robots ? "nothing is heard of " + services
                                  : stop_delay <= inSeconds(kSilent)
                                      ? "its robots stand"
                                      : fmt::format("its robots stand after {:g} s", stop_delay);
  if (host.remote->state() != RemoteHost::State::kBegun) {
    const std::string& why = host.remote->trouble();
    return fmt::format("host {} is gone{}{}: {}", name, since, why.empty() ? "" : " (" + why + ")",
                       consequence);
  }
  if (!gateways_ || host.remote->silentFor() > inSeconds(kSilent) / 2) {
    return fmt::format("host {} is silent{}: {}", name, since, consequence);
  }
  std::string why = "nothing is heard over DDS";
  if (const auto own = peers_.find(own_name_); own != peers_.end()) {
    const auto peer = own->second.find(name);
    if (peer != own->second.end() && !peer->second.trouble.empty()) why = peer->second.trouble;
  }
  return fmt::format("the bus of host {} is cut off{} ({}; ssh still answers): {}", name, since,
                     why, consequence);
}

void RemoteHosts::reconnect(Host& host) {
  RemoteHost& remote = *host.remote;
  const auto now = Steady::now();
  if (remote.state() == RemoteHost::State::kMet) {
    remote.begin(runSetupFor(remote));
    host.called = now;
  } else if (remote.state() == RemoteHost::State::kGone &&
             (!host.called || now - *host.called > kReconnectPeriod)) {
    host.called = now;
    remote.connect();
  }
}

std::string RemoteHosts::watch(const Watcher& watcher) {
  attend();
  const auto now = Steady::now();
  for (auto& [name, host] : hosts_) {
    RemoteHost& remote = *host.remote;
    const bool well = isWell(host);
    if (well && !host.silent) host.heard = now;
    if (!well) host.back.reset();
    if (!well && !host.silent && now - host.heard > kSilent) {
      host.silent = true;
      watcher.fault(describeSilence(host));
    }
    if (well && host.silent) {
      if (!host.back) host.back = now;
      if (now - *host.back >= kSure) {
        watcher.mark(fmt::format("host {} is back after {:.0f} s: the run goes on", name,
                                 inSeconds(*host.back - host.heard)));
        host.silent = false;
        host.heard = now;
      }
    }
    // A host that lost its power does not close its TCP connection.
    if (!well && remote.state() == RemoteHost::State::kBegun &&
        remote.silentFor() > inSeconds(kGiveUp)) {
      remote.drop(fmt::format("nothing heard over ssh for {:.0f} s", remote.silentFor()));
    }
    if (remote.state() == RemoteHost::State::kRefused) return remote.trouble();
    if (host.silent && !well && inSeconds(now - host.heard) > experiment_.link.patience) {
      return fmt::format("host {} did not come back within {:g} s (link.patience_s)", name,
                         experiment_.link.patience);
    }
    if (remote.state() != RemoteHost::State::kBegun) reconnect(host);
  }
  return {};
}

std::string RemoteHosts::describe() const {
  std::string text;
  for (const auto& [name, host] : hosts_) {
    const ClockOffset clock = host.remote->clock();
    text += fmt::format("host     {}: {} ({}), clock {:+.2f} ms, known to {:.2f} ms\n", name,
                        host.remote->spec().ssh, host.remote->hello().host, clock.offset * 1e3,
                        clock.error * 1e3);
  }
  return text;
}

void RemoteHosts::leave() {
  for (auto& [name, host] : hosts_) host.remote->disconnect();
}

}  // namespace lab::runner
