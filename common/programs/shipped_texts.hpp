#pragma once

#include <string_view>
#include <vector>

namespace lab {

/// A file of programs/.
struct ShippedText {
  std::string_view name;
  std::string_view toml;
};

/// The files of programs/. The build writes the source from them (common/CMakeLists.txt).
[[nodiscard]] const std::vector<ShippedText>& shippedTexts();

}  // namespace lab
