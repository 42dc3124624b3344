/// Versions that travel with every message log.
#pragma once

namespace lab {

/// Version of this software.
inline constexpr const char* kVersion = "0.1.0";

/// Version of the message contract (lcmtypes/, CHANGELOG.md). It rises with any change of a type.
inline constexpr int kContractVersion = 4;

/// The oldest whose logs are read: versions 2 and 3 only added types, and what version 4 changed is
/// converted (contract_upgrade.hpp).
inline constexpr int kOldestContractVersion = 1;

}  // namespace lab
