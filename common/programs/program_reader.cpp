#include "common/programs/program_reader.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "common/files/experiment_error.hpp"
#include "common/files/file_values.hpp"
#include "common/programs/parameter_keys.hpp"
#include "common/programs/shipped_programs.hpp"
#include "common/text/nearest_word.hpp"

namespace lab {
namespace {

using keys::displayText;

const std::vector<std::string> kKeys{"description", "law", "parameters", "state", "phases"};

/// Reads the texts of a program and remembers where each was written.
class ProgramReader {
 public:
  ProgramReader(const keys::TomlDocument& document, const toml::table& table, std::string path,
                keys::Problems& problems)
      : document_(document), table_(table), path_(std::move(path)), problems_(problems) {}

  ProgramFile read(const std::string& name, const ProgramContext& context) {
    const ModelLookup& model_of = context.model_of;
    ProgramFile program;
    program.text.name = name;
    const char* const experiment = table_.contains("fileversion") ? "fileversion" : "programs";
    if (!model_of && table_.contains(experiment) && !table_.contains("phases")) {
      places_[experiment] = table_.get(experiment);
      problem(experiment,
              "found an experiment file, allowed the file of one program of motion "
              "(docs/programs.md); an experiment is checked with its programs by ./lab check " +
                  document_.file());
      return program;
    }
    if (model_of && table_.contains("model")) {
      readModel(model_of, program.text);
    } else if (model_of && !table_.contains("phases")) {
      problem("", "found neither model nor phases, allowed a model (" + models() +
                      ") or the phases of a program (docs/programs.md)" + misspeltModel());
    } else {
      std::vector<std::string> allowed = kKeys;
      if (model_of) allowed.emplace_back("model");
      readTable(table_, "", allowed, [&](const std::string& key, const toml::node& node) {
        readKey(key, node, program.text);
      });
    }
    program.text.name = name;
    if (failed_) return program;
    // Before it is compiled: the time of that grows with the square of the number of names.
    if (const std::size_t size = programToml(program.text).size(); size > kLongestProgramText) {
      problem("", "found a text of " + std::to_string(size) + " bytes, allowed at most " +
                      std::to_string(kLongestProgramText) +
                      ": shorten the description or the names");
      return program;
    }
    program.compiled = language::compile(program.text, context.limits, meant);
    if (!unitsAreThoseOfTheModel(program.compiled)) return program;
    report(program.compiled.errors, name);
    if (program.compiled.ok() && context.check_law) {
      report(context.check_law(program.text, program.compiled), name);
    }
    return program;
  }

 private:
  /// The key that was meant to be `model` or `phases`, if one looks like it.
  [[nodiscard]] std::string misspeltModel() const {
    for (const auto& [key, node] : table_) {
      const std::string meant_key = didYouMean(key.str(), {"model", "phases"});
      if (!meant_key.empty()) return "; found " + std::string(key.str()) + meant_key;
    }
    return "";
  }

  static std::string meant(std::string_view word, const std::vector<std::string>& words) {
    return didYouMean(word, words);
  }

  void report(const std::vector<language::Problem>& found, const std::string& name) {
    for (const language::Problem& problem : found) {
      std::string shown = problem.key.empty() && path_.empty() ? name : problem.key;
      // law = "NAME" has no key law.name.
      if (shown == "law.name" && !places_.contains(shown)) shown = "law";
      problems_.addAt(place(problem.key, problem.offset), shownPath(shown), problem.message);
    }
  }

  /// The path of a key in the document.
  [[nodiscard]] std::string shownPath(const std::string& key) const {
    return key.empty() || path_.empty() ? path_ + key : path_ + "." + key;
  }

  void problem(const std::string& key, const std::string& message) {
    failed_ = true;
    problems_.addAt(place(key, 0), shownPath(key), message);
  }

  /// The place of a character in the text of a key, or of what contains the key.
  [[nodiscard]] keys::FileLocation place(std::string key, std::size_t offset) const {
    while (!key.empty() && places_.find(key) == places_.end()) {
      const std::size_t dot = key.rfind('.');
      key.erase(dot == std::string::npos ? 0 : dot);
      offset = 0;
    }
    const auto found = places_.find(key);
    const toml::node& node = found == places_.end() ? table_ : *found->second;
    if (found == places_.end()) offset = 0;
    keys::FileLocation at = document_.place(node);
    // The text begins after its quote. The text of an override has no line.
    const std::size_t column = node.source().begin.column + (node.is_string() ? 1U : 0U) + offset;
    if (at.line != 0) at.text += ":" + std::to_string(column);
    return at;
  }

  void readKey(const std::string& key, const toml::node& node, language::ProgramText& program) {
    if (key == "description") {
      program.description = textOf(node, key).value_or("");
    } else if (key == "phases") {
      readPhases(node, program);
    } else if (key == "law") {
      readLaw(node, program);
    } else {
      readNamed(node, key, key == "state" ? program.state : program.parameters);
    }
  }

  void readLaw(const toml::node& node, language::ProgramText& program) {
    program.law.clear();
    if (const auto name = node.value_exact<std::string>()) {
      program.law.emplace_back("name", *name);
    } else if (node.is_table()) {
      readNamed(node, "law", program.law);
      if (program.law.empty()) {
        problem("law", "found an empty table, allowed a name or formulas (docs/programs.md)");
      }
    } else {
      problem("law", "found " + displayText(node) +
                         ", allowed the name of a closed form, or a table (docs/programs.md)");
    }
  }

  static std::string models() {
    std::string all;
    for (const std::string& name : shippedProgramNames()) all += (all.empty() ? "" : ", ") + name;
    return "a file (\"my_motion.toml\") or the name of a shipped program: " + all;
  }

  /// Another program with other values of its parameters.
  void readModel(const ModelLookup& model_of, language::ProgramText& program) {
    const toml::node& node = *table_.get("model");
    places_["model"] = &node;
    const std::string model = textOf(node, "model").value_or("");
    if (failed_) return;
    std::optional<language::ProgramText> found = model_of(model);
    if (!found) {
      constexpr std::string_view kToml = ".toml";
      const bool file = model.ends_with(kToml);
      const std::string name = model.substr(0, model.size() - (file ? kToml.size() : 0));
      problem("model", "found " + displayText(std::string_view(model)) +
                           (file ? " (no such file)" : "") + ", allowed " + models() +
                           didYouMean(name, shippedProgramNames(), keys::tomlString));
      return;
    }
    program = std::move(*found);
    model_ = language::compile(program, kWidestWheels).parameters;
    readTable(table_, "", {}, [&](const std::string& key, const toml::node& value) {
      if (key == "model") return;
      if (key == "description") {
        program.description = textOf(value, key).value_or("");
      } else if (key == "parameters") {
        std::vector<language::NamedText> changes;
        readNamed(value, key, changes);
        for (const auto& [name, text] : changes) change(program, "parameters." + name, name, text);
      } else if (!readNumberKey(key, value, program)) {
        refuseBesideModel(key, model, program);
      }
    });
  }

  void refuseBesideModel(const std::string& key, const std::string& model,
                         const language::ProgramText& program) {
    std::string allowed = "allowed with model = \"" + model + "\": description, parameters";
    std::vector<std::string> names{"description", "parameters"};
    for (const auto& [name, text] : program.parameters) {
      const std::string keys = keysOf(name, program);
      allowed += (names.size() == 2 ? "; or a parameter with its unit: " : ", ") +
                 keys.substr(0, keys.find_first_of(", "));
      names.push_back(keys.substr(0, keys.find_first_of(", ")));
    }
    if (std::ranges::find(kKeys, key) == kKeys.end()) {
      problem(key, "found an unknown key, " + allowed + didYouMean(key, names));
      return;
    }
    const std::string copy = model.ends_with(".toml") ? "change it in " + model
                                                      : "copy its text into this file (./lab "
                                                        "program show " +
                                                            model + ")";
    problem(key, "found " + key + " beside model, which brings its own; to change it, " + copy +
                     "; " + allowed);
  }

  /// The keys of a parameter, by the model's unit.
  [[nodiscard]] std::string keysOf(const std::string& name,
                                   const language::ProgramText& program) const {
    const auto known = std::ranges::find(model_, name, &language::Parameter::name);
    const auto text = std::ranges::find(program.parameters, name, &language::NamedText::first);
    if (known == model_.end() || text == program.parameters.end()) return name;
    const bool angle = text->second.find("rad") != std::string::npos ||
                       text->second.find("deg") != std::string::npos;
    return keysOfParameter(name, known->dimension, angle);
  }

  /// "v_cm_s = 5" means v = "5 cm/s". False: no parameter begins like the key.
  bool readNumberKey(const std::string& key, const toml::node& node,
                     language::ProgramText& program) {
    auto parameter = program.parameters.end();
    for (auto one = program.parameters.begin(); one != program.parameters.end(); ++one) {
      const bool begins = key == one->first || key.starts_with(one->first + "_");
      const bool longer =
          parameter == program.parameters.end() || one->first.size() > parameter->first.size();
      if (begins && longer) parameter = one;
    }
    if (parameter == program.parameters.end()) return false;
    const std::string name = parameter->first;
    const auto unit = unitOfSuffix(key.substr(std::min(key.size(), name.size() + 1)));
    const auto known = std::ranges::find(model_, name, &language::Parameter::name);
    if (known == model_.end()) return false;
    const std::string allowed = ", allowed for " + name + ": " + keysOf(name, program) +
                                ", or a text with its unit in parameters";
    const auto value = node.value<double>();
    if (!unit) {
      problem(key, "found an unknown unit" + allowed);
    } else if (!node.is_number() || !value || !std::isfinite(*value)) {
      problem(key,
              "found " + displayText(node) + ", allowed a number" +
                  (unit->text.empty() ? "" : " in " + unit->text) +
                  (node.is_string() ? ", or parameters = {" + name + " = " + displayText(node) + "}"
                                    : ""));
    } else if (!(unit->dimension == known->dimension)) {
      problem(key, "found " + numberOf(unit->dimension) + allowed);
    } else {
      parameter->second = keys::numberText(*value) + (unit->text.empty() ? "" : " " + unit->text);
      places_["parameters." + name] = &node;
    }
    return true;
  }

  /// Reports parameters of another dimension than the model has.
  bool unitsAreThoseOfTheModel(const language::CompiledProgram& compiled) {
    bool fine = true;
    for (const language::Parameter& parameter : compiled.parameters) {
      const auto known = std::ranges::find(model_, parameter.name, &language::Parameter::name);
      if (known == model_.end() || known->dimension == parameter.dimension) continue;
      if (!places_.contains("parameters." + parameter.name)) continue;  // follows from another one
      problem("parameters." + parameter.name, "found " + numberOf(parameter.dimension) +
                                                  ", allowed " + numberOf(known->dimension) +
                                                  ", as the model has");
      fine = false;
    }
    return fine;
  }

  void change(language::ProgramText& program, const std::string& key, const std::string& name,
              const std::string& text) {
    const auto parameter = std::ranges::find(program.parameters, name, &language::NamedText::first);
    if (parameter != program.parameters.end()) {
      parameter->second = text;
      return;
    }
    std::vector<std::string> names;
    for (const auto& [known, value] : program.parameters) names.push_back(known);
    std::string all;
    for (const std::string& known : names) all += (all.empty() ? "" : ", ") + known;
    problem(key, "found an unknown parameter, allowed: " + all + didYouMean(name, names));
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
      places_[key_path] = node;
      if (!allowed.empty() && std::ranges::find(allowed, key) == allowed.end()) {
        std::string all;
        for (const std::string& one : allowed) all += (all.empty() ? "" : ", ") + one;
        problem(key_path, "found an unknown key, allowed here: " + all + didYouMean(key, allowed));
        continue;
      }
      take(key, *node);
    }
  }

  /// Nothing if it is no text, which is then reported.
  std::optional<std::string> textOf(const toml::node& node, const std::string& path) {
    if (auto text = node.value_exact<std::string>()) return text;
    const bool number = node.is_number();
    problem(path, "found " + displayText(node) + ", allowed a text" +
                      (number ? ": \"" + displayText(node) + "\", with its unit if it has one"
                              : " in quotes"));
    return std::nullopt;
  }

  const toml::table* tableOf(const toml::node& node, const std::string& path) {
    if (!node.is_table()) {
      problem(path, "found " + displayText(node) + ", allowed a table: " + path + " = {...}");
    }
    return node.as_table();
  }

  void readNamed(const toml::node& node, const std::string& path,
                 std::vector<language::NamedText>& texts) {
    const toml::table* table = tableOf(node, path);
    if (table == nullptr) return;
    readTable(*table, path, {}, [&](const std::string& key, const toml::node& value) {
      texts.emplace_back(key, textOf(value, path + "." + key).value_or(""));
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
                const std::optional<std::string> text = textOf(node, key_path);
                phase.*texts.at(key) = text.value_or("");
                if (text == "") problem(key_path, "found an empty text, allowed an expression");
              });
  }

  const keys::TomlDocument& document_;
  const toml::table& table_;
  const std::string path_;
  std::vector<language::Parameter> model_;  ///< The parameters of the model, if there is one.
  std::map<std::string, const toml::node*> places_;  ///< by key
  keys::Problems& problems_;
  bool failed_ = false;
};

}  // namespace

ProgramFile readProgramTable(const keys::TomlDocument& document, const toml::table& table,
                             const std::string& path, const std::string& name,
                             const ProgramContext& context, keys::Problems& problems) {
  return ProgramReader(document, table, path, problems).read(name, context);
}

}  // namespace lab
