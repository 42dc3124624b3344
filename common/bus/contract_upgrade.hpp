/// Converts messages of older contract versions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace lab {

/// Converts a message of an older contract version to the present one.
/// @return nothing if the message needs no conversion, is damaged, or is of an unknown type
[[nodiscard]] std::optional<std::vector<std::uint8_t>> upgraded(Bytes message);

/// The types that upgraded() converts, in the format of fingerprintList().
[[nodiscard]] std::string olderFingerprintList();

}  // namespace lab
