#include "dashboard/library/summary_scan.hpp"

#include <nlohmann/json.hpp>

namespace lab::dashboard {
namespace {

/// Follows the place in the document as "/programs[]/pool/max_z".
class Scanner final : public nlohmann::json_sax<nlohmann::json> {
 public:
  [[nodiscard]] SummaryFacts& facts() { return facts_; }
  [[nodiscard]] bool isSummary() const { return format_; }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t value) override {
    return number(static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return number(static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t&) override { return number(value); }
  bool binary(binary_t&) override { return true; }

  bool string(string_t& value) override {
    if (!near()) return true;
    if (place_ == "/experiment") facts_.experiment = value;
    if (program() && place_ == "/programs[]/name") facts_.programs.back().name = value;
    if (program() && place_ == "/programs[]/pool/verdict") facts_.programs.back().verdict = value;
    return true;
  }

  bool start_object(std::size_t) override {
    ends_.push_back(place_.size());
    if (place_ == "/programs[]") facts_.programs.emplace_back();
    if (place_ == "/faults[]") ++facts_.faults;
    return true;
  }
  bool key(string_t& name) override {
    place_.resize(ends_.back());
    place_.append("/").append(name);
    return true;
  }
  bool end_object() override { return leave(); }
  bool start_array(std::size_t) override {
    ends_.push_back(place_.size());
    place_ += "[]";
    return true;
  }
  bool end_array() override { return leave(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  /// Everything of interest lies there; the many numbers of the curves lie deeper.
  [[nodiscard]] bool near() const { return ends_.size() <= 4; }
  [[nodiscard]] bool program() const { return !facts_.programs.empty(); }

  bool number(double value) {
    if (!near()) return true;
    if (place_ == "/format") format_ = true;
    if (place_ == "/duration_s") facts_.duration_s = value;
    if (place_ == "/losses/log[]/lost") facts_.lost += static_cast<std::int64_t>(value);
    if (program() && place_ == "/programs[]/pool/max_z") facts_.programs.back().max_z = value;
    return true;
  }

  bool leave() {
    place_.resize(ends_.back());
    ends_.pop_back();
    return true;
  }

  SummaryFacts facts_;
  bool format_ = false;
  std::string place_;
  std::vector<std::size_t> ends_;  ///< of the place, where each level began
};

}  // namespace

std::optional<SummaryFacts> scanSummary(std::string_view text) {
  Scanner scanner;
  if (!nlohmann::json::sax_parse(text, &scanner) || !scanner.isSummary()) return std::nullopt;
  return std::move(scanner.facts());
}

}  // namespace lab::dashboard
