/// The contract as LCM hashes it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lab {

/// "type hash" for every type that travels on a channel, one a line.
[[nodiscard]] std::string fingerprintList();

/// "type hash" and the end of the line.
[[nodiscard]] std::string fingerprintLine(std::string_view type, std::int64_t hash);

/// The type with this hash, empty when it is none of ours.
[[nodiscard]] std::string_view typeWithFingerprint(std::int64_t hash);

}  // namespace lab
