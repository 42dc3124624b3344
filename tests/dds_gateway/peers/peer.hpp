/// The other side of DDS as a program of its own (peer_loop.hpp says what it understands).
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace lab::dds {

/// Hang check, no measure: nothing waits this long when all is well.
constexpr std::chrono::seconds kPatience{15};

/// Whether `done` came true; it is asked again until then.
bool eventually(const std::function<bool()>& done);

class Peer {
 public:
  /// @throws std::runtime_error when the program does not say "ready".
  explicit Peer(const std::vector<std::string>& command);
  ~Peer();
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void say(const std::string& line) const;

  /// All it said so far.
  const std::vector<std::string>& heard();

  /// Whether it says exactly this line, now or soon.
  bool says(const std::string& line);

  /// Payloads it got of a topic, as hex.
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

/// Configurations of ROS 2 nodes that stay on their machine.
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
