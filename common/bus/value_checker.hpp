/// The check of the numbers of a message.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace lab {

/// Walks over the numbers of a message and keeps the first one that is out of its range, with its
/// place: "robots[2].program.epsilon: found 5e-324, expected 0.001 to 3600". Names must
/// outlive the checker (literals).
class ValueChecker {
 public:
  /// Microseconds since 1970; 0 stands for "never" in many fields. Allowed: 0 to the year 2100, so
  /// that no difference of two times and no count of frames between them overflows.
  void time(const char* name, std::int64_t utime) { whole(name, utime, 0, kLatestUtime); }

  /// A finite number from `low` to `high`.
  void number(const char* name, double value, double low, double high) {
    if (!(value >= low && value <= high)) fail(name, value, low, high);
  }
  void number(const char* name, float value, double low, double high) {
    number(name, static_cast<double>(value), low, high);
  }

  /// What was computed from measurements: any finite number from `low` on, or nan: not known.
  void result(const char* name, double value, double low = std::numeric_limits<double>::lowest()) {
    if (!std::isnan(value)) number(name, value, low, std::numeric_limits<double>::max());
  }
  void results(const char* name, const std::vector<float>& values,
               double low = std::numeric_limits<double>::lowest()) {
    for (const float value : values) result(name, static_cast<double>(value), low);
  }

  void whole(const char* name, std::int64_t value, std::int64_t low, std::int64_t high) {
    if (value < low || value > high) fail(name, value, low, high);
  }

  /// Checks a part of the message by checkValues(ValueChecker&, part).
  template <class Part>
  void part(const char* name, const Part& part) {
    enter(name, -1);
    checkValues(*this, part);
    leave();
  }

  template <class Part>
  void list(const char* name, const std::vector<Part>& parts) {
    for (std::size_t i = 0; i < parts.size() && !problem_; ++i) {
      enter(name, static_cast<std::ptrdiff_t>(i));
      checkValues(*this, parts[i]);
      leave();
    }
  }

  /// The first number that is out of range; nothing: all are possible.
  [[nodiscard]] const std::optional<std::string>& problem() const { return problem_; }

  static constexpr std::int64_t kLatestUtime = 4'102'444'800'000'000;  ///< the year 2100

 private:
  struct Place {
    const char* name = "";
    std::ptrdiff_t index = -1;
  };

  void enter(const char* name, std::ptrdiff_t index) { places_.at(depth_++) = {name, index}; }
  void leave() { --depth_; }
  void fail(const char* name, double value, double low, double high);
  void fail(const char* name, std::int64_t value, std::int64_t low, std::int64_t high);
  void fail(const char* name, const std::string& problem);

  std::array<Place, 4> places_;  ///< path of nested parts; no message nests deeper
  std::size_t depth_ = 0;
  std::optional<std::string> problem_;
};

}  // namespace lab
