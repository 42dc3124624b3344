#pragma once

#include <string>

namespace lab::runner {

/// The text of `--version`: versions, the commit, compiler and libraries. It does not depend on
/// when or where the program was built.
[[nodiscard]] std::string buildFacts();

}  // namespace lab::runner
