#include "common/experiment/keys/key_visitor.hpp"

#include <cmath>

#include "common/files/file_values.hpp"

namespace lab::keys {

bool Range::contains(double value) const {
  const bool above = above_low ? value > low : value >= low;
  const bool below = below_high ? value < high : value <= high;
  return above && below && (!whole || value == std::floor(value));
}

std::string Range::text() const {
  std::string text = whole ? "whole numbers from " : "";
  text += (above_low ? "above " : "") + numberText(low);
  text += (below_high ? " to below " : " to ") + numberText(high);
  return text;
}

bool TextRule::accepts(std::string_view text) const {
  if (as_folder) return isBareName(text, most, "._-");
  return bare ? isBareName(text, most) : text.size() <= most;
}

std::string TextRule::text() const {
  std::string text = "text of at most " + std::to_string(most) + " bytes";
  if (as_folder || bare) {
    text = "1 to " + std::to_string(most) + " letters, digits, ";
    text += as_folder ? "dots, _ and -" : "_ and -";
    text += ", beginning with a letter or digit";
  }
  return text;
}

std::string choiceText(std::span<const Choice> choices) {
  std::string text;
  for (const Choice& choice : choices) {
    if (choice.refusal.empty()) text += (text.empty() ? "" : ", ") + tomlString(choice.name);
  }
  return text;
}

std::string countText(const ListRule& rule) {
  const std::string most = std::to_string(rule.most);
  return rule.fewest == 0 ? "at most " + most : std::to_string(rule.fewest) + " to " + most;
}

}  // namespace lab::keys
