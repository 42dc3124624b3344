/// Rules that define which topics pass, at which rate and under which name.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dds_gateway/ros/name_pattern.hpp"

namespace lab::gateway {

/// Name and rate of a topic.
struct Route {
  std::string topic;  ///< its name in ROS 2
  double rate = 0;    ///< [1/s] limit, 0: none
};

/// Rules in order. The first rule whose pattern matches the whole name of a topic decides. A topic
/// without a matching rule passes unchanged. Values that the rule does not set come from the
/// built-in rules: the light field at 5 Hz. Two topics cannot have the same name.
class TopicMapping {
 public:
  static constexpr std::size_t kMostRules = 200;  ///< of a file; compiled they take some 10 MB

  /// Names in all; also names of robots that have gone count.
  static constexpr std::size_t kMostTopics = 100'000;

  /// Only the built-in rules.
  TopicMapping();

  /// @param name name of the file, for error messages
  /// @throws ExperimentError with one line per problem: file:line: key: found, expected
  TopicMapping(std::string_view text, const std::string& name);

  /// @param topic the gateway's own name, "/lab/robot1/pose"
  /// @return nothing if the topic is denied
  /// @throws std::runtime_error if a rename gives a name that ROS 2 does not accept, or the name of
  /// an earlier topic, or for new topics beyond kMostTopics
  [[nodiscard]] std::optional<Route> route(const std::string& topic);

 private:
  struct Rule {
    std::optional<NamePattern> pattern;  ///< always, once it is read
    std::string text;                    ///< of the pattern, for messages
    bool allow = true;
    std::string rename;  ///< with $1 ..., empty: unchanged
    std::string place;   ///< of rename in the file: "m.toml:4: rules[0].rename"
    std::optional<double> rate;
  };
  friend class TopicMappingReader;

  struct Taken {
    std::string by;     ///< the gateway's own name
    std::string place;  ///< of the rule that gave the name, empty: none
  };
  void take(const std::string& name, const Taken& wanted);

  std::vector<Rule> rules_;
  std::map<std::string, Taken> taken_;  ///< by ROS 2's name
};

/// @throws ExperimentError also if the file cannot be read
[[nodiscard]] TopicMapping readTopicMappingFile(const std::filesystem::path& file);

}  // namespace lab::gateway
