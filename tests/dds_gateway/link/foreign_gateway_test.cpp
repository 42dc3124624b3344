/// Packets on the link that no gateway of the lab sends (tests/two_hosts.sh).
#include <gmock/gmock.h>

#include <cstdint>
#include <lab/robot_stop_t.hpp>
#include <string>
#include <vector>

#include "common/bus/bus_error.hpp"
#include "common/bus/channels.hpp"
#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/link/link.h"
#include "dds_gateway/link/link_peers.hpp"
#include "tests/support/network_hosts.hpp"

namespace lab::gateway {
namespace {

/// DDS of a participant on a host, which knows the topics of the run "run" and its message
/// contract.
class ForeignGateway {
 public:
  ForeignGateway(const Host& host, const std::string& peer)
      : domain_(domainOn(host, peer)),
        packets_(domain_, lab_link_Packet_desc, packetTopic(), latched()) {}

  /// Writes the first packet of a new stream.
  void write(std::string host, std::string channel, std::vector<std::uint8_t> data) {
    lab_link_Packet packet{};
    packet.gateway = 77;
    packet.slot = ++streams_;
    packet.stream = streams_;
    packet.host = host.data();
    packet.number = 1;
    packet.heard = wallUtime();
    packet.channel = channel.data();
    packet.data._buffer = data.data();
    packet.data._length = static_cast<std::uint32_t>(data.size());
    packet.data._maximum = packet.data._length;
    ASSERT_TRUE(packets_.write(&packet));
  }

 private:
  static std::string packetTopic() {
    const ProtocolVersion ours = ProtocolVersion::own();
    return "lab/link/run/packets/" + std::to_string(ours.contract) + "/" + ours.fingerprints;
  }

  static dds::Qos latched() {
    dds::Qos qos;
    qos.latched = true;
    return qos;
  }

  static dds::Domain domainOn(const Host& host, const std::string& peer) {
    const NetworkNamespaceScope there(host.process);
    return {
        77,
        dds::networkConfiguration({.address = host.address, .peers = {peer}, .multicast = false}),
        "test"};
  }

  dds::Domain domain_;
  dds::Writer packets_;
  std::int32_t streams_ = 0;
};

// The stops would be obeyed: a stop passes even from a host that is not joined.
TEST(LinkHosts, PacketsWithLongTextsAreDroppedAndCounted) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0);
  ASSERT_TRUE(hosts.untilReports(0, kLong));
  ForeignGateway dut(hosts[1], hosts[0].address);
  const std::string stop(channels::kRobotStop);
  const std::string long_name(LinkHeartbeat::kLongestName + 1, 'h');
  dut.write(long_name, stop, message<robot_stop_t>("keyboard", 1));
  dut.write("hostB", std::string(kLongestChannelName + 1, 'C'),
            message<robot_stop_t>("keyboard", 2));
  ASSERT_TRUE(hosts.until([&] { return hosts[0].status.foreign >= 2; }, kLong));
  dut.write("hostB", stop, message<robot_stop_t>("keyboard", 3));
  ASSERT_TRUE(hosts.untilHeard(0, "keyboard", stop, 3, kLong));
  EXPECT_EQ(hosts[0].of("keyboard", stop).size(), 1U);
  EXPECT_EQ(hosts[0].status.foreign, 2);
}

}  // namespace
}  // namespace lab::gateway
