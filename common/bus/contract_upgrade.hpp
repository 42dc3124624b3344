/// Messages of older contract versions, read as if they were of this one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace lab {

/// The message as this version writes it, where an older version wrote it and the type has changed
/// since; nothing where it needs no change, is damaged or is none of ours.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> upgraded(Bytes message);

/// The types that upgraded() reads, as fingerprintList().
[[nodiscard]] std::string olderFingerprintList();

}  // namespace lab
