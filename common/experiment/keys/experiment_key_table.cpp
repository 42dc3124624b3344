#include "common/experiment/keys/experiment_key_table.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "common/experiment/keys/experiment_keys.hpp"
#include "common/files/file_values.hpp"
#include "common/text/nearest_word.hpp"

namespace lab::keys {
namespace {

struct Row {
  std::string key;
  std::string type;
  std::string default_text;
  std::string allowed;
  std::string meaning;
};

struct Section {
  std::string path;   ///< "light.steps[0]." before the keys in it, empty: the top
  std::string title;  ///< "[[light.steps]]"
  std::string meaning;
  std::vector<Row> rows;
};

class TableCollector final : public KeyVisitor {
 public:
  TableCollector() { sections_.push_back({"", "Top of the file", "", {}}); }

  void number(const Key& key, const Range& range, double& si) override {
    add(key, "number", range.text(), fileText(si, unitOf(key.name)));
  }
  void optionalNumber(const Key& key, const Range& range, std::optional<double>&) override {
    add(key, "number", range.text(), key.default_text);
  }
  void integer(const Key& key, std::int64_t low, std::int64_t high, std::int64_t& value) override {
    const std::string allowed = std::to_string(low) + " to " + std::to_string(high);
    add(key, "integer", low == high ? std::to_string(low) : allowed,
        key.default_text.empty() ? std::to_string(value) : key.default_text);
  }
  void flag(const Key& key, bool& value) override {
    add(key, "boolean", "true, false", value ? "true" : "false");
  }
  void text(const Key& key, const TextRule& rule, std::string& value) override {
    add(key, "text", rule.text(), key.default_text.empty() ? tomlString(value) : key.default_text);
  }
  void choice(const Key& key, std::span<const Choice> choices, int& value) override {
    const auto chosen = std::ranges::find(choices, value, &Choice::value);
    add(key, "text", choiceText(choices),
        chosen == choices.end() ? key.default_text : tomlString(chosen->name));
  }
  void interval(const Key& key, const Range& range, double&, double&) override {
    add(key, "two numbers", range.text(), "");
  }

  void integers(const Key& key, std::int64_t low, std::int64_t high, const ListRule& rule,
                std::vector<std::int32_t>&) override {
    add(key, "list of integers",
        countText(rule) + ", each " + std::to_string(low) + " to " + std::to_string(high),
        key.default_text);
  }
  void texts(const Key& key, const TextRule& text_rule, const ListRule& rule,
             std::vector<std::string>&) override {
    add(key, "list of texts", countText(rule) + ", each " + text_rule.text(), key.default_text);
  }

  void table(const Key& key, const std::function<void()>& keys) override {
    const std::string path = current().path + key.name;
    section(path + ".", "[" + path + "]", key.meaning, keys);
  }
  void inLineTable(const Key& key, bool&, const std::function<void()>& keys) override {
    const std::string path = current().path + key.name;
    add(key, "table", "", key.default_text);
    section(path + ".", path + " = {...}", key.meaning, keys);
  }
  void list(const Key& key, const ListRule& rule, std::size_t,
            const std::function<void(std::size_t)>& resize,
            const std::function<void(std::size_t)>& element) override {
    const std::string path = current().path + key.name;
    if (rule.in_line) add(key, "list of tables", countText(rule), "[]");
    resize(1);
    section(path + "[0].", rule.in_line ? path + " = [{...}, ...]" : "[[" + path + "]]",
            key.meaning + " (" + countText(rule) + ")", [&] { element(0); });
  }
  void namedTables(const Key& key, const TextRule& name_rule, const ListRule& rule,
                   const std::vector<std::string>&,
                   const std::function<void(const std::string&)>& keys) override {
    const std::string path = current().path + key.name + ".NAME";
    section(path + ".", "[" + path + "]",
            key.meaning + ": " + name_rule.text() + "; " + countText(rule) + " tables of this kind",
            [&] { keys("NAME"); });
  }

  void program(const std::string&, const dynamics::WheelLimits&, Program&) override {
    const auto row = [&](const char* key, const char* type, const char* default_text,
                         const char* allowed, const char* meaning) {
      current().rows.push_back({key, type, default_text, allowed, meaning});
    };
    row("model", "text", "-", "a shipped program, or a file: \"my_motion.toml\"",
        "the program of another file, with the parameters below; without it the keys of "
        "[programs](programs.md) define the program here");
    row("parameters", "table of texts", "those of the program", "numbers with their units",
        "{v = \"5 cm/s\"}; with model those that differ");
    row("PARAMETER_UNIT", "number", "-", "-",
        "with model: one parameter, as v_cm_s = 5, eta_rad_s, gamma_per_s, epsilon_s");
    row("description", "text", "that of the model", "-", "free text");
    row("law", "text or table", "none", "-", "the law that the motion follows (programs.md)");
    row("state", "table of texts", "{}", "at most 8", "state variables with their first values");
    row("phases", "tables", "required without model", "1 to 8 tables",
        "[programs.NAME.phases.PHASE]: forward and turn or left and right, hold, next ... "
        "(programs.md)");
  }

  [[nodiscard]] const std::vector<Section>& sections() const { return sections_; }

 private:
  Section& current() { return sections_[current_]; }

  void add(const Key& key, const std::string& type, const std::string& allowed,
           const std::string& default_text) {
    const std::string_view unit = unitOf(key.name).text;
    Row row{key.name, type + (unit.empty() ? "" : ", " + std::string(unit)), default_text, allowed,
            key.meaning};
    if (key.need == Need::kRequired) row.default_text = "required";
    if (!key.condition.empty()) row.meaning += "; only with " + key.condition;
    current().rows.push_back(row);
  }

  template <typename Keys>
  void section(const std::string& path, const std::string& title, const std::string& meaning,
               const Keys& keys) {
    const std::size_t outer = std::exchange(current_, sections_.size());
    sections_.push_back({path, title, meaning, {}});
    std::string& sentence = sections_.back().meaning;
    sentence.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence[0])));
    keys();
    current_ = outer;
  }

  std::vector<Section> sections_;
  std::size_t current_ = 0;
};

std::vector<Section> collectSections() {
  TableCollector collector;
  ExperimentForm form;
  visitKeys(collector, form);
  return collector.sections();
}

}  // namespace

std::string keyTables() {
  std::string text;
  for (const Section& section : collectSections()) {
    text += "### `" + section.title + "`\n\n";
    if (section.path.empty()) text = "### " + section.title + "\n\n";
    if (!section.meaning.empty()) text += section.meaning + ".\n\n";
    text += "| key | type, unit | default | allowed | meaning |\n|---|---|---|---|---|\n";
    for (const Row& row : section.rows) {
      text += "| `" + row.key + "` | " + row.type + " | " + row.default_text + " | " + row.allowed +
              " | " + row.meaning + " |\n";
    }
    text += "\n";
  }
  return text;
}

std::vector<std::string> keyPathsEndingIn(std::string_view name) {
  std::vector<std::string> paths;
  for (const Section& section : collectSections()) {
    for (const Row& row : section.rows) {
      if (row.key == name) paths.push_back(section.path + row.key);
    }
  }
  return paths;
}

std::string nearestKey(std::string_view name, const std::vector<std::string>& names) {
  for (const std::string& candidate : names) {
    if (candidate.starts_with(std::string(name) + "_")) return candidate;  // its unit is missing
  }
  return nearestWord(name, names);
}

std::string keyMeantBy(std::string_view name) {
  std::vector<std::string> top;
  std::vector<std::string> lower;
  for (const Section& section : collectSections()) {
    const bool named = section.path.find("NAME") != std::string::npos;
    for (const Row& row : section.rows) {
      if (section.path.empty()) top.push_back(row.key);
      const bool meant = row.key == name || row.key.starts_with(std::string(name) + "_");
      if (meant && !named) lower.push_back(section.path + row.key);
    }
  }
  const std::string key = nearestKey(name, top);
  const bool exact = key == name || key.starts_with(std::string(name) + "_");
  return exact || lower.empty() ? key : lower.front();
}

}  // namespace lab::keys
