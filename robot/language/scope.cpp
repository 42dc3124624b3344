#include "robot/language/scope.hpp"

#include <algorithm>
#include <iterator>

#include "robot/language/builtins.hpp"

namespace lab::language {
std::string Scope::knownNames(std::string_view unknown) const {
  const std::string_view instead = otherUnit(unknown);
  if (!instead.empty()) return ": write " + std::string(instead) + " for this unit";
  std::vector<std::string> names;
  for (const auto& [name, value] : parameters) names.push_back(name);
  for (const auto& [name, value] : states) names.push_back(name);
  for (const auto& [name, value] : phases) names.push_back(name);
  const std::string own = names.empty() ? "no names of its own" : listed(names);
  std::ranges::copy(builtinNames(), std::back_inserter(names));
  return "; this program has " + own + ", and docs/programs.md lists those of the language" +
         suggestion(suggest, unknown, names);
}

std::string Scope::knownPhases(std::string_view unknown) const {
  std::vector<std::string> names;
  for (const auto& [name, value] : phases) names.push_back(name);
  return ", expected a phase: " + listed(names) + suggestion(suggest, unknown, names);
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace lab::language
