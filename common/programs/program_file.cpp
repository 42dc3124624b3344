#include "common/programs/program_file.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "common/files/experiment_error.hpp"
#include "common/files/file_problems.hpp"
#include "common/files/toml_document.hpp"
#include "common/text/nearest_word.hpp"

namespace lab {
namespace {

using keys::displayText;

constexpr std::size_t kMostProblems = 20;

/// Reads the texts of a program and remembers where each was written.
class ProgramReader {
 public:
  ProgramReader(std::string_view text, const std::string& file)
      : file_(file),
        document_(text, file, {}),
        problems_([this](const std::string& path) { return place(path, 0); }) {}

  ProgramFile read(const std::string& name, const dynamics::WheelLimits& limits) {
    ProgramFile program;
    program.text.name = name;
    readTable(document_.root(), "", {"description", "parameters", "state", "phases"},
              [&](const std::string& key, const toml::node& node) {
                if (key == "description") {
                  program.text.description = textOf(node, key);
                } else if (key == "phases") {
                  readPhases(node, program.text);
                } else {
                  readNamed(node, key,
                            key == "state" ? program.text.state : program.text.parameters);
                }
              });
    stopAtProblems();
    program.compiled = language::compile(program.text, limits);
    for (const language::Problem& problem : program.compiled.errors) {
      const std::string path = problem.key.empty() ? name : problem.key;
      problems_.addAt(place(problem.key, problem.offset), path, problem.message);
    }
    stopAtProblems();
    return program;
  }

 private:
  struct Place {
    std::size_t line = 1;
    std::size_t column = 1;
  };

  void stopAtProblems() const {
    if (!problems_.empty()) throw ExperimentError(problems_.lines(kMostProblems));
  }

  /// The place of a character in the text of a key, or of what contains the key.
  [[nodiscard]] keys::FileLocation place(std::string path, std::size_t offset) const {
    while (!path.empty() && places_.find(path) == places_.end()) {
      const std::size_t dot = path.rfind('.');
      path.erase(dot == std::string::npos ? 0 : dot);
      offset = 0;
    }
    const auto found = places_.find(path);
    const Place at = found == places_.end() ? Place() : found->second;
    const std::size_t column = at.column + offset;
    return {file_ + ":" + std::to_string(at.line) + ":" + std::to_string(column), at.line};
  }

  void remember(const std::string& path, const toml::node& node) {
    const toml::source_position begin = node.source().begin;
    // The text begins after its quote.
    places_[path] = {begin.line, begin.column + (node.is_string() ? 1U : 0U)};
  }

  template <typename Take>
  void readTable(const toml::table& table, const std::string& path,
                 const std::vector<std::string>& allowed, const Take& take) {
    std::vector<std::pair<std::string, const toml::node*>> entries;
    for (const auto& [key, node] : table) {
      entries.emplace_back(key.str(), &node);
    }
    // TOML tables have no order, but draws and phases do: that of the file.
    std::ranges::stable_sort(entries, {}, [](const auto& entry) {
      const toml::source_position begin = entry.second->source().begin;
      return std::pair(begin.line, begin.column);
    });
    for (const auto& [key, node] : entries) {
      const std::string key_path = path.empty() ? key : path + "." + key;
      remember(key_path, *node);
      if (!allowed.empty() && std::ranges::find(allowed, key) == allowed.end()) {
        std::string all;
        for (const std::string& one : allowed) all += (all.empty() ? "" : ", ") + one;
        problems_.add(key_path,
                      "found an unknown key, allowed here: " + all + didYouMean(key, allowed));
        continue;
      }
      take(key, *node);
    }
  }

  std::string textOf(const toml::node& node, const std::string& path) {
    if (const auto text = node.value_exact<std::string>()) return *text;
    const bool number = node.is_number();
    problems_.add(path, "found " + displayText(node) + ", allowed a text" +
                            (number ? ": \"" + displayText(node) + "\", with its unit if it has one"
                                    : " in quotes"));
    return "";
  }

  const toml::table* tableOf(const toml::node& node, const std::string& path) {
    if (!node.is_table()) {
      problems_.add(path, "found " + displayText(node) + ", allowed a table: " + path + " = {...}");
    }
    return node.as_table();
  }

  void readNamed(const toml::node& node, const std::string& path,
                 std::vector<language::NamedText>& texts) {
    const toml::table* table = tableOf(node, path);
    if (table == nullptr) return;
    readTable(*table, path, {}, [&](const std::string& key, const toml::node& value) {
      texts.emplace_back(key, textOf(value, path + "." + key));
    });
  }

  void readPhases(const toml::node& node, language::ProgramText& program) {
    const toml::table* phases = tableOf(node, "phases");
    if (phases == nullptr) return;
    readTable(*phases, "phases", {}, [&](const std::string& name, const toml::node& phase) {
      const std::string path = "phases." + name;
      program.phases.emplace_back();
      program.phases.back().name = name;
      if (const toml::table* table = tableOf(phase, path)) {
        readPhase(*table, path, program.phases.back());
      }
    });
  }

  void readPhase(const toml::table& table, const std::string& path, language::PhaseText& phase) {
    const std::map<std::string, std::string language::PhaseText::*> texts{
        {"forward", &language::PhaseText::forward}, {"turn", &language::PhaseText::turn},
        {"left", &language::PhaseText::left},       {"right", &language::PhaseText::right},
        {"hold", &language::PhaseText::hold},       {"next", &language::PhaseText::next},
        {"until", &language::PhaseText::until},     {"then", &language::PhaseText::then}};
    readTable(table, path,
              {"set", "forward", "turn", "left", "right", "hold", "next", "until", "then"},
              [&](const std::string& key, const toml::node& node) {
                const std::string key_path = path + "." + key;
                if (key == "set") {
                  readNamed(node, key_path, phase.set);
                  return;
                }
                std::string& text = phase.*texts.at(key);
                text = textOf(node, key_path);
                if (text.empty())
                  problems_.add(key_path, "found an empty text, allowed an expression");
              });
  }

  const std::string& file_;
  keys::TomlDocument document_;
  std::map<std::string, Place> places_;
  keys::Problems problems_;
};

}  // namespace

ProgramFile readProgram(std::string_view text, const std::string& file, const std::string& name,
                        const dynamics::WheelLimits& limits) {
  return ProgramReader(text, file).read(name, limits);
}

}  // namespace lab
