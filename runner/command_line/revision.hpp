#pragma once

#include <string>

namespace lab::runner {

/// The state of the source that this program was built from, as git names it; empty: not known.
[[nodiscard]] std::string sourceRevision();

/// When that state was committed, "2026-11-22 10:17:23 UTC"; empty: not known.
[[nodiscard]] std::string sourceDate();

}  // namespace lab::runner
