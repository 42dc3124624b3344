/// fastdds_peer DOMAIN [PROFILES]: an endpoint of another vendor, over UDP (peer_loop.hpp).
/// Payloads are passed unchanged; the tests make the bytes. PROFILES goes into
/// $FASTRTPS_DEFAULT_PROFILES_FILE; without it every interface is used.
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/dds_gateway/peers/peer_loop.hpp"

namespace lab::dds {
namespace {

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

constexpr std::uint32_t kMostBytes = 65536;

class RawType : public fast::TopicDataType {
 public:
  explicit RawType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = kMostBytes;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  bool serialize(void* data, rtps::SerializedPayload_t* to) override {
    const Payload& payload = *static_cast<Payload*>(data);
    to->encapsulation = CDR_LE;
    to->length = static_cast<std::uint32_t>(payload.size());
    std::memcpy(to->data, payload.data(), payload.size());
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* from, void* data) override {
    static_cast<Payload*>(data)->assign(from->data, from->data + from->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Payload*>(data)->size()); };
  }
  void* createData() override { return new Payload; }
  void deleteData(void* data) override { delete static_cast<Payload*>(data); }
  bool getKey(void* /*data*/, rtps::InstanceHandle_t* /*key*/, bool /*md5*/) override {
    return false;
  }
};

/// Common settings of writers and readers.
template <class Qos>
void set(Qos& qos, const PeerQos& wanted) {
  qos.reliability().kind =
      wanted.reliable ? fast::RELIABLE_RELIABILITY_QOS : fast::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      wanted.latched ? fast::TRANSIENT_LOCAL_DURABILITY_QOS : fast::VOLATILE_DURABILITY_QOS;
  qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = wanted.depth;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.user_data().setValue({wanted.user_data.begin(), wanted.user_data.end()});
}

struct Made {
  fast::DomainParticipant* participant;
  fast::Publisher* publisher;
  fast::Subscriber* subscriber;
};

class FastEndpoint : public PeerEndpoint {
 public:
  FastEndpoint(const Made& made, bool writer, const std::string& topic, const std::string& type,
               const PeerQos& wanted) {
    const fast::TypeSupport support(new RawType(type));
    support.register_type(made.participant);
    fast::Topic* named = made.participant->create_topic(topic, type, fast::TOPIC_QOS_DEFAULT);
    if (named == nullptr) throw std::runtime_error("no topic");
    if (writer) {
      fast::DataWriterQos qos = fast::DATAWRITER_QOS_DEFAULT;
      set(qos, wanted);
      qos.data_sharing().off();
      writer_ = made.publisher->create_datawriter(named, qos);
    } else {
      fast::DataReaderQos qos = fast::DATAREADER_QOS_DEFAULT;
      set(qos, wanted);
      qos.data_sharing().off();
      reader_ = made.subscriber->create_datareader(named, qos);
    }
    if (writer_ == nullptr && reader_ == nullptr) throw std::runtime_error("no endpoint");
  }

  PeerMatch match() override {
    PeerMatch now;
    if (writer_ != nullptr) {
      fast::PublicationMatchedStatus matched;
      writer_->get_publication_matched_status(matched);
      fast::OfferedIncompatibleQosStatus refused;
      writer_->get_offered_incompatible_qos_status(refused);
      if (refused.total_count > 0) refused_by_ = static_cast<int>(refused.last_policy_id);
      now.matched = matched.current_count;
    } else {
      fast::SubscriptionMatchedStatus matched;
      reader_->get_subscription_matched_status(matched);
      fast::RequestedIncompatibleQosStatus refused;
      reader_->get_requested_incompatible_qos_status(refused);
      if (refused.total_count > 0) refused_by_ = static_cast<int>(refused.last_policy_id);
      now.matched = matched.current_count;
    }
    now.refused_by = refused_by_;
    return now;
  }

  void write(const Payload& payload) override {
    Payload sample = payload;
    if (!writer_->write(&sample)) throw std::runtime_error("not written");
  }

  std::vector<Payload> take() override {
    std::vector<Payload> payloads;
    if (reader_ == nullptr) return payloads;
    Payload sample;
    fast::SampleInfo info;
    while (reader_->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) payloads.push_back(sample);
    }
    return payloads;
  }

 private:
  fast::DataWriter* writer_ = nullptr;
  fast::DataReader* reader_ = nullptr;
  int refused_by_ = 0;
};

int run(int domain, const char* profiles) {
  auto* factory = fast::DomainParticipantFactory::get_instance();
  fast::DomainParticipantQos qos;
  if (profiles != nullptr) {
    setenv("FASTRTPS_DEFAULT_PROFILES_FILE", profiles,
           1);  // loading it by name would not make it the default
    if (factory->load_profiles() != ReturnCode_t::RETCODE_OK) {
      throw std::runtime_error("profiles not taken");
    }
    qos = factory->get_default_participant_qos();
  } else {
    qos.transport().use_builtin_transports = false;  // no shared memory
    qos.transport().user_transports.push_back(
        std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>());
  }
  fast::DomainParticipant* participant =
      factory->create_participant(static_cast<std::uint32_t>(domain), qos);
  if (participant == nullptr) throw std::runtime_error("no participant");
  const Made made{participant, participant->create_publisher(fast::PUBLISHER_QOS_DEFAULT),
                  participant->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT)};
  const int status = peerLoop([&made](bool writer, const std::string& topic,
                                      const std::string& type, const PeerQos& wanted) {
    return std::make_unique<FastEndpoint>(made, writer, topic, type, wanted);
  });
  participant->delete_contained_entities();
  factory->delete_participant(participant);
  return status;
}

}  // namespace
}  // namespace lab::dds

#ifdef __SANITIZE_ADDRESS__
/// Fast DDS 2.9 allocates its writers' events with one size and frees them with another
/// (RTPSWriter::~RTPSWriter), an error in Fast DDS.
extern "C" const char* __asan_default_options() { return "new_delete_type_mismatch=0"; }
#endif

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) {
    std::cerr << "usage: fastdds_peer DOMAIN [PROFILES]\n";
    return 2;
  }
  try {
    return lab::dds::run(std::stoi(argv[1]), argc == 3 ? argv[2] : nullptr);
  } catch (const std::exception& error) {
    std::cout << "error " << error.what() << std::endl;
    return 1;
  }
}
