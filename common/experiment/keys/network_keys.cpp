#include "common/experiment/keys/network_keys.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/experiment/keys/key_helpers.hpp"

namespace lab::keys {
namespace {

const std::array<Choice, 2> kJoins = {
    {choiceOf("dds", JoinBy::kDds), choiceOf("multicast", JoinBy::kMulticast)}};
inline constexpr std::int64_t kHighestDomain =
    230;  // the highest that Cyclone DDS 0.10 accepts with DDS Security
inline constexpr std::size_t kLongestAddress = 64;
inline constexpr std::size_t kLongestPath = 1000;

void visitBus(KeyVisitor& v, Network& network) {
  std::int64_t port = network.port;
  std::int64_t ttl = network.ttl;
  v.integer({"port", "UDP port of the LCM bus, 0: a free one"}, 0, 65535, port);
  v.integer({"ttl", "IP multicast TTL; 0: this machine only; 1: this network segment"}, 0, 255,
            ttl);
  network.port = static_cast<int>(port);
  network.ttl = static_cast<int>(ttl);
}

void visitDomain(KeyVisitor& v, const char* meaning, int& domain) {
  std::int64_t number = domain;
  v.integer({"domain", meaning}, 0, kHighestDomain, number);
  domain = static_cast<int>(number);
}

void visitGateway(KeyVisitor& v, Gateway& gateway) {
  v.flag({"ros", "whether ROS 2 tools can observe the lab (docs/ros2.md)"}, gateway.ros);
  visitDomain(v, "ROS_DOMAIN_ID", gateway.domain);
  v.text({"name", "first part of every topic: /lab/robot1/pose"}, {.most = 32, .bare = true},
         gateway.name);
  v.text({"mapping",
          "file that says which topics go out, how often and under which name; \"\": all topics"},
         {.most = kLongestPath}, gateway.mapping);
  v.text({"address", "address of the network interface to use; \"\": nothing leaves this machine"},
         {.most = kLongestAddress}, gateway.address);
  v.texts({"peers", "addresses of hosts that multicast does not reach"}, {.most = kLongestAddress},
          {.fewest = 0, .most = 32, .in_line = true}, gateway.peers);
  v.text({"configuration",
          "refused in a file, because it can run code: give it on the command line, "
          "--dds-configuration FILE (docs/security.md)"},
         {.most = kLongestPath}, gateway.configuration);
  v.text({"security", "folder of DDS Security certificates (docs/security.md); \"\": none"},
         {.most = kLongestPath}, gateway.security);
  v.flag({"commands", "whether ROS 2 may drive robots and light"}, gateway.commands);
  v.flag({"load_programs", "with commands: whether ROS 2 may send texts of programs of motion"},
         gateway.load_programs);
  v.flag({"unsecured_commands",
          "take commands also from other hosts without DDS Security: anybody on that network can "
          "then drive the robots"},
         gateway.unsecured_commands);
  v.integers({"command_robots", "ids of the robots that ROS 2 may drive, []: all"}, 0, kLargestId,
             {.fewest = 0, .most = kMostLiveRobots, .in_line = true}, gateway.command_robots);
  v.number(
      {"command_timeout_s", "a robot driven from ROS 2 stands after this time without a command"},
      {0.1, 5}, gateway.command_timeout);
}

void visitLink(KeyVisitor& v, Link& link) {
  enumerate(v,
            {"join",
             "how the buses of several hosts are joined: by a gateway on each, or by LCM's "
             "own multicast (network.ttl)"},
            kJoins, link.join);
  visitDomain(
      v, "DDS domain of the gateways; if gateway.ros is true it must differ from gateway.domain",
      link.domain);
  v.text({"address", "address of this host as seen from the others; \"\": the one that ssh uses"},
         {.most = kLongestAddress}, link.address);
  v.text({"security", "folder of DDS Security certificates (docs/security.md); \"\": none"},
         {.most = kLongestPath}, link.security);
  v.flag({"unsecured",
          "join hosts without DDS Security: anybody on that network can then drive the robots"},
         link.unsecured);
  v.number(
      {"max_clock_offset_ms",
       "largest offset between the clocks of two hosts; with a larger one no message is forwarded"},
      {0.1, 10000}, link.max_clock_offset);
  v.number({"patience_s", "time for which a run waits for a host that has stopped responding"},
           {1, 3600}, link.patience);
}

void visitDashboard(KeyVisitor& v, Dashboard& dashboard) {
  v.text({"address",
          "address on which the dashboard listens; \"0.0.0.0\": all addresses of this machine; "
          "\"\": the page can be opened on this machine only"},
         {.most = kLongestAddress}, dashboard.address);
  std::int64_t port = dashboard.port;
  v.integer({"port", "port of the page; if it is in use, the next free one"}, 1024, 65535, port);
  dashboard.port = static_cast<int>(port);
  v.flag(
      {"control_from_elsewhere",
       "whether a user who has the printed address may control the lab from other machines, too"},
      dashboard.control_from_elsewhere);
}

void visitHost(KeyVisitor& v, HostSpec& host) {
  v.text({"ssh", "argument of ssh, \"pi@robot-bench\"; \"\": NAME"}, {.most = 200}, host.ssh);
  v.text({"address", "address of that host as seen from this one; \"\": the one that ssh uses"},
         {.most = kLongestAddress}, host.address);
  v.text({"programs", "folder of the lab's programs there; \"\": searched in its PATH"},
         {.most = kLongestPath}, host.programs);
}

template <typename Entry, typename Keys>
void visitNamed(KeyVisitor& v, const Key& key, const TextRule& name_rule,
                std::map<std::string, Entry>& entries, const Keys& keys) {
  std::vector<std::string> names;
  for (const auto& [name, entry] : entries) names.push_back(name);
  v.namedTables(key, name_rule, {.fewest = 0, .most = 32}, names,
                [&](const std::string& name) { keys(name, entries[name]); });
}

}  // namespace

void visitNetworks(KeyVisitor& v, Experiment& e) {
  v.table({"network", "The message bus"}, [&] { visitBus(v, e.network); });
  v.table({"gateway", "ROS 2"}, [&] { visitGateway(v, e.gateway); });
  v.table({"link", "How hosts are joined"}, [&] { visitLink(v, e.link); });
  v.table({"dashboard", "The page in a browser (docs/dashboard.md)"},
          [&] { visitDashboard(v, e.dashboard); });
  visitNamed(v, {"hosts", "Other computers that services run on; choose NAME freely"},
             {.most = 32, .bare = true}, e.hosts, [&](const std::string& name, HostSpec& host) {
               host.name = name;
               visitHost(v, host);
             });
  visitNamed(v, {"services", "The hosts of services; NAME is a service, such as sim_svc"},
             {.most = 32, .bare = true}, e.services,
             [&](const std::string& name, ServicePlacement& place) {
               place.service = name;
               v.text({"host",
                       "NAME of [hosts.NAME], or an argument of ssh such as \"pi@robot-bench\"; "
                       "\"\": this machine"},
                      {.most = 200}, place.host);
             });
}

}  // namespace lab::keys
