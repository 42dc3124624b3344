/// A separate bus (UDP port) for each lab.
#pragma once

#include <string>

namespace lab::runner {

inline constexpr int kFirstPort = 20000;
inline constexpr int kLastPort = 59999;

/// Whether other sockets that allow sharing may use the port too. LCM's sockets share, so two labs
/// on one port would not notice each other; hence the ports of labs are checked with kAlone.
enum class Sharing : bool { kAlone, kShared };

/// Whether the UDP port can be bound on this machine, alone or shared.
[[nodiscard]] bool portIsFree(int port, Sharing sharing = Sharing::kAlone);

/// A port for a new lab: `wanted`, or a free one if that is 0. Others may listen on a wanted port
/// (a logger that the user started); refuseForeignTraffic() finds senders.
/// @throws UserError when none is free
[[nodiscard]] int choosePort(int wanted);

/// Listens this long for messages of other senders.
/// @throws UserError naming the channel and sender of a message
void refuseForeignTraffic(const std::string& url, int listen_ms);

}  // namespace lab::runner
