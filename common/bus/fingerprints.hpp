/// LCM's type hashes of all messages.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lab {

/// One line "type hash" for every type that is sent on a channel.
[[nodiscard]] std::string fingerprintList();

/// One such line, with its line end.
[[nodiscard]] std::string fingerprintLine(std::string_view type, std::int64_t hash);

/// The name of the type with this hash; empty if it is unknown.
[[nodiscard]] std::string_view typeWithFingerprint(std::int64_t hash);

}  // namespace lab
