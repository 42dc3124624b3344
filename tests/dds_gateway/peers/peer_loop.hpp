/// Programs that play the other side of DDS in the tests. They read commands from stdin and print
/// what they receive to stdout. The protocol is the same for all vendors.
///   reader TOPIC TYPE QOS...    writer TOPIC TYPE QOS...    (TYPE:
///   geometry_msgs::msg::dds_::Twist_) write TOPIC HEX             the whole payload, encapsulation
///   header first sync WORD                   answered by "synced WORD" when all commands before it
///   are done
///   -> ready | got TOPIC HEX | matched TOPIC NUMBER | refused TOPIC POLICY | error TEXT
/// QOS: besteffort, latched, depth=N, representation=xcdr1|xcdr2|both, hash=RIHS01_...
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace lab::dds {

using Payload = std::vector<std::uint8_t>;

[[nodiscard]] std::string hexOf(const Payload& payload);
/// @throws std::runtime_error
[[nodiscard]] Payload payloadOf(const std::string& hex);

struct PeerQos {
  bool reliable = true;
  bool latched = false;
  int depth = 10;
  bool xcdr1 = true;
  bool xcdr2 = false;
  std::string user_data;
};

/// Matches of an endpoint.
struct PeerMatch {
  int matched = 0;
  int refused_by = 0;  ///< id of the last incompatible policy, 0: none

  bool operator==(const PeerMatch&) const = default;
};

/// A vendor's endpoint.
class PeerEndpoint {
 public:
  PeerEndpoint() = default;
  PeerEndpoint(const PeerEndpoint&) = delete;
  PeerEndpoint& operator=(const PeerEndpoint&) = delete;
  virtual ~PeerEndpoint() = default;
  virtual PeerMatch match() = 0;
  virtual void write(const Payload& /*payload*/) {}
  virtual std::vector<Payload> take() { return {}; }
};

using MakeEndpoint = std::function<std::unique_ptr<PeerEndpoint>(
    bool writer, const std::string& topic, const std::string& type, const PeerQos& qos)>;

/// Runs until stdin ends. @return the exit status
int peerLoop(const MakeEndpoint& make);

}  // namespace lab::dds
