/// `lab host-agent`: starts and stops services on a remote host (docs/hosts.md).
#pragma once

#include <filesystem>

namespace lab::runner {

/// Period of the "alive" messages of both sides.
inline constexpr int kHostHeartbeat_ms = 200;

/// Reads requests as JSON lines from standard input and answers on standard output, until it
/// receives "stop", its input ends, or no message arrives within the time set by "begin". It then
/// ends all processes that it started and deletes all files that it wrote.
///
/// Requests of the runner, and answers of the agent:
///   {"do": "ping", "utime"}          {"say": "pong", "asked", "utime"}
///   {"do": "begin", "name", "host", "port", "ttl", "patience_s"}
///                                    {"say": "begun", "url", "warning"}
///   {"do": "file", "path", "data"}   appends to a file of the run
///   {"do": "start", "service", "experiment", "uses_ports", "arguments"}
///                                    {"say": "started", "service"}
///   {"do": "end", "service"}         SIGTERM
///   {"do": "kill", "service"}        SIGKILL
///   {"do": "stop"}                   ends all services; {"say": "left"}
/// Messages of the agent without a request:
///   {"say": "hello", ...}                the first message (host_contract.hpp)
///   {"say": "line", "service", "text"}   a line that a service printed
///   {"say": "ready", "service"}
///   {"say": "ended", "service", "how"}
///   {"say": "trouble", "text"}           a request failed
/// Both sides send {"do": "alive"} or {"say": "alive", "utime"} every kHostHeartbeat_ms.
///
/// @param programs folder with the programs of the services
/// @return exit code
[[nodiscard]] int hostAgent(const std::filesystem::path& programs);

}  // namespace lab::runner
