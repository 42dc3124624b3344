/// Reading JSON calibration files, with an error that names the file and the key.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/files/experiment_error.hpp"

namespace lab {

/// An object of the file, with its path for messages. All getters throw ExperimentError if the key
/// is missing or its value is wrong.
class JsonSection {
 public:
  /// @param file its name, for messages
  /// @param help the end of messages about missing keys: where the keys are listed
  JsonSection(std::string file, std::string help, const nlohmann::json& value)
      : JsonSection(std::move(file), std::move(help), "", value) {}

  [[nodiscard]] bool has(const char* key) const { return value_.contains(key); }

  [[nodiscard]] JsonSection section(const char* key) const {
    return {file_, help_, path_ + key + ".", at(key)};
  }

  [[nodiscard]] std::string text(const char* key) const {
    const nlohmann::json& value = at(key);
    if (!value.is_string()) fail(key, "found " + value.dump() + ", expected a text");
    return value.get<std::string>();
  }

  /// A number from low to high, multiplied by `unit`.
  [[nodiscard]] double number(const char* key, double low, double high, double unit = 1) const {
    const nlohmann::json& value = at(key);
    if (!value.is_number()) fail(key, "found " + shortened(value) + ", expected a number");
    const double found = value.get<double>();
    if (!(found >= low && found <= high)) {
      fail(key, fmt::format("found {:g}, allowed {:g} to {:g}", found, low, high));
    }
    return found * unit;
  }

  /// As number(); `otherwise` if the key is missing.
  [[nodiscard]] double number(const char* key, double low, double high, double unit,
                              double otherwise) const {
    return has(key) ? number(key, low, high, unit) : otherwise;
  }

  [[nodiscard]] int pixels(const char* key) const {
    constexpr double kMostPixels = 20'000;
    const double found = number(key, 1, kMostPixels);
    if (found != std::floor(found)) fail(key, fmt::format("found {:g}, expected pixels", found));
    return static_cast<int>(found);
  }

  /// All numbers of an array, nested or not, row by row.
  [[nodiscard]] std::vector<double> numbers(const char* key) const {
    std::vector<double> found;
    collect(at(key), key, found);
    return found;
  }

  /// As numbers(), with exactly N elements.
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> numbers(const char* key) const {
    const std::vector<double> found = numbers(key);
    if (found.size() != N) {
      fail(key, fmt::format("found {} numbers, expected {}", found.size(), N));
    }
    std::array<double, N> values{};
    std::copy(found.begin(), found.end(), values.begin());
    return values;
  }

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    const std::string path =
        key.empty() && !path_.empty() ? path_.substr(0, path_.size() - 1) : path_ + key;
    throw ExperimentError({file_ + ": " + (path.empty() ? "" : path + ": ") + what});
  }

 private:
  JsonSection(std::string file, std::string help, std::string path, const nlohmann::json& value)
      : file_(std::move(file)), help_(std::move(help)), path_(std::move(path)), value_(value) {
    if (!value_.is_object()) {
      fail("", fmt::format("found {}, expected {{ keys and values }}", value_.type_name()));
    }
  }

  static std::string shortened(const nlohmann::json& value) {
    const std::string text = value.dump();
    return text.size() <= 40 ? text : text.substr(0, 37) + "...";
  }

  [[nodiscard]] const nlohmann::json& at(const char* key) const {
    if (!has(key)) fail(key, "is missing (" + help_ + ")");
    return value_.at(key);
  }

  void collect(const nlohmann::json& value, const char* key, std::vector<double>& found) const {
    if (value.is_number()) {
      found.push_back(value.get<double>());
    } else if (value.is_array()) {
      for (const nlohmann::json& element : value) collect(element, key, found);
    } else {
      fail(key, "found " + shortened(value) + " in it, expected numbers only");
    }
  }

  std::string file_;
  std::string help_;
  std::string path_;
  const nlohmann::json& value_;
};

/// Parses JSON.
/// @param name of the file, for messages
/// @param expected the expected kind of file, for messages
/// @throws ExperimentError that names the file and the line
[[nodiscard]] nlohmann::json parseJson(const std::string& name, const std::string& text,
                                       const std::string& expected);

/// The id of a calibration: the first 12 digits of the SHA-256 of its file's text.
[[nodiscard]] std::string fileId(const std::string& text);

}  // namespace lab
