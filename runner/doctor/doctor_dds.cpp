#include "runner/doctor/doctor_dds.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <set>
#include <stdexcept>
#include <thread>

#include "common/experiment/service_placement.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/dds/error.hpp"
#include "dds_gateway/gateway_domain.hpp"

namespace lab::runner {
namespace {

using Level = Finding::Level;

constexpr std::size_t kAtOnce = 64;

/// Calls `take` with all samples of a built-in topic.
template <typename Sample, typename Take>
void takeAll(const dds::Domain& domain, dds_entity_t topic, const Take& take) {
  const dds::Entity reader(dds_create_reader(domain.participant(), topic, nullptr, nullptr));
  for (;;) {
    std::array<void*, kAtOnce> samples{};
    std::array<dds_sample_info_t, kAtOnce> infos{};
    const dds_return_t count =
        dds_take(reader.get(), samples.data(), infos.data(), kAtOnce, kAtOnce);
    if (count <= 0) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      if (infos[i].valid_data && infos[i].instance_state == DDS_IST_ALIVE) {
        take(*static_cast<const Sample*>(samples[i]));
      }
    }
    dds_return_loan(reader.get(), samples.data(), count);
  }
}

/// Multicast discovery port of a domain (DDSI-RTPS 2.2, section 9.6.1.1).
int discoveryPort(int domain) { return 7400 + 250 * domain; }

std::string keyOf(const dds_guid_t& guid) {
  return {reinterpret_cast<const char*>(guid.v), sizeof guid.v};
}

DdsEndpoint endpointOf(const dds_builtintopic_endpoint_t& found, bool writer) {
  DdsEndpoint endpoint{writer, found.topic_name, found.type_name};
  dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
  dds_duration_t blocking = 0;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  dds_qget_reliability(found.qos, &reliability, &blocking);
  dds_qget_durability(found.qos, &durability);
  endpoint.reliable = reliability == DDS_RELIABILITY_RELIABLE;
  endpoint.latched = durability != DDS_DURABILITY_VOLATILE;
  endpoint.owner = keyOf(found.participant_key);
  return endpoint;
}

/// @return why DDS does not match writer and reader; empty if it does
std::string mismatch(const DdsEndpoint& writer, const DdsEndpoint& reader) {
  if (writer.type != reader.type)
    return "the writer's type is " + writer.type + ", the reader's " + reader.type;
  if (reader.reliable && !writer.reliable)
    return "the writer is best effort, the reader wants reliable";
  if (reader.latched && !writer.latched)
    return "the writer is volatile, the reader wants transient local";
  return {};
}

/// Whether the participant of the reader also reads this type on the topic. The lab itself reads
/// commands in two types.
bool readsToo(const DdsFacts& facts, const DdsEndpoint& reader, const std::string& type) {
  return std::ranges::any_of(facts.endpoints, [&](const DdsEndpoint& other) {
    return !other.writer && other.topic == reader.topic && other.owner == reader.owner &&
           other.type == type;
  });
}

std::string remedy(const DdsEndpoint& writer, const DdsEndpoint& reader) {
  std::string topic = reader.topic.starts_with("rt/") ? reader.topic.substr(2) : reader.topic;
  if (writer.type != reader.type) return "ros2 topic info -v " + topic + "  # lists the types";
  return "ros2 topic echo " + topic +
         " --qos-reliability best_effort --qos-durability volatile  # the QoS that the reader must "
         "request";
}

}  // namespace

DdsFacts surveyDds(const Gateway& gateway, const std::filesystem::path& directory, int listen_ms) {
  DdsFacts facts;
  facts.domain = gateway.domain;
  facts.secured = !gateway.security.empty();
  try {
    const dds::Domain domain = gateway::joinDomain(gateway, directory);
    std::this_thread::sleep_for(std::chrono::milliseconds(listen_ms));
    dds_guid_t guid{};
    dds_get_guid(domain.participant(), &guid);
    const std::string own_key = keyOf(guid);
    takeAll<dds_builtintopic_participant_t>(
        domain, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, [&](const auto& participant) {
          facts.participants += keyOf(participant.key) == own_key ? 0 : 1;
        });
    const auto add = [&](const dds_builtintopic_endpoint_t& found, bool writer) {
      const DdsEndpoint endpoint = endpointOf(found, writer);
      if (endpoint.owner != own_key) facts.endpoints.push_back(endpoint);
    };
    takeAll<dds_builtintopic_endpoint_t>(domain, DDS_BUILTIN_TOPIC_DCPSPUBLICATION,
                                         [&](const auto& found) { add(found, true); });
    takeAll<dds_builtintopic_endpoint_t>(domain, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION,
                                         [&](const auto& found) { add(found, false); });
  } catch (const std::runtime_error& error) {
    facts.problem = error.what();
  }
  return facts;
}

std::vector<Finding> judgePorts(const Experiment& experiment,
                                const std::function<bool(int port)>& lcm_free,
                                const std::function<bool(int port)>& dds_free) {
  std::vector<Finding> findings;
  const auto taken = [&](int port, const std::string& use, const std::string& way_out) {
    const std::string number = std::to_string(port);
    findings.push_back({Level::kWarning, "UDP port " + number + " (" + use + ") is in use",
                        "ss -ulnp | grep ':" + number + " '  # which program; or " + way_out});
  };
  const int lcm = experiment.network.port;
  if (lcm != 0 && !lcm_free(lcm)) {
    taken(lcm, "network.port",
          "lab stop, if it is a lab; or another network.port, 0 for any free one");
  }
  const auto domain = [&](const std::string& key, int number) {
    const int port = discoveryPort(number);
    if (!dds_free(port)) {
      taken(port, key + " = " + std::to_string(number), "another " + key);
    }
  };
  if (experiment.gateway.ros) domain("gateway.domain", experiment.gateway.domain);
  if (experiment.link.join == JoinBy::kDds && !hostsInUse(experiment).empty()) {
    domain("link.domain", experiment.link.domain);
  }
  return findings;
}

std::vector<Finding> judgeDds(const DdsFacts& facts) {
  const std::string name = "DDS domain " + std::to_string(facts.domain);
  if (!facts.problem.empty()) {
    return {{Level::kWarning, name + " cannot be joined: " + facts.problem,
             "ss -ulnp | grep ':" + std::to_string(discoveryPort(facts.domain) / 100) +
                 "'  # which program uses its ports; or choose another gateway.domain"}};
  }
  std::size_t writers = 0;
  std::vector<Finding> findings;
  std::set<std::string> reported;
  for (const DdsEndpoint& writer : facts.endpoints) {
    if (!writer.writer) continue;
    ++writers;
    for (const DdsEndpoint& reader : facts.endpoints) {
      if (reader.writer || reader.topic != writer.topic) continue;
      if (writer.type != reader.type && readsToo(facts, reader, writer.type)) continue;
      const std::string why = mismatch(writer, reader);
      const std::string what =
          name + ": a reader of " + reader.topic + " does not match a writer: ";
      if (why.empty() || !reported.insert(what + why).second) continue;
      findings.push_back({Level::kWarning, what + why, remedy(writer, reader)});
    }
  }
  findings.insert(findings.begin(),
                  {Level::kOk,
                   name + ": " + std::to_string(facts.participants) + " participants, " +
                       std::to_string(writers) + " writers, " +
                       std::to_string(facts.endpoints.size() - writers) + " readers" +
                       (facts.secured ? " (secured: participants without a certificate of "
                                        "gateway.security are not visible)"
                                      : ""),
                   ""});
  return findings;
}

}  // namespace lab::runner
