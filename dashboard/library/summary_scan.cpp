#include "dashboard/library/summary_scan.hpp"

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "common/math/saturated.hpp"

namespace lab::dashboard {
namespace {

/// Keeps the current position in the document as a path: "/programs[]/pool/max_z".
class Scanner final : public nlohmann::json_sax<nlohmann::json> {
 public:
  [[nodiscard]] SummaryFacts& facts() { return facts_; }
  [[nodiscard]] bool isSummary() const { return format_; }

  bool null() override { return goesOn(); }
  bool boolean(bool value) override {
    if (!isDeep() && isInProgram() && path_ == "/programs[]/pool/restricted") {
      facts_.programs.back().restricted = value;
    }
    return goesOn();
  }
  bool number_integer(number_integer_t value) override {
    return number(static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return number(static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t&) override { return number(value); }
  bool binary(binary_t&) override { return true; }

  bool string(string_t& value) override {
    if (isDeep()) return goesOn();
    std::string* kept = nullptr;
    if (path_ == "/experiment") kept = &facts_.experiment;
    if (isInProgram() && path_ == "/programs[]/name") kept = &facts_.programs.back().name;
    if (isInProgram() && path_ == "/programs[]/pool/verdict") {
      kept = &facts_.programs.back().verdict;
    }
    if (kept == nullptr) return goesOn();
    *kept = value;
    return goesOn() && value.size() <= kLongestText;
  }

  bool start_object(std::size_t) override {
    ends_.push_back(path_.size());
    if (path_ == "/programs[]") facts_.programs.emplace_back();
    if (facts_.programs.size() > kMostPrograms) return false;
    if (path_ == "/faults[]") ++facts_.faults;
    return goesOn() && ends_.size() <= kDeepest;
  }
  bool key(string_t& name) override {
    path_.resize(ends_.back());
    path_.append("/").append(name);
    return true;
  }
  bool end_object() override { return leave(); }
  bool start_array(std::size_t) override {
    ends_.push_back(path_.size());
    path_ += "[]";
    return goesOn() && ends_.size() <= kDeepest;
  }
  bool end_array() override { return leave(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  /// The numbers of the curves, which are most of the file, are at deeper levels than all facts.
  [[nodiscard]] bool isDeep() const { return ends_.size() > 4; }
  [[nodiscard]] bool isInProgram() const { return !facts_.programs.empty(); }

  /// The summary of a large run has a million numbers; one of many more is none of this lab.
  bool goesOn() { return ++values_ < kMostValues; }

  bool number(double value) {
    if (isDeep()) return goesOn();
    if (path_ == "/format") format_ = true;
    if (path_ == "/duration_s") facts_.duration_s = value;
    if (path_ == "/losses/log[]/lost")
      facts_.lost = saturated<std::int64_t>(static_cast<double>(facts_.lost) + value);
    if (isInProgram() && path_ == "/programs[]/pool/max_z") facts_.programs.back().max_z = value;
    return goesOn();
  }

  bool leave() {
    path_.resize(ends_.back());
    ends_.pop_back();
    return true;
  }

  static constexpr std::size_t kMostValues = 4'000'000;
  static constexpr std::size_t kMostPrograms = 1000;  // an experiment file may have 100
  static constexpr std::size_t kLongestText = 1000;   // of texts in the list of runs
  static constexpr std::size_t kDeepest = 50;

  SummaryFacts facts_;
  std::size_t values_ = 0;
  bool format_ = false;
  std::string path_;
  std::vector<std::size_t> ends_;  ///< lengths of path_ at which the open levels began
};

}  // namespace

std::optional<SummaryFacts> scanSummary(std::string_view text) {
  Scanner scanner;
  if (!nlohmann::json::sax_parse(text, &scanner) || !scanner.isSummary()) return std::nullopt;
  return std::move(scanner.facts());
}

}  // namespace lab::dashboard
