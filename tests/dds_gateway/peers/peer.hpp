/// Starts a program that plays the other side of DDS (peer_loop.hpp has its protocol).
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace lab::dds {

/// Time limit that detects hangs; no test waits this long if it succeeds.
constexpr std::chrono::seconds kPatience{15};

/// Calls `done` repeatedly until it is true. @return whether it became true
bool eventually(const std::function<bool()>& done);

class Peer {
 public:
  /// @throws std::runtime_error if the program does not print "ready"
  explicit Peer(const std::vector<std::string>& command);
  ~Peer();
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void say(const std::string& line) const;

  /// The output so far.
  const std::vector<std::string>& heard();

  /// Whether it has printed exactly this line, or does so soon.
  bool says(const std::string& line);

  /// Payloads that it received on a topic, as hex.
  std::vector<std::string> got(const std::string& topic);

  void freeze();
  void thaw();

 private:
  pid_t pid_ = -1;
  int to_ = -1;
  int from_ = -1;
  bool frozen_ = false;
  std::string rest_;
  std::vector<std::string> lines_;
};

/// Configurations of ROS 2 nodes that use only their own machine.
/// Humble with ROS_LOCALHOST_ONLY=1.
inline constexpr const char* kHumble =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
    "</Interfaces></General></Domain></CycloneDDS>,";
/// Jazzy with ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST.
inline constexpr const char* kJazzy =
    "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    "<Peers><Peer address=\"localhost\"/></Peers></Discovery></Domain></CycloneDDS>,";

}  // namespace lab::dds
