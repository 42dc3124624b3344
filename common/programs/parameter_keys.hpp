/// Keys of an experiment file that give a parameter as a number with its unit: "v_cm_s = 5".
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "robot/language/dimension.hpp"

namespace lab {

/// The unit that the end of a key names.
struct ParameterUnit {
  std::string text;  ///< As in programs: "cm/s"; empty: none.
  language::Dimension dimension;
};

/// @param suffix "cm_s", "per_s", "cm2_s", "hz"; empty: no unit
/// @return nothing if it names no unit
[[nodiscard]] std::optional<ParameterUnit> unitOfSuffix(std::string_view suffix);

/// The keys that give a parameter of this dimension, for messages: "v_cm_s, v_m_s or v_mm_s".
/// @param angle whether it is an angle or a turning rate
[[nodiscard]] std::string keysOfParameter(const std::string& name,
                                          const language::Dimension& dimension, bool angle);

/// A number of this dimension in words: "a number in cm/s", "a number without unit".
[[nodiscard]] std::string numberOf(const language::Dimension& dimension);

}  // namespace lab
