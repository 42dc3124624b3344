/// cyclone_peer DOMAIN CONFIGURATION: endpoints like those of rmw_cyclonedds (peer_loop.hpp).
#include <cstdint>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/dds_gateway/peers/peer_loop.hpp"
#include "tests/dds_gateway/peers/raw_type.hpp"

namespace lab::dds {
namespace {

dds_entity_t checked(dds_entity_t handle) {
  if (handle < 0) throw std::runtime_error(dds_strretcode(-handle));
  return handle;
}

using QosHandle = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

QosHandle made(const PeerQos& wanted) {
  QosHandle handle(dds_create_qos(), dds_delete_qos);
  dds_qos_t* qos = handle.get();
  dds_qset_reliability(
      qos, wanted.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_INFINITY);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, wanted.depth);
  dds_qset_durability(qos,
                      wanted.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (wanted.latched) {
    dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_LAST, wanted.depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  std::vector<dds_data_representation_id_t> representations;
  if (wanted.xcdr1) representations.push_back(DDS_DATA_REPRESENTATION_XCDR1);
  if (wanted.xcdr2) representations.push_back(DDS_DATA_REPRESENTATION_XCDR2);
  dds_qset_data_representation(qos, static_cast<std::uint32_t>(representations.size()),
                               representations.data());
  dds_qset_writer_data_lifecycle(qos, false);
  if (!wanted.user_data.empty()) {
    dds_qset_userdata(qos, wanted.user_data.data(), wanted.user_data.size());
  }
  return handle;
}

class CycloneEndpoint : public PeerEndpoint {
 public:
  CycloneEndpoint(dds_entity_t participant, bool writer, const std::string& topic,
                  const std::string& type, const PeerQos& wanted)
      : writer_(writer) {
    const dds_entity_t named = checked(rawTopic(participant, topic, type));
    const QosHandle qos = made(wanted);
    endpoint_ = checked(writer ? dds_create_writer(participant, named, qos.get(), nullptr)
                               : dds_create_reader(participant, named, qos.get(), nullptr));
  }

  PeerMatch match() override {
    PeerMatch now;
    if (writer_) {
      dds_publication_matched_status_t matched{};
      dds_get_publication_matched_status(endpoint_, &matched);
      dds_offered_incompatible_qos_status_t refused{};
      dds_get_offered_incompatible_qos_status(endpoint_, &refused);
      if (refused.total_count > 0) refused_by_ = static_cast<int>(refused.last_policy_id);
      now.matched = static_cast<int>(matched.current_count);
    } else {
      dds_subscription_matched_status_t matched{};
      dds_get_subscription_matched_status(endpoint_, &matched);
      dds_requested_incompatible_qos_status_t refused{};
      dds_get_requested_incompatible_qos_status(endpoint_, &refused);
      if (refused.total_count > 0) refused_by_ = static_cast<int>(refused.last_policy_id);
      now.matched = static_cast<int>(matched.current_count);
    }
    now.refused_by = refused_by_;
    return now;
  }

  void write(const Payload& payload) override {
    const dds_return_t code = writeRaw(endpoint_, payload);
    if (code != DDS_RETCODE_OK) throw std::runtime_error(dds_strretcode(-code));
  }

  std::vector<Payload> take() override {
    return writer_ ? std::vector<Payload>{} : takeRaw(endpoint_);
  }

 private:
  bool writer_;
  dds_entity_t endpoint_ = 0;
  int refused_by_ = 0;
};

int run(int domain, const char* configuration) {
  const auto id = static_cast<dds_domainid_t>(domain);
  checked(dds_create_domain(id, configuration));
  const dds_entity_t participant = checked(dds_create_participant(id, nullptr, nullptr));
  const int status = peerLoop([participant](bool writer, const std::string& topic,
                                            const std::string& type, const PeerQos& qos) {
    return std::make_unique<CycloneEndpoint>(participant, writer, topic, type, qos);
  });
  dds_delete(DDS_CYCLONEDDS_HANDLE);
  return status;
}

}  // namespace
}  // namespace lab::dds

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: cyclone_peer DOMAIN CONFIGURATION\n";
    return 2;
  }
  try {
    return lab::dds::run(std::stoi(argv[1]), argv[2]);
  } catch (const std::exception& error) {
    std::cout << "error " << error.what() << std::endl;
    return 1;
  }
}
