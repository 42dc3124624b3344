#include "common/bus/value_checker.hpp"

#include <array>
#include <cstdio>

namespace lab {
namespace {

std::string shortest(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

}  // namespace

void ValueChecker::fail(const char* name, double value, double low, double high) {
  fail(name, "found " + shortest(value) + ", expected " + shortest(low) + " to " + shortest(high));
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
