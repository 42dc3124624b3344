#include "dds_gateway/ros/ros_names.hpp"

namespace lab::gateway {
namespace {

bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isNameCharacter(char c) {
  return isDigit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

}  // namespace

bool isTopicName(std::string_view name) {
  if (name.size() < 2 || name.size() > kLongestTopicName || name.front() != '/') return false;
  char before = 0;
  for (const char c : name) {
    if (c != '/' && !isNameCharacter(c)) return false;
    if (before == '/' && (c == '/' || isDigit(c))) return false;
    if (before == '_' && c == '_') return false;
    before = c;
  }
  return before != '/';
}

std::string namePart(std::string_view text) {
  std::string part;
  for (const char c : text) {
    const char kept = isNameCharacter(c) ? c : '_';
    const bool again = kept == '_' && !part.empty() && part.back() == '_';
    if (!again) part += kept;
  }
  if (part.empty()) part = "_";
  return isDigit(part.front()) ? "_" + part : part;
}

std::string robotName(std::int32_t id) { return "robot" + std::to_string(id); }

std::string RosNames::topic(std::string_view what) const {
  return "/" + lab_ + "/" + std::string(what);
}

std::string RosNames::topic(std::int32_t robot, std::string_view what) const {
  return "/" + lab_ + "/" + robotName(robot) + "/" + std::string(what);
}

}  // namespace lab::gateway
