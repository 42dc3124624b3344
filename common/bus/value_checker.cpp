#include "common/bus/value_checker.hpp"

#include "robot/language/number_text.hpp"

namespace lab {

void ValueChecker::fail(const char* name, double value, double low, double high) {
  constexpr int kDigits = 6;
  const int digits = language::digitsBeside({low, high}, value, kDigits);
  const auto text = [&](double number) { return language::numberText(number, digits); };
  fail(name, "found " + text(value) + ", expected " + text(low) + " to " + text(high));
}

void ValueChecker::fail(const char* name, std::int64_t value, std::int64_t low, std::int64_t high) {
  fail(name, "found " + std::to_string(value) + ", expected " + std::to_string(low) + " to " +
                 std::to_string(high));
}

void ValueChecker::fail(const char* name, const std::string& problem) {
  if (problem_) return;
  std::string text;
  for (std::size_t i = 0; i < depth_; ++i) {
    text += places_.at(i).name;
    if (places_.at(i).index >= 0) text += "[" + std::to_string(places_.at(i).index) + "]";
    text += ".";
  }
  problem_ = text + name + ": " + problem;
}

}  // namespace lab
