#include "common/experiment/keys/toml_reader.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/experiment/keys/experiment_key_table.hpp"
#include "common/experiment/keys/experiment_keys.hpp"
#include "common/files/file_values.hpp"
#include "common/programs/program_reader.hpp"
#include "common/text/nearest_word.hpp"

namespace lab::keys {
namespace {

class TomlReader final : public KeyVisitor {
 public:
  TomlReader(const TomlDocument& document, const ModelLookup& model_of, const LawCheck& check_law,
             Problems& problems)
      : document_(document),
        model_of_(model_of),
        check_law_(check_law),
        problems_(problems),
        scopes_{{&document.root(), "", {}, {}}} {}

  void number(const Key& key, const Range& range, double& si) override {
    if (const auto value = takeNumber(key, range)) si = toSi(*value, unitOf(key.name));
  }

  void optionalNumber(const Key& key, const Range& range, std::optional<double>& si) override {
    if (const auto value = takeNumber(key, range)) si = toSi(*value, unitOf(key.name));
  }

  void integer(const Key& key, std::int64_t low, std::int64_t high, std::int64_t& value) override {
    std::string allowed = "whole numbers from " + std::to_string(low) + " to ";
    if (low == high) allowed = "only ";
    allowed += std::to_string(high);
    const toml::node* node = take(key, allowed);
    if (node == nullptr) return;
    const auto found = node->value_exact<std::int64_t>();
    if (found && *found >= low && *found <= high) {
      value = *found;
    } else {
      refuse(key, *node, allowed);
    }
  }

  void flag(const Key& key, bool& value) override {
    const toml::node* node = take(key, "true or false");
    if (node == nullptr) return;
    const auto found = node->value_exact<bool>();
    if (found) {
      value = *found;
    } else {
      refuse(key, *node, "true or false");
    }
  }

  void text(const Key& key, const TextRule& rule, std::string& value) override {
    const toml::node* node = take(key, rule.text());
    if (node == nullptr) return;
    const auto found = node->value_exact<std::string>();
    if (found && rule.accepts(*found)) {
      value = *found;
    } else {
      refuse(key, *node, rule.text());
    }
  }

  void choice(const Key& key, std::span<const Choice> choices, int& value) override {
    const toml::node* node = take(key, choiceText(choices));
    if (node == nullptr) {
      if (key.need == Need::kRequired) value = kUndecided;
      return;
    }
    const auto found = node->value_exact<std::string>();
    const auto choice = std::ranges::find(choices, found.value_or(""), &Choice::name);
    const bool known = found.has_value() && choice != choices.end();
    if (known && choice->refusal.empty()) {
      value = choice->value;
      return;
    }
    value = kUndecided;
    refuse(key, *node, choiceText(choices) + (known ? choice->refusal : meantBy(found, choices)));
  }

  void interval(const Key& key, const Range& range, double& low, double& high) override {
    const std::string allowed = "[low, high], two numbers " + range.text();
    const toml::node* node = take(key, allowed);
    if (node == nullptr) return;
    const toml::array* ends = node->as_array();
    if (ends == nullptr || ends->size() != 2) {
      const std::string found =
          ends == nullptr ? displayText(*node) : "a list of " + std::to_string(ends->size());
      problems_.addAt(document_.place(*node), pathOf(key.name),
                      "found " + found + ", allowed " + allowed);
      return;
    }
    low = endOf(key, range, *ends, 0).value_or(low);
    high = endOf(key, range, *ends, 1).value_or(high);
  }

  void integers(const Key& key, std::int64_t low, std::int64_t high, const ListRule& rule,
                std::vector<std::int32_t>& values) override {
    const std::string one =
        "whole numbers from " + std::to_string(low) + " to " + std::to_string(high);
    takeAll(key, rule, one, "[1, 2]", values, [&](const toml::node& node, std::int32_t& value) {
      const auto found = node.value_exact<std::int64_t>();
      if (!found || *found < low || *found > high) return false;
      value = static_cast<std::int32_t>(*found);
      return true;
    });
  }

  void texts(const Key& key, const TextRule& text_rule, const ListRule& rule,
             std::vector<std::string>& values) override {
    takeAll(key, rule, text_rule.text(), "[\"...\", \"...\"]", values,
            [&](const toml::node& node, std::string& value) {
              const auto found = node.value_exact<std::string>();
              if (!found || !text_rule.accepts(*found)) return false;
              value = *found;
              return true;
            });
  }

  void table(const Key& key, const std::function<void()>& keys) override {
    const std::string allowed = "a table: [" + pathOf(key.name) + "]";
    const toml::node* node = take(key, allowed);
    if (node != nullptr && !node->is_table()) {
      refuse(key, *node, allowed);
      return;
    }
    if (node != nullptr) inside(*node->as_table(), pathOf(key.name), keys);
  }

  void inLineTable(const Key& key, bool& given, const std::function<void()>& keys) override {
    const std::string allowed = "a table: " + key.name + " = {...}";
    const toml::node* node = take(key, allowed);
    if (node == nullptr) return;
    if (!node->is_table()) {
      refuse(key, *node, allowed);
      return;
    }
    given = true;
    inside(*node->as_table(), pathOf(key.name), keys);
  }
  void list(const Key& key, const ListRule& rule, std::size_t,
            const std::function<void(std::size_t)>& resize,
            const std::function<void(std::size_t)>& element) override {
    const std::string path = pathOf(key.name);
    const std::string allowed = countText(rule);
    const std::string form = rule.in_line ? key.name + " = [{...}, {...}]" : "[[" + path + "]]";
    const toml::node* node = take(key, allowed + " " + form);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    if (array == nullptr) {
      refuse(key, *node, allowed + " " + form);
      return;
    }
    if (array->size() < rule.fewest || array->size() > rule.most) {
      problems_.addAt(document_.place(*node), path,
                      "found " + std::to_string(array->size()) + ", allowed " + allowed);
      return;
    }
    resize(array->size());
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::node& item = *array->get(i);
      const std::string item_path = path + "[" + std::to_string(i) + "]";
      if (item.is_table()) {
        inside(*item.as_table(), item_path, [&] { element(i); });
      } else {
        problems_.addAt(document_.place(item), item_path,
                        "found " + displayText(item) + ", allowed a table: " + form);
      }
    }
  }

  void namedTables(const Key& key, const TextRule& name_rule, const ListRule& rule,
                   const std::vector<std::string>&,
                   const std::function<void(const std::string&)>& keys) override {
    const std::string path = pathOf(key.name);
    const std::string form = "[" + path + ".NAME]";
    const std::string allowed = countText(rule) + " " + form;
    const toml::node* node = take(key, allowed);
    if (node == nullptr) return;
    const toml::table* tables = node->as_table();
    if (tables == nullptr || tables->size() < rule.fewest || tables->size() > rule.most) {
      const std::string found = tables ? std::to_string(tables->size()) : displayText(*node);
      problems_.addAt(document_.place(*node), path, "found " + found + ", allowed " + allowed);
      return;
    }
    for (const auto& [name_key, item] : *tables) {
      const std::string name(name_key.str());
      const std::string item_path = path + "." + displayKey(name);
      if (!name_rule.accepts(name)) {
        problems_.addAt(document_.place(name_key, item), item_path,
                        "found the name " + displayText(name) + ", allowed " + name_rule.text());
      } else if (!item.is_table()) {
        problems_.addAt(document_.place(item), item_path,
                        "found " + displayText(item) + ", allowed a table: [" + item_path + "]");
      } else {
        inside(*item.as_table(), item_path, [&] { keys(name); });
      }
    }
  }

  void program(const std::string& name, const dynamics::WheelLimits& limits,
               Program& program) override {
    Scope& scope = scopes_.back();
    for (const auto& [key, node] : *scope.table) scope.known.emplace_back(key.str());
    program = toProgram(readProgramTable(document_, *scope.table, scope.path, name,
                                         {limits, model_of_, check_law_}, problems_));
  }

  /// Call this after all keys have been visited.
  void finish() { refuseUnknownKeys(); }

 private:
  struct Scope {
    const toml::table* table;
    std::string path;
    std::vector<std::string> known;    ///< keys of this table
    std::vector<std::string> allowed;  ///< those of them that are allowed here
  };

  [[nodiscard]] std::string pathOf(const std::string& name) const {
    return scopes_.back().path.empty() ? name : scopes_.back().path + "." + name;
  }

  /// The key's value, or null if it is missing or not allowed here.
  const toml::node* take(const Key& key, const std::string& allowed) {
    Scope& scope = scopes_.back();
    const toml::node* node = scope.table->get(key.name);
    scope.known.push_back(key.name);
    if (key.applies == Applies::kUndecided) return nullptr;
    if (key.applies == Applies::kNo) {
      if (node != nullptr) refuse(key, *node, "only with " + key.condition);
      return nullptr;
    }
    scope.allowed.push_back(key.name);
    if (node == nullptr && key.need == Need::kRequired) {
      problems_.addAt(document_.place(*scope.table), pathOf(key.name),
                      "found nothing, allowed " + allowed + " (required: " + key.meaning + ")");
    }
    return node;
  }

  /// Reads a list with `read`, which accepts or refuses each element. If one is refused, the list
  /// keeps its values.
  template <typename Element, typename Read>
  void takeAll(const Key& key, const ListRule& rule, const std::string& one, const char* form,
               std::vector<Element>& values, const Read& read) {
    const std::string allowed = countText(rule) + ", as " + key.name + " = " + form;
    const toml::node* node = take(key, allowed);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    if (array == nullptr || array->size() < rule.fewest || array->size() > rule.most) {
      const std::string found =
          array == nullptr ? displayText(*node) : "a list of " + std::to_string(array->size());
      problems_.addAt(document_.place(*node), pathOf(key.name),
                      "found " + found + ", allowed " + allowed);
      return;
    }
    std::vector<Element> all(array->size());
    bool fine = true;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const toml::node& item = *array->get(i);
      if (read(item, all[i])) continue;
      fine = false;
      problems_.addAt(document_.place(item), pathOf(key.name) + "[" + std::to_string(i) + "]",
                      "found " + displayText(item) + ", allowed " + one);
    }
    if (fine) values = std::move(all);
  }

  std::optional<double> takeNumber(const Key& key, const Range& range) {
    const toml::node* node = take(key, range.text());
    if (node == nullptr) return {};
    const auto value = node->value<double>();
    if (node->is_number() && range.contains(*value)) return value;
    refuse(key, *node, (node->is_number() ? "" : "numbers: ") + range.text());
    return {};
  }

  std::optional<double> endOf(const Key& key, const Range& range, const toml::array& ends,
                              std::size_t index) {
    const toml::node& node = *ends.get(index);
    const auto value = node.value<double>();
    if (node.is_number() && range.contains(*value)) return toSi(*value, unitOf(key.name));
    problems_.addAt(document_.place(node), pathOf(key.name) + "[" + std::to_string(index) + "]",
                    "found " + displayText(node) + ", allowed " + range.text());
    return {};
  }

  void refuse(const Key& key, const toml::node& node, const std::string& allowed) {
    problems_.addAt(document_.place(node), pathOf(key.name),
                    "found " + displayText(node) + ", allowed " + allowed);
  }

  template <typename Keys>
  void inside(const toml::table& table, const std::string& path, const Keys& keys) {
    scopes_.push_back({&table, path, {}, {}});
    keys();
    refuseUnknownKeys();
    scopes_.pop_back();
  }

  void refuseUnknownKeys() {
    const Scope& scope = scopes_.back();
    for (const auto& [key, node] : *scope.table) {
      const std::string name(key.str());
      if (std::ranges::find(scope.known, name) != scope.known.end()) continue;
      std::string path = scope.path.empty() ? "" : scope.path + ".";
      path += displayKey(name);
      problems_.addAt(document_.place(key, node), path,
                      "found an unknown key, " + wayOut(name, scope.allowed));
    }
  }

  /// "; did you mean X?" for a text that is none of the choices.
  static std::string meantBy(const std::optional<std::string>& found,
                             std::span<const Choice> choices) {
    std::vector<std::string> names;
    for (const Choice& choice : choices) {
      if (choice.refusal.empty()) names.emplace_back(choice.name);
    }
    return found ? didYouMean(*found, names, tomlString) : "";
  }

  static std::string wayOut(const std::string& name, const std::vector<std::string>& allowed) {
    const std::string near = nearestKey(name, allowed);
    if (!near.empty()) return "allowed here is " + near;
    const std::vector<std::string> elsewhere = keyPathsEndingIn(name);
    if (!elsewhere.empty()) return "allowed is " + elsewhere.front();
    std::string list;
    for (const std::string& key : allowed) list += (list.empty() ? "" : ", ") + key;
    return "allowed here: " + list;
  }

  const TomlDocument& document_;
  const ModelLookup& model_of_;
  const LawCheck& check_law_;
  Problems& problems_;
  std::vector<Scope> scopes_;
};

}  // namespace

ExperimentForm readForm(const TomlDocument& document, const ModelLookup& model_of,
                        const LawCheck& check_law, Problems& problems) {
  ExperimentForm form;
  TomlReader reader(document, model_of, check_law, problems);
  visitKeys(reader, form);
  reader.finish();
  return form;
}

}  // namespace lab::keys
