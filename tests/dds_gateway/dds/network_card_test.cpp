// A computer with a network card (A of tests/two_hosts.sh) receives nothing from other machines.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/ros/ros_type.hpp"
#include "tests/dds_gateway/peers/peer.hpp"
#include "tests/support/wait_until.hpp"

namespace lab::dds {
namespace {

const ros::RosType& kType = ros::rosType<ros::Float64>();

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// A node on B that announces itself to every participant of A ten times a second.
std::vector<std::string> caller() {
  return {"/usr/bin/nsenter",
          "-t",
          variable("HOST_B"),
          "-n",
          LAB_CYCLONE_PEER,
          "0",
          "<CycloneDDS><Domain><Discovery><SPDPInterval>100ms</SPDPInterval><Peers>"
          "<Peer Address=\"" +
              variable("ADDRESS_A") + "\"/></Peers></Discovery></Domain></CycloneDDS>"};
}

/// Whether our endpoints find those of the node on the other machine, within `patience`.
bool met(const std::string& configuration, std::chrono::milliseconds patience) {
  const Domain dut(0, configuration, "test");
  EventDescriptor waker;
  const Writer writer(dut, *kType.descriptor, "rt/a", ros::defaultQos(kType));
  const Reader reader(dut, *kType.descriptor, "rt/b", ros::defaultQos(kType), waker);
  const Peer elsewhere(caller());
  const std::string type = kType.descriptor->m_typename;
  elsewhere.say("reader rt/a " + type);
  elsewhere.say("writer rt/b " + type);
  return waitUntil([&] { return writer.matching().peers + reader.matching().peers > 0; }, patience);
}

TEST(NetworkCard, NodesOnOtherMachinesAreNotReceived) {
  ASSERT_TRUE(met(networkConfiguration({.address = variable("ADDRESS_A")}), kPatience))
      << "the caller does not call";
  EXPECT_FALSE(met(localConfiguration(), std::chrono::seconds(2)));
}

}  // namespace
}  // namespace lab::dds
