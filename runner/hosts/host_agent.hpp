/// `lab host-agent`: a lab's hands on another computer (docs/hosts.md).
#pragma once

#include <filesystem>

namespace lab::runner {

/// How often either side says that it is there.
inline constexpr int kHostHeartbeat_ms = 200;

/// Obeys the JSON lines on standard input, and answers on standard output, until it is told to
/// stop, its input ends, or it has heard nothing for long. Nothing of it is left then: no process,
/// no file.
///
///   runner              agent
///                       {"say": "hello", ...} (host_contract.hpp)
///   {"do": "ping", "utime"}           {"say": "pong", "asked", "utime"}
///   {"do": "begin", "name", "port", "ttl", "patience_s"}   {"say": "begun", "url", "warning"}
///   {"do": "file", "path", "data"}    appended to a file of the run
///   {"do": "start", "service", "experiment", "uses_ports", "arguments"}   {"say": "started",
///   "service"}
///   {"do": "end", "service"}          SIGTERM; {"do": "kill", ...} SIGKILL
///   {"do": "alive"}                   {"say": "alive", "utime"} both all kHostHeartbeat_ms
///   {"do": "stop"}                    all of it ends; {"say": "left"}
///                       {"say": "line", "service", "text"}   what a service prints
///                       {"say": "ready", "service"}
///                       {"say": "ended", "service", "how"}
///                       {"say": "trouble", "text"}           what cannot be done
/// @param programs folder of the services' programs
/// @return exit code
[[nodiscard]] int hostAgent(const std::filesystem::path& programs);

}  // namespace lab::runner
