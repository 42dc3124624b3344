#include "dds_gateway/foreign_endpoints.hpp"

#include <algorithm>
#include <array>

#include "dds/error.hpp"

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

}  // namespace

ForeignEndpoints::ForeignEndpoints(const dds::Domain& domain)
    : publications_(watched(domain, DDS_BUILTIN_TOPIC_DCPSPUBLICATION)),
      subscriptions_(watched(domain, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION)) {}

void ForeignEndpoints::look(const std::multimap<std::string, std::string>& types) {
  look(publications_, types);
  look(subscriptions_, types);
}

void ForeignEndpoints::look(const dds::Entity& reader,
                            const std::multimap<std::string, std::string>& types) {
  constexpr int kAtOnce = 64;
  for (;;) {
    std::array<void*, kAtOnce> samples{};
    std::array<dds_sample_info_t, kAtOnce> infos{};
    const dds_return_t count =
        dds_take(reader.get(), samples.data(), infos.data(), kAtOnce, kAtOnce);
    if (count <= 0) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      if (!infos[i].valid_data) continue;
      const auto* endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      const auto [first, last] = types.equal_range(endpoint->topic_name);
      const bool fits = first == last || std::any_of(first, last, [endpoint](const auto& ours) {
                          return ours.second == endpoint->type_name;
                        });
      if (fits) continue;
      ++count_;
      last_ = std::string(endpoint->topic_name) + " has " + endpoint->type_name;
    }
    dds_return_loan(reader.get(), samples.data(), count);
  }
}

}  // namespace lab::gateway
