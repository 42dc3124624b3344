#include "dds_gateway/ros/foreign_endpoints.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "dds_gateway/dds/error.hpp"

namespace lab::gateway {
namespace {

dds::Entity watched(const dds::Domain& domain, dds_entity_t topic) {
  const dds_entity_t reader = dds_create_reader(domain.participant(), topic, nullptr, nullptr);
  if (reader < 0) {
    throw dds::DdsError(std::string("the domain's endpoints cannot be read: ") +
                        dds_strretcode(-reader));
  }
  return dds::Entity(reader);
}

// Endpoints per read, which bounds its memory. More are not looked at: this is a hint for users who
// chose the wrong type, and a ROS 2 domain with that many endpoints of one kind is far beyond a
// lab.
constexpr std::size_t kMost = 4096;

/// Calls `handler` with each endpoint that `get` (dds_read_mask, dds_take_mask) returns.
template <class Get, class Handler>
void forEach(Get get, const dds::Entity& reader, std::uint32_t mask, const Handler& handler) {
  std::vector<void*> samples(kMost);
  std::vector<dds_sample_info_t> infos(kMost);
  const dds_return_t count = get(reader.get(), samples.data(), infos.data(), kMost,
                                 static_cast<std::uint32_t>(kMost), mask);
  if (count <= 0) return;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    if (infos[i].valid_data) handler(*static_cast<const dds_builtintopic_endpoint_t*>(samples[i]));
  }
  dds_return_loan(reader.get(), samples.data(), count);
}

}  // namespace

ForeignEndpoints::ForeignEndpoints(const dds::Domain& domain)
    : publications_(watched(domain, DDS_BUILTIN_TOPIC_DCPSPUBLICATION)),
      subscriptions_(watched(domain, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION)) {}

void ForeignEndpoints::update(const std::multimap<std::string, std::string>& types) {
  count_ = 0;
  update(publications_, types);
  update(subscriptions_, types);
}

void ForeignEndpoints::update(const dds::Entity& reader,
                              const std::multimap<std::string, std::string>& types) {
  // Endpoints that have ended are taken out. The others are only read, because a topic of ours may
  // be opened after them.
  forEach(dds_take_mask, reader,
          DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE |
              DDS_NOT_ALIVE_NO_WRITERS_INSTANCE_STATE,
          [](const dds_builtintopic_endpoint_t&) {});
  forEach(dds_read_mask, reader,
          DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE,
          [&](const dds_builtintopic_endpoint_t& endpoint) {
            const auto [first, last] = types.equal_range(endpoint.topic_name);
            const bool fits = first == last || std::any_of(first, last, [&](const auto& ours) {
                                return ours.second == endpoint.type_name;
                              });
            if (fits) return;
            ++count_;
            last_ = std::string(endpoint.topic_name) + " has " + endpoint.type_name;
          });
}

}  // namespace lab::gateway
