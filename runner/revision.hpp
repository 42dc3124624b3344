#pragma once

#include <string>

namespace lab::runner {

/// The state of the source that this program was built from, as git names it; empty: not known.
[[nodiscard]] std::string sourceRevision();

}  // namespace lab::runner
