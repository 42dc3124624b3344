#pragma once

#include <string>

namespace lab::runner {

/// What `--version` prints: versions, the commit, compiler and libraries. Nothing in it depends on
/// when or where it was built.
[[nodiscard]] std::string buildFacts();

}  // namespace lab::runner
