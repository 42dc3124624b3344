/// A bus of its own for every lab.
#pragma once

#include <string>

namespace lab::runner {

inline constexpr int kFirstPort = 20000;
inline constexpr int kLastPort = 59999;

/// Whether a port may be held by several who all agree to share it. LCM's sockets do, so that two
/// labs would not notice each other; a lab's own bus is nobody else's.
enum class Sharing : bool { kAlone, kShared };

/// Whether the UDP port can be held on this machine, alone or beside others that share it.
[[nodiscard]] bool portIsFree(int port, Sharing sharing = Sharing::kAlone);

/// A port for a new lab: `wanted`, or a free one when that is 0. A wanted port may have listeners
/// (a logger started by hand, say); refuseForeignTraffic() finds speakers.
/// @throws UserError when none is free.
[[nodiscard]] int choosePort(int wanted);

/// Listens this long and refuses a bus on which somebody already speaks.
/// @throws UserError naming the channel and its sender.
void refuseForeignTraffic(const std::string& url, int listen_ms);

}  // namespace lab::runner
