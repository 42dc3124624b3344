#include "robot/language/key_reader.hpp"

#include <cstdint>
#include <utility>

#include "robot/dynamics/byte_code.hpp"
#include "robot/language/expression_checker.hpp"
#include "robot/language/program_names.hpp"

namespace lab::language {
namespace {

/// A draw of a time from a rate.
std::string meanAdvice(const CheckedExpression& found, const Dimension& wanted,
                       const std::string& text) {
  if (found.opcode != dynamics::kExponential || !(found.dimension == quotient(kPure, wanted))) {
    return "";
  }
  const std::size_t open = text.find('(');
  const std::string mean = text.substr(open + 1, text.rfind(')') - open - 1);
  const bool name = isName(mean);
  return "; an exponential draw takes its mean: write exponential(1/" +
         (name ? mean : '(' + mean + ')') + ")";
}

}  // namespace

KeyReader::KeyReader(const ProgramText& text, Suggest suggest) {
  scope.suggest = suggest;
  for (std::size_t i = 0; i < text.phases.size(); ++i) {
    scope.phases[text.phases[i].name] = static_cast<std::uint8_t>(i);
    phase_names_.push_back(text.phases[i].name);
  }
}

std::optional<CheckedExpression> KeyReader::read(const std::string& key, const std::string& text,
                                                 Type wanted) {
  const auto known = syntax_.find(key);
  try {
    if (known == syntax_.end()) {
      syntax_[key] = parseExpression(text);
    }
    std::vector<RangeNote> notes;
    CheckedExpression checked = checkExpression(text, syntax_[key], scope, notes, wanted);
    notes_[key] = std::move(notes);
    return checked;
  } catch (const SyntaxError& problem) {
    error(key, problem.offset(), problem.what());
    return std::nullopt;
  }
}

std::optional<CheckedExpression> KeyReader::readNumber(const std::string& key,
                                                       const std::string& text,
                                                       const Dimension& dimension,
                                                       bool may_be_endless) {
  std::optional<CheckedExpression> checked = read(key, text);
  if (!checked) {
    return std::nullopt;
  }
  if (checked->type != Type::kNumber) {
    error(key, 0, "found a condition or a phase, expected a number in " + unitText(dimension));
    return std::nullopt;
  }
  if (checked->endless && !may_be_endless) {
    error(key, 0, "'forever' can only be a hold");
    return std::nullopt;
  }
  try {
    requireDimension(*checked, dimension, "the value", 0);
  } catch (const SyntaxError& problem) {
    const bool no_unit = checked->dimension == kPure;
    const std::string mean = meanAdvice(*checked, dimension, text);
    advised_ = advised_ || !mean.empty();
    error(key, problem.offset(),
          problem.what() + (no_unit ? "; give it one, as in 3 " + unitText(dimension) : mean));
    return std::nullopt;
  }
  return checked;
}

std::optional<CheckedExpression> KeyReader::readPhase(const std::string& key,
                                                      const std::string& text) {
  std::optional<CheckedExpression> checked = read(key, text, Type::kPhase);
  if (checked && checked->type != Type::kPhase) {
    error(key, 0,
          "found " + std::string(checked->type == Type::kTruth ? "a condition" : "a number") +
              ", expected a phase: " + listed(phase_names_));
    return std::nullopt;
  }
  return checked;
}

}  // namespace lab::language
