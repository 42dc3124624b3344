/// Common parts of the key descriptions.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/experiment/keys/experiment_form.hpp"
#include "common/experiment/keys/experiment_keys.hpp"

namespace lab::keys {

template <typename Enum>
Choice choiceOf(const char* name, Enum value) {
  return {name, static_cast<int>(value)};
}

inline const Range kShare{0, 1};
inline const Range kPlace{-3000, 3000};
inline const Range kLength{0.1, 3000};
inline const Range kAngle{-3600, 3600};
inline const Range kSpeed{-500, 500};
inline constexpr double kLongestFreeRun = 86400;  ///< [s]

template <typename Enum>
void enumerate(KeyVisitor& visitor, const Key& key, std::span<const Choice> choices, Enum& field) {
  int value = static_cast<int>(field);
  visitor.choice(key, choices, value);
  if (value != kUndecided) field = static_cast<Enum>(value);
}

template <typename Element, typename Keys>
void visitList(KeyVisitor& visitor, const Key& key, const ListRule& rule,
               std::vector<Element>& elements, const Keys& keys) {
  visitor.list(
      key, rule, elements.size(), [&](std::size_t size) { elements.assign(size, Element{}); },
      [&](std::size_t index) { keys(elements[index]); });
}

/// A key that is written only if its value differs from the default.
inline Key writtenIf(bool something, Key key) {
  if (key.default_text.empty()) key.default_text = "-";
  key.need = something ? Need::kOptional : Need::kShorthand;
  return key;
}

/// A key that is allowed only next to another one.
inline Key applicableIf(bool applies, const char* condition, Key key) {
  key.applies = applies ? Applies::kYes : Applies::kNo;
  key.condition = condition;
  return key;
}

/// Makes keys that are allowed only for some values of another key, such as "model".
class Selector {
 public:
  template <typename Enum>
  Selector(KeyVisitor& visitor, const Key& key, std::span<const Choice> choices, Enum& field)
      : name_(key.name), choices_(choices), current_(static_cast<int>(field)) {
    visitor.choice(key, choices, current_);
    if (current_ != kUndecided) field = static_cast<Enum>(current_);
  }

  template <typename Enum>
  [[nodiscard]] Key only(std::initializer_list<Enum> values, Key key) const {
    key.applies = current_ == kUndecided ? Applies::kUndecided : Applies::kNo;
    for (const Enum value : values) {
      if (static_cast<int>(value) == current_) key.applies = Applies::kYes;
      key.condition += key.condition.empty() ? name_ + " = " : " or ";
      key.condition += '"' + nameOf(static_cast<int>(value)) + '"';
    }
    return key;
  }

 private:
  [[nodiscard]] std::string nameOf(int value) const {
    return std::ranges::find(choices_, value, &Choice::value)->name;
  }

  std::string name_;
  std::span<const Choice> choices_;
  int current_;
};

}  // namespace lab::keys
