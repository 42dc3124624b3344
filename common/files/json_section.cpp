#include "common/files/json_section.hpp"

#include <cstdint>

#include "common/text/json_text.hpp"
#include "light/field/image.hpp"

namespace lab {

nlohmann::json parseJson(const std::string& name, const std::string& text,
                         const std::string& expected) {
  if (isNestedDeeper(text, kDeepestJson)) {
    throw ExperimentError(
        {fmt::format("{}: has more than {} brackets within each other, "
                     "expected {}",
                     name, kDeepestJson, expected)});
  }
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    throw ExperimentError({fmt::format("{}:{}: is no valid JSON, expected {}", name,
                                       1 + std::count(text.begin(), end, '\n'), expected)});
  } catch (const nlohmann::json::out_of_range&) {
    throw ExperimentError(
        {fmt::format("{}: holds a number beyond 1e308, expected {}", name, expected)});
  }
}

std::string fileId(const std::string& text) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
  return light::sha256({bytes, text.size()}).substr(0, 12);
}

}  // namespace lab
