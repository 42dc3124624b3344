/// The lines in which an experiment is described.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

namespace lab::description {

inline constexpr std::size_t kLabel = 14;  ///< columns before the text of a line

/// @param label empty: the line continues the one before
[[nodiscard]] inline std::string line(std::string label, const std::string& text) {
  label.resize(std::max(kLabel, label.size() + 1), ' ');
  return label + text + "\n";
}

}  // namespace lab::description
