/// Versions that are recorded in every message log.
#pragma once

namespace lab {

/// Version of this software.
inline constexpr const char* kVersion = "0.1.0";

/// Version of the message contract (lcmtypes/, CHANGELOG.md). It increases with any change of a
/// message type.
inline constexpr int kContractVersion = 5;

/// The oldest contract version whose logs can be read. Versions 2 and 3 only added types; what
/// versions 4 and 5 changed is converted (contract_upgrade.hpp).
inline constexpr int kOldestContractVersion = 1;

}  // namespace lab
