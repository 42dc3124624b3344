#include "dds_gateway/ros/topic_mapping.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <set>
#include <stdexcept>

#include "common/experiment/experiment_file.hpp"
#include "common/files/file_problems.hpp"
#include "common/files/file_text.hpp"
#include "common/files/toml_document.hpp"
#include "dds_gateway/ros/ros_names.hpp"

namespace lab::gateway {
namespace {

constexpr std::size_t kMostProblems = 20;
constexpr double kHighestRate = 10000;
constexpr std::int64_t kFileVersion = 1;

// While the light changes, LIGHT_STATUS comes with every frame of the projector, and a grid is
// large.
constexpr const char* kBuiltIn = R"(
fileversion = 1
[[rules]]
topic = "/[A-Za-z0-9_]+/light_field"
rate_hz = 5
)";

}  // namespace

/// Reads the rules of a file and reports all problems.
class TopicMappingReader {
 public:
  TopicMappingReader(std::string_view text, const std::string& name)
      : document_(text, name, {}),
        problems_([this](const std::string& path) { return document_.place(path); }) {}

  std::vector<TopicMapping::Rule> read() {
    checkKeys(document_.root(), "", {"fileversion", "rules"});
    const auto version = document_.root()["fileversion"].value<std::int64_t>();
    if (version != kFileVersion) {
      problems_.add("fileversion", "found " + foundAt(document_.root(), "fileversion") +
                                       ", expected 1: write fileversion = 1");
    }
    std::vector<TopicMapping::Rule> rules;
    if (const toml::node* node = document_.root().get("rules")) {
      const toml::array* array = node->as_array();
      if (array == nullptr || !array->is_homogeneous(toml::node_type::table)) {
        problems_.add("rules", "found " + keys::displayText(*node) + ", expected [[rules]] tables");
      } else if (array->size() > TopicMapping::kMostRules) {
        problems_.add(fmt::format("rules[{}]", TopicMapping::kMostRules),
                      fmt::format("found {} rules, allowed at most {}: one pattern may match many "
                                  "topics",
                                  array->size(), TopicMapping::kMostRules));
      } else {
        for (std::size_t i = 0; i < array->size(); ++i) {
          rules.push_back(readRule(*(*array)[i].as_table(), fmt::format("rules[{}]", i)));
        }
      }
    }
    if (!problems_.empty()) throw ExperimentError(problems_.lines(kMostProblems));
    return rules;
  }

 private:
  static std::string foundAt(const toml::table& table, const std::string& key) {
    const toml::node* node = table.get(key);
    return node == nullptr ? "nothing" : keys::displayText(*node);
  }

  void checkKeys(const toml::table& table, const std::string& path,
                 const std::set<std::string, std::less<>>& known) {
    for (const auto& [key, node] : table) {
      if (known.contains(key.str())) continue;
      std::string expected;
      for (const std::string& name : known) expected += (expected.empty() ? "" : ", ") + name;
      problems_.addAt(document_.place(key, node),
                      (path.empty() ? "" : path + ".") + keys::displayKey(key.str()),
                      "found an unknown key, expected one of " + expected);
    }
  }

  TopicMapping::Rule readRule(const toml::table& table, const std::string& path) {
    checkKeys(table, path, {"topic", "allow", "rename", "rate_hz"});
    TopicMapping::Rule rule;
    readPattern(table, path + ".topic", rule);
    if (const toml::node* node = table.get("allow")) {
      const auto allow = node->value<bool>();
      if (!node->is_boolean() || !allow) {
        problems_.add(path + ".allow",
                      "found " + keys::displayText(*node) + ", expected true or false");
      } else {
        rule.allow = *allow;
      }
    }
    if (const toml::node* node = table.get("rename")) {
      const auto rename = node->value<std::string>();
      if (!rename || rename->empty() || rename->front() != '/') {
        problems_.add(path + ".rename", "found " + keys::displayText(*node) +
                                            ", expected the new name of the topic, as "
                                            "\"/fleet/$1/pose\" ($1: the first group of topic)");
      } else if (const std::string unknown =
                     rule.pattern ? unknownGroup(*rename, rule.pattern->groups()) : "";
                 !unknown.empty()) {
        problems_.add(path + ".rename",
                      fmt::format("found {} in {}, expected $1 to $9: topic has {} groups in (...)",
                                  keys::displayText(std::string_view(unknown)),
                                  keys::displayText(*node), rule.pattern->groups()));
      } else {
        rule.rename = *rename;
        rule.place = document_.place(path + ".rename").text + ": " + path + ".rename";
      }
    }
    if (const toml::node* node = table.get("rate_hz")) {
      const auto rate = node->value<double>();
      if (!rate || !(*rate >= 0 && *rate <= kHighestRate)) {
        problems_.add(path + ".rate_hz",
                      fmt::format("found {}, allowed 0 (every message) to {:g} Hz",
                                  keys::displayText(*node), kHighestRate));
      } else {
        rule.rate = *rate;
      }
    }
    return rule;
  }

  void readPattern(const toml::table& table, const std::string& path, TopicMapping::Rule& rule) {
    const auto text = table["topic"].value<std::string>();
    if (!text || text->empty()) {
      problems_.add(path, "found " + foundAt(table, "topic") +
                              ", expected a regular expression of whole names, as "
                              "\"/lab/robot[0-9]+/odom\"");
      return;
    }
    rule.text = *text;
    try {
      rule.pattern.emplace(*text);
    } catch (const std::invalid_argument& error) {
      problems_.add(path, "found " + keys::displayText(std::string_view(*text)) +
                              ", expected a regular expression (RE2): " + error.what());
    }
  }

  keys::TomlDocument document_;
  keys::Problems problems_;
};

TopicMapping::TopicMapping() : rules_(TopicMappingReader(kBuiltIn, "built-in mapping").read()) {}

TopicMapping::TopicMapping(std::string_view text, const std::string& name)
    : rules_(TopicMappingReader(text, name).read()) {
  for (Rule& rule : TopicMapping().rules_) rules_.push_back(std::move(rule));
}

std::optional<Route> TopicMapping::route(const std::string& topic) {
  Route route{topic, 0};
  std::string place;
  bool decided = false;
  for (const Rule& rule : rules_) {
    if (!rule.pattern->matches(topic)) continue;
    if (!decided) {
      if (!rule.allow) return std::nullopt;
      if (!rule.rename.empty()) {
        route.topic = rule.pattern->expand(rule.rename, topic);
        place = rule.place;
        if (!isTopicName(route.topic)) {
          throw std::runtime_error(fmt::format(
              "gateway.mapping: the rule {} makes \"{}\" of {}, expected a name of ROS 2: parts of "
              "letters, digits and _ after each /, none beginning with a digit, no __",
              rule.text, route.topic, topic));
        }
      }
      decided = true;
    }
    if (rule.rate) {
      route.rate = *rule.rate;
      break;
    }
  }
  take(route.topic, {topic, place});
  return route;
}

void TopicMapping::take(const std::string& name, const Taken& wanted) {
  if (taken_.size() >= kMostTopics && !taken_.contains(name)) {
    throw std::runtime_error(fmt::format(
        "more than {} topics: further ones are not published; end the programs that do not belong "
        "to this lab, then start the gateway again",
        kMostTopics));
  }
  const Taken& owner = taken_.try_emplace(name, wanted).first->second;
  if (owner.by == wanted.by) return;
  throw std::runtime_error(fmt::format(
      "{}: found that {} and {} both become \"{}\", expected a name of its own for each ($1: the "
      "first group of topic)",
      wanted.place.empty() ? owner.place : wanted.place, owner.by, wanted.by, name));
}

TopicMapping readTopicMappingFile(const std::filesystem::path& file) {
  return {readFileText(file, file_kinds::kMapping), file.string()};
}

}  // namespace lab::gateway
