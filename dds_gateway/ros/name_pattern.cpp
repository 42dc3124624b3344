#include "dds_gateway/ros/name_pattern.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace lab::gateway {
namespace {

constexpr std::int64_t kMemory_bytes = 64 << 10;  // of a compiled pattern
constexpr std::size_t kLongestError = 200;        // RE2's text may repeat the pattern

re2::RE2::Options options() {
  re2::RE2::Options options;
  options.set_log_errors(false);
  options.set_max_mem(kMemory_bytes);
  return options;
}

/// RE2 limits the compiled pattern, but not what it needs to read the text: 10 kB for each \pL.
std::shared_ptr<const re2::RE2> compiled(const std::string& text) {
  if (text.size() > NamePattern::kLongest) {
    throw std::invalid_argument("of at most " + std::to_string(NamePattern::kLongest) + " bytes");
  }
  auto pattern = std::make_shared<const re2::RE2>(text, options());
  if (!pattern->ok()) throw std::invalid_argument(pattern->error().substr(0, kLongestError));
  return pattern;
}

/// The group that text[at], a $, asks for; 0: none.
std::size_t groupAt(const std::string& text, std::size_t at) {
  const char digit = at + 1 < text.size() ? text[at + 1] : '0';
  return digit >= '1' && digit <= '9' ? static_cast<std::size_t>(digit - '0') : 0;
}

}  // namespace

NamePattern::NamePattern(const std::string& text) : pattern_(compiled(text)) {}

bool NamePattern::matches(const std::string& name) const {
  return re2::RE2::FullMatch(name, *pattern_);
}

std::size_t NamePattern::groups() const {
  return static_cast<std::size_t>(pattern_->NumberOfCapturingGroups());
}

std::string NamePattern::expand(const std::string& text, const std::string& name) const {
  std::vector<std::string> found(groups());
  std::vector<re2::RE2::Arg> arguments;
  for (std::string& group : found) arguments.emplace_back(&group);
  std::vector<const re2::RE2::Arg*> pointers;
  for (const re2::RE2::Arg& argument : arguments) pointers.push_back(&argument);
  re2::RE2::FullMatchN(name, *pattern_, pointers.data(), static_cast<int>(pointers.size()));
  std::string expanded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t group = text[i] == '$' ? groupAt(text, i) : 0;
    if (group == 0 || group > found.size()) {
      expanded += text[i];
    } else {
      expanded += found[group - 1];
      ++i;
    }
  }
  return expanded;
}

std::string unknownGroup(const std::string& text, std::size_t groups) {
  for (std::size_t at = text.find('$'); at != std::string::npos; at = text.find('$', at + 1)) {
    const std::size_t group = groupAt(text, at);
    if (group == 0 || group > groups) return text.substr(at, 2);
  }
  return {};
}

}  // namespace lab::gateway
