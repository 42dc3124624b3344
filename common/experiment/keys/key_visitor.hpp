/// The description of one key of an experiment file, and the interface of what handles the keys.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/programs/program.hpp"
#include "robot/dynamics/wheel_limits.hpp"

namespace lab::keys {

enum class Need {
  kOptional,   ///< has a default
  kRequired,   ///< must be given
  kShorthand,  ///< is read and expanded, but not written
};

/// Whether a key is allowed here, which may depend on an earlier key ("model").
enum class Applies { kYes, kNo, kUndecided };

struct Key {
  std::string name;
  std::string meaning;  ///< one sentence without full stop, for the docs
  Need need = Need::kOptional;
  std::string default_text = {};  ///< for the docs, if the default is not a plain value
  Applies applies = Applies::kYes;
  std::string condition = {};  ///< when it is allowed, "body = \"wire\" or \"serial\""
};

/// Allowed numbers, in the file's unit.
struct Range {
  double low = 0;
  double high = 0;
  bool above_low = false;   ///< low itself is not allowed
  bool below_high = false;  ///< high itself is not allowed
  bool whole = false;       ///< no fractions

  /// False for NaN.
  [[nodiscard]] bool contains(double value) const;
  [[nodiscard]] std::string text() const;
};

/// Allowed texts.
struct TextRule {
  std::size_t most = 0;    ///< bytes
  bool as_folder = false;  ///< letters, digits, . _ and -, beginning with a letter or digit
  bool bare = false;       ///< letters, digits, _ and -
  [[nodiscard]] bool accepts(std::string_view text) const;
  [[nodiscard]] std::string text() const;
};

struct Choice {
  std::string name;
  int value = 0;
  std::string refusal = {};  ///< why this version does not accept it, empty: it does
};

/// The value of a choice that could not be read.
inline constexpr int kUndecided = -1;

/// How a list is written, and its length.
struct ListRule {
  std::size_t fewest = 0;
  std::size_t most = 0;
  bool in_line = false;  ///< key = [{...}, ...], else [[key]]
};

/// Interface of code that handles all keys: reading, writing, documenting. A visitor that reads
/// replaces the defaults in the fields by the values of the file; others leave the fields
/// unchanged.
class KeyVisitor {
 public:
  KeyVisitor() = default;
  KeyVisitor(const KeyVisitor&) = delete;
  KeyVisitor& operator=(const KeyVisitor&) = delete;
  virtual ~KeyVisitor() = default;

  virtual void number(const Key& key, const Range& range, double& si) = 0;
  virtual void optionalNumber(const Key& key, const Range& range, std::optional<double>& si) = 0;
  virtual void integer(const Key& key, std::int64_t low, std::int64_t high,
                       std::int64_t& value) = 0;
  virtual void flag(const Key& key, bool& value) = 0;
  virtual void text(const Key& key, const TextRule& rule, std::string& value) = 0;
  /// A visitor that reads sets kUndecided if the value is not one of the choices.
  virtual void choice(const Key& key, std::span<const Choice> choices, int& value) = 0;
  /// key = [low, high]
  virtual void interval(const Key& key, const Range& range, double& low, double& high) = 0;

  /// key = [1, 2]
  virtual void integers(const Key& key, std::int64_t low, std::int64_t high, const ListRule& rule,
                        std::vector<std::int32_t>& values) = 0;
  /// key = ["a", "b"]
  virtual void texts(const Key& key, const TextRule& text_rule, const ListRule& rule,
                     std::vector<std::string>& values) = 0;

  virtual void table(const Key& key, const std::function<void()>& keys) = 0;
  /// key = {...}, if given.
  virtual void inLineTable(const Key& key, bool& given, const std::function<void()>& keys) = 0;
  virtual void list(const Key& key, const ListRule& rule, std::size_t size,
                    const std::function<void(std::size_t size)>& resize,
                    const std::function<void(std::size_t index)>& element) = 0;
  /// [key.NAME] tables.
  virtual void namedTables(const Key& key, const TextRule& name_rule, const ListRule& rule,
                           const std::vector<std::string>& names,
                           const std::function<void(const std::string& name)>& keys) = 0;

  /// All keys of a program of motion (docs/programs.md).
  virtual void program(const std::string& name, const dynamics::WheelLimits& limits,
                       Program& program) = 0;
};

/// The choices that this version accepts: "sim", "serial", "replay".
[[nodiscard]] std::string choiceText(std::span<const Choice> choices);

/// "1 to 250".
[[nodiscard]] std::string countText(const ListRule& rule);

}  // namespace lab::keys
