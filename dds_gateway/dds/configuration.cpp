#include "dds_gateway/dds/configuration.hpp"

#include <arpa/inet.h>

#include <array>
#include <filesystem>
#include <string_view>

#include "common/files/certificate_folder.hpp"
#include "dds_gateway/dds/error.hpp"

namespace lab::dds {
namespace fs = std::filesystem;
namespace {

/// Sets the maximal number of participants on a machine (Cyclone's default of 9 refuses the tenth).
/// Cyclone sends announcements to each of these ports of each peer.
std::string indices(int most) {
  return "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>" +
         std::to_string(most) + "</MaxAutoParticipantIndex>";
}

void requireAddress(const std::string& text) {
  std::array<unsigned char, sizeof(in_addr)> bytes{};
  const bool is_whole = text.find('\0') == std::string::npos;
  if (is_whole && inet_pton(AF_INET, text.c_str(), bytes.data()) == 1) return;
  throw DdsError("found the address \"" + text +
                 "\", expected an IPv4 address as 192.168.1.20 (see ip -brief address)");
}

std::string peer(const std::string& address) { return R"(<Peer Address=")" + address + R"("/>)"; }

std::string wrapped(const std::string& inside) {
  return R"(<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any">)" + inside +
         "</Domain></CycloneDDS>";
}

/// Debian installs the plugins outside the loader's path.
std::string plugin(const std::string& element, const std::string& file,
                   const std::string& functions) {
  return "<" + element +
         R"( path="/usr/lib/)" LAB_LIBRARY_ARCHITECTURE R"(/libddsc0debian/libdds_security_)" +
         file + R"(.so" initFunction="init_)" + functions + R"(" finalizeFunction="finalize_)" +
         functions + R"("/>)";
}

std::string securityElement(const fs::path& folder) {
  if (const std::string problem = securityFolderProblem(folder); !problem.empty()) {
    throw DdsError(problem);
  }
  const auto& [identity_ca, certificate, key, permissions_ca, governance, permissions] =
      kSecurityFiles;
  const auto uri = [&folder](std::string_view file) {
    return "file:" + fs::absolute(folder / file).string();
  };
  return "<Security><Authentication>" + plugin("Library", "auth", "authentication") +
         "<IdentityCA>" + uri(identity_ca) + "</IdentityCA><IdentityCertificate>" +
         uri(certificate) + "</IdentityCertificate><PrivateKey>" + uri(key) +
         "</PrivateKey></Authentication><AccessControl>" +
         plugin("Library", "ac", "access_control") + "<PermissionsCA>" + uri(permissions_ca) +
         "</PermissionsCA><Governance>" + uri(governance) + "</Governance><Permissions>" +
         uri(permissions) + "</Permissions></AccessControl><Cryptographic>" +
         plugin("Library", "crypto", "crypto") + "</Cryptographic></Security>";
}

}  // namespace

std::string localConfiguration() {
  // The interface is given by address, not as "lo", and multicast as an attribute: other forms do
  // not find ROS 2 nodes with some of the localhost settings. A network card as second interface,
  // even without multicast, would also accept participants of other machines.
  return wrapped(
      "<General><Interfaces>"
      R"(<NetworkInterface address="127.0.0.1" multicast="true"/></Interfaces></General>)"
      "<Discovery>" +
      indices(100) + "<Peers>" + peer("127.0.0.1") + "</Peers></Discovery>");
}

std::string networkConfiguration(const NetworkOptions& options) {
  requireAddress(options.address);
  std::string peers;
  for (const std::string& address : options.peers) {
    requireAddress(address);
    peers += peer(address);
  }
  // If a cable is unplugged, the kernel queues 208 kB for each neighbour that does not answer ARP;
  // when this fills the socket's buffer, a write blocks for a second. So the buffer is larger.
  // An IP datagram that lost a fragment occupies the kernel's reassembly queue for 30 s. So no
  // message is larger than an Ethernet frame. The delay of nacks allows for reordered packets.
  return wrapped(R"(<General><Interfaces><NetworkInterface address=")" + options.address +
                 R"("/></Interfaces><AllowMulticast>)" + (options.multicast ? "spdp" : "false") +
                 "</AllowMulticast><MaxMessageSize>1400B</MaxMessageSize>"
                 "<FragmentSize>1300B</FragmentSize></General><Discovery>" +
                 indices(32) + "<SPDPInterval>1s</SPDPInterval>" +
                 (peers.empty() ? "" : "<Peers>" + peers + "</Peers>") +
                 "</Discovery><Internal><NackDelay>10ms</NackDelay>" +
                 (options.unthrottled_writers ? "<Watermarks><WhcHigh>1GB</WhcHigh></Watermarks>"
                                                "<SocketSendBufferSize max=\"4MB\"/>"
                                              : "") +
                 "</Internal>" +
                 (options.security.empty() ? "" : securityElement(options.security)));
}

}  // namespace lab::dds
