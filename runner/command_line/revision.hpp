#pragma once

#include <string>

namespace lab::runner {

/// Short hash of the commit that this program was built from; empty: not known.
[[nodiscard]] std::string sourceRevision();

/// The date of that commit, "2026-11-22 10:17:23 UTC"; empty: not known.
[[nodiscard]] std::string sourceDate();

}  // namespace lab::runner
