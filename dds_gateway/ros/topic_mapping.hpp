/// Which topics go out, how often and under which name.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

namespace lab::gateway {

/// What becomes of a topic.
struct Route {
  std::string topic;  ///< ROS 2's name of it
  double rate = 0;    ///< [1/s] at most, 0: all
};

/// Rules in order; the first whose pattern is the whole name of a topic decides. A topic that none
/// names passes as it is. What the rule leaves open comes from the built-in rules: the light field
/// at 5 Hz. No two topics get one name.
class TopicMapping {
 public:
  /// The built-in rules alone.
  TopicMapping();

  /// @param name of the text, for messages
  /// @throws ExperimentError with a line for each problem: file:line: key: found, expected
  TopicMapping(std::string_view text, const std::string& name);

  /// @param topic the gateway's own name, "/lab/robot1/pose"
  /// @return nothing when the topic is denied
  /// @throws std::runtime_error when a rename makes a name that ROS 2 does not take, or one that a
  /// topic asked for before has
  [[nodiscard]] std::optional<Route> route(const std::string& topic);

 private:
  struct Rule {
    std::regex pattern;
    std::string text;  ///< of the pattern, for messages
    bool allow = true;
    std::string rename;  ///< with $1 ..., empty: as it is
    std::string place;   ///< of rename: "m.toml:4: rules[0].rename"
    std::optional<double> rate;
  };
  friend class TopicMappingReader;

  struct Taken {
    std::string by;     ///< the gateway's own name
    std::string place;  ///< of the rule that made it so, empty: none
  };
  void take(const std::string& name, const Taken& wanted);

  std::vector<Rule> rules_;
  std::map<std::string, Taken> taken_;  ///< by ROS 2's name
};

/// @throws ExperimentError also when the file cannot be read.
[[nodiscard]] TopicMapping readTopicMappingFile(const std::filesystem::path& file);

}  // namespace lab::gateway
