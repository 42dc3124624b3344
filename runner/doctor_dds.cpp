#include "runner/doctor_dds.hpp"

#include <dds/dds.h>

#include <array>
#include <chrono>
#include <cstring>
#include <set>
#include <thread>

#include "dds/configuration.hpp"
#include "dds/domain.hpp"
#include "dds/error.hpp"

namespace lab::runner {
namespace {

using Level = Finding::Level;

constexpr std::size_t kAtOnce = 64;

/// Everything that the reader of a built-in topic holds now.
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

DdsEndpoint endpointOf(const dds_builtintopic_endpoint_t& found, bool writer) {
  DdsEndpoint endpoint{writer, found.topic_name, found.type_name};
  dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
  dds_duration_t blocking = 0;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  dds_qget_reliability(found.qos, &reliability, &blocking);
  dds_qget_durability(found.qos, &durability);
  endpoint.reliable = reliability == DDS_RELIABILITY_RELIABLE;
  endpoint.latched = durability != DDS_DURABILITY_VOLATILE;
  return endpoint;
}

/// Why the reader hears nothing of the writer; empty: it does.
std::string mismatch(const DdsEndpoint& writer, const DdsEndpoint& reader) {
  if (writer.type != reader.type) return "its type is " + writer.type + ", wanted " + reader.type;
  if (reader.reliable && !writer.reliable) return "it is best effort, wanted reliable";
  if (reader.latched && !writer.latched) return "it is volatile, wanted transient local";
  return {};
}

std::string remedy(const DdsEndpoint& writer, const DdsEndpoint& reader) {
  std::string topic = reader.topic.starts_with("rt/") ? reader.topic.substr(2) : reader.topic;
  if (writer.type != reader.type) return "ros2 topic info -v " + topic + "  # who wants which type";
  return "ros2 topic echo " + topic +
         " --qos-reliability best_effort --qos-durability volatile  # what the reader must ask for";
}

}  // namespace

DdsFacts surveyDds(int domain, const std::string& address, int listen_ms) {
  DdsFacts facts;
  facts.domain = domain;
  try {
    dds::NetworkOptions options;
    options.address = address;
    const dds::Domain own(
        domain, address.empty() ? dds::localConfiguration() : dds::networkConfiguration(options),
        "lab doctor");
    std::this_thread::sleep_for(std::chrono::milliseconds(listen_ms));
    dds_guid_t self{};
    dds_get_guid(own.participant(), &self);
    takeAll<dds_builtintopic_participant_t>(
        own, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, [&](const auto& participant) {
          facts.participants += std::memcmp(&participant.key, &self, sizeof self) == 0 ? 0 : 1;
        });
    takeAll<dds_builtintopic_endpoint_t>(
        own, DDS_BUILTIN_TOPIC_DCPSPUBLICATION,
        [&](const auto& found) { facts.endpoints.push_back(endpointOf(found, true)); });
    takeAll<dds_builtintopic_endpoint_t>(
        own, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION,
        [&](const auto& found) { facts.endpoints.push_back(endpointOf(found, false)); });
  } catch (const dds::DdsError& error) {
    facts.problem = error.what();
  }
  return facts;
}

std::vector<Finding> judgeDds(const DdsFacts& facts) {
  const std::string name = "DDS domain " + std::to_string(facts.domain);
  if (!facts.problem.empty()) {
    return {{Level::kWarning, name + " cannot be entered: " + facts.problem,
             "ss -ulnp | grep ':7[4-9]'  # who holds its ports; or choose another domain"}};
  }
  std::size_t writers = 0;
  std::vector<Finding> findings;
  std::set<std::string> told;
  for (const DdsEndpoint& writer : facts.endpoints) {
    if (!writer.writer) continue;
    ++writers;
    for (const DdsEndpoint& reader : facts.endpoints) {
      if (reader.writer || reader.topic != writer.topic) continue;
      const std::string why = mismatch(writer, reader);
      const std::string what = name + ": a reader of " + reader.topic + " hears nothing of a writer: ";
      if (why.empty() || !told.insert(what + why).second) continue;
      findings.push_back({Level::kWarning, what + why, remedy(writer, reader)});
    }
  }
  findings.insert(findings.begin(),
                  {Level::kOk,
                   name + ": " + std::to_string(facts.participants) + " participants, " +
                       std::to_string(writers) + " writers, " +
                       std::to_string(facts.endpoints.size() - writers) + " readers",
                   ""});
  return findings;
}

}  // namespace lab::runner
