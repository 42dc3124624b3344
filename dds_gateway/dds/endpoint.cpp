#include "dds_gateway/dds/endpoint.hpp"

#include <algorithm>
#include <array>
#include <memory>

#include "dds_gateway/dds/error.hpp"

namespace lab::dds {
namespace {

constexpr int kAtOnce = 64;  // samples taken together

using QosHandle = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;
using ListenerHandle = std::unique_ptr<dds_listener_t, decltype(&dds_delete_listener)>;

dds_duration_t nanoseconds(double seconds) { return static_cast<dds_duration_t>(seconds * 1e9); }

QosHandle made(const Qos& qos) {
  QosHandle handle(dds_create_qos(), dds_delete_qos);
  dds_qos_t* q = handle.get();
  dds_qset_reliability(q, qos.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       nanoseconds(qos.max_blocking_time));
  dds_qset_history(q, DDS_HISTORY_KEEP_LAST, qos.depth);
  if (qos.latched) {
    dds_qset_durability(q, DDS_DURABILITY_TRANSIENT_LOCAL);
    // As rmw does: late joiners receive this history, not the writer's own.
    dds_qset_durability_service(q, 0, DDS_HISTORY_KEEP_LAST,
                                qos.latched_depth > 0 ? qos.latched_depth : qos.depth,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  } else {
    dds_qset_durability(q, DDS_DURABILITY_VOLATILE);
  }
  dds_qset_writer_data_lifecycle(q, false);
  const dds_data_representation_id_t representation = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(q, 1, &representation);
  dds_qset_ignorelocal(q, DDS_IGNORELOCAL_PARTICIPANT);
  if (!qos.user_data.empty()) dds_qset_userdata(q, qos.user_data.data(), qos.user_data.size());
  return handle;
}

Entity checked(dds_entity_t handle, const std::string& topic, const char* what) {
  if (handle >= 0) return Entity(handle);
  const std::string warnings = takeWarnings();
  throw DdsError(topic + ": " + what + ": " +
                 (warnings.empty() ? dds_strretcode(-handle) : warnings));
}

Entity topicOf(const Domain& domain, const dds_topic_descriptor_t& type, const std::string& name) {
  return checked(dds_create_topic(domain.participant(), &type, name.c_str(), nullptr, nullptr),
                 name, "no topic could be made");
}

/// Samples in Cyclone's memory; returns them even if a handler throws.
class Loan {
 public:
  Loan(dds_entity_t reader, void** samples, int count)
      : reader_(reader), samples_(samples), count_(count) {}
  ~Loan() {
    if (count_ > 0) dds_return_loan(reader_, samples_, count_);
  }
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;

 private:
  dds_entity_t reader_;
  void** samples_;
  int count_;
};

/// DDSI-RTPS names of the policies that can prevent a match of two endpoints.
std::string policyName(std::uint32_t id) {
  switch (id) {
    case DDS_DURABILITY_QOS_POLICY_ID:
      return "durability";
    case DDS_DEADLINE_QOS_POLICY_ID:
      return "deadline";
    case DDS_LATENCYBUDGET_QOS_POLICY_ID:
      return "latency budget";
    case DDS_OWNERSHIP_QOS_POLICY_ID:
      return "ownership";
    case DDS_LIVELINESS_QOS_POLICY_ID:
      return "liveliness";
    case DDS_RELIABILITY_QOS_POLICY_ID:
      return "reliability";
    case DDS_PARTITION_QOS_POLICY_ID:
      return "partition";
    case DDS_DATA_REPRESENTATION_QOS_POLICY_ID:
      return "data representation";
    default:
      return "policy " + std::to_string(id);
  }
}

}  // namespace

Writer::Writer(const Domain& domain, const dds_topic_descriptor_t& type, const std::string& topic,
               const Qos& qos)
    : name_(topic), topic_(topicOf(domain, type, topic)) {
  const QosHandle handle = made(qos);
  writer_ = checked(dds_create_writer(domain.participant(), topic_.get(), handle.get(), nullptr),
                    topic, "no writer could be made");
}

bool Writer::write(const void* sample) {
  const dds_return_t code = dds_write(writer_.get(), sample);
  if (code == DDS_RETCODE_OK) {
    ++written_;
    return true;
  }
  if (code == DDS_RETCODE_TIMEOUT) {
    ++timeouts_;
    return false;
  }
  throw DdsError(name_ + ": could not be written: " + dds_strretcode(-code));
}

bool Writer::acknowledged() const { return dds_wait_for_acks(writer_.get(), 0) == DDS_RETCODE_OK; }

Matching Writer::matching() const {
  dds_publication_matched_status_t matched{};
  dds_get_publication_matched_status(writer_.get(), &matched);
  dds_offered_incompatible_qos_status_t refused{};
  dds_get_offered_incompatible_qos_status(writer_.get(), &refused);
  return {static_cast<int>(matched.current_count), matched.total_count, refused.total_count,
          refused.total_count > 0 ? policyName(refused.last_policy_id) : ""};
}

Reader::Reader(const Domain& domain, const dds_topic_descriptor_t& type, const std::string& topic,
               const Qos& qos, const EventDescriptor& waker)
    : name_(topic), topic_(topicOf(domain, type, topic)) {
  const QosHandle handle = made(qos);
  // Cyclone takes void* and passes it back unchanged.
  const ListenerHandle listener(dds_create_listener(const_cast<EventDescriptor*>(&waker)),
                                dds_delete_listener);
  dds_lset_data_available(listener.get(), [](dds_entity_t /*reader*/, void* argument) {
    static_cast<const EventDescriptor*>(argument)->signal();
  });
  reader_ =
      checked(dds_create_reader(domain.participant(), topic_.get(), handle.get(), listener.get()),
              topic, "no reader could be made");
}

int Reader::take(int most,
                 const std::function<void(const void* sample, WriterId writer)>& handler) {
  int taken = 0;
  while (taken < most) {
    std::array<void*, kAtOnce> samples{};
    std::array<dds_sample_info_t, kAtOnce> infos{};
    const int room = std::min(kAtOnce, most - taken);
    const dds_return_t count =
        dds_take(reader_.get(), samples.data(), infos.data(), static_cast<std::size_t>(room),
                 static_cast<std::uint32_t>(room));
    if (count < 0) throw DdsError(name_ + ": could not be read: " + dds_strretcode(-count));
    const Loan loan(reader_.get(), samples.data(), count);
    for (int i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (!infos[at].valid_data) continue;
      ++received_;
      handler(samples[at], infos[at].publication_handle);
    }
    taken += count;
    if (count < room) break;
  }
  return taken;
}

std::int64_t Reader::overrun() const {
  dds_sample_lost_status_t lost{};
  dds_get_sample_lost_status(reader_.get(), &lost);
  return lost.total_count;
}

Matching Reader::matching() const {
  dds_subscription_matched_status_t matched{};
  dds_get_subscription_matched_status(reader_.get(), &matched);
  dds_requested_incompatible_qos_status_t refused{};
  dds_get_requested_incompatible_qos_status(reader_.get(), &refused);
  return {static_cast<int>(matched.current_count), matched.total_count, refused.total_count,
          refused.total_count > 0 ? policyName(refused.last_policy_id) : ""};
}

}  // namespace lab::dds
