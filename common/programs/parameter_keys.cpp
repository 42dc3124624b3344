#include "common/programs/parameter_keys.hpp"

#include <algorithm>
#include <vector>

namespace lab {
namespace {

using language::Dimension;

std::vector<std::string> partsOf(std::string_view suffix) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= suffix.size();) {
    const std::size_t end = std::min(suffix.find('_', at), suffix.size());
    parts.emplace_back(suffix.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

/// A unit, or its square or cube: "cm2".
struct Power {
  std::string unit;
  int exponent = 1;
};

std::optional<Power> powerOf(std::string part) {
  Power power;
  if (part.size() > 1 && (part.back() == '2' || part.back() == '3')) {
    power.exponent = part.back() - '0';
    part.pop_back();
  }
  power.unit = part;
  if (!language::unitNamed(part)) return std::nullopt;
  return power;
}

struct UsualKeys {
  Dimension dimension;
  bool angle;
  std::vector<std::string_view> suffixes;
};

}  // namespace

std::optional<ParameterUnit> unitOfSuffix(std::string_view suffix) {
  ParameterUnit result;
  if (suffix.empty()) return result;
  if (suffix == "hz") return ParameterUnit{"1/s", language::kRate};
  bool below = false;
  bool first = true;
  for (const std::string& part : partsOf(suffix)) {
    if (part == "per") {
      if (first) result.text = "1";
      below = true;
      first = false;
      continue;
    }
    const std::optional<Power> power = powerOf(part);
    if (!power) return std::nullopt;
    below = below || !first;  // "cm_s" is cm/s
    for (int i = 0; i < power->exponent; ++i) {
      const Dimension one = language::unitNamed(power->unit)->dimension;
      result.text += (result.text.empty() ? "" : below ? "/" : "*") + power->unit;
      result.dimension = below ? quotient(result.dimension, one) : product(result.dimension, one);
    }
    first = false;
  }
  if (result.text == "1") return std::nullopt;
  return result;
}

std::string keysOfParameter(const std::string& name, const Dimension& dimension, bool angle) {
  static const std::vector<UsualKeys> usual{{language::kSpeed, false, {"cm_s", "m_s", "mm_s"}},
                                            {language::kLength, false, {"cm", "m", "mm"}},
                                            {language::kTime, false, {"s", "ms", "min"}},
                                            {language::kRate, true, {"rad_s", "deg_s"}},
                                            {language::kRate, false, {"per_s", "hz", "per_min"}},
                                            {language::kPure, true, {"rad", "deg"}},
                                            {language::kPure, false, {"", "percent"}},
                                            {language::kVoltage, false, {"volt"}},
                                            {{2, -1, 0}, false, {"cm2_s", "m2_s", "mm2_s"}},
                                            {{2, 0, 0}, false, {"cm2", "m2", "mm2"}},
                                            {{-1, 0, 0}, false, {"per_cm", "per_m"}},
                                            {{1, -2, 0}, false, {"cm_s2", "m_s2"}}};
  std::string keys;
  for (const UsualKeys& one : usual) {
    if (!(one.dimension == dimension) || one.angle != angle) continue;
    for (const std::string_view suffix : one.suffixes) {
      keys += (keys.empty() ? "" : ", ") + name + (suffix.empty() ? "" : "_") + std::string(suffix);
    }
  }
  const std::size_t last = keys.rfind(", ");
  if (last != std::string::npos) keys.replace(last, 2, " or ");
  return keys.empty() ? "parameters = {" + name + " = \"...\"}" : keys;
}

std::string numberOf(const Dimension& dimension) {
  return dimension == language::kPure ? "a number without unit"
                                      : "a number in " + unitText(dimension);
}

}  // namespace lab
