#include "runner/campaign/campaign_laws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

#include "common/math/units.hpp"
#include "common/text/nearest_word.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kUnitKeys{
    {{"_cm2_s", "cm²/s"},
     {"_rad2_s", "rad²/s"},
     {"_cm_s", "cm/s"},
     {"_rad_s", "rad/s"},
     {"_deg_s", "°/s"},
     {"_per_s", "1/s"},
     {"_cm2", "cm²"},
     {"_rad2", "rad²"},
     {"_cm", "cm"},
     {"_ms", "ms"},
     {"_deg", "°"},
     {"_s", "s"}}};

/// Largest over smallest value that counts as varying, of a law.
constexpr double kVaries = 1.001;

struct Spread {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double range() const { return high > low ? high - low : 0; }
};

/// How much a quantity varies: whether its law does, then its range in standard errors.
std::pair<bool, double> variation(const PooledTable& pooled, std::size_t quantity) {
  Spread law;
  Spread measured;
  std::vector<double> sigmas;
  for (const PooledPoint& point : pooled.points) {
    law.add(point.theory[quantity]);
    measured.add(point.numbers[quantity].mean);
    const double sigma = point.numbers[quantity].sigma;
    if (std::isfinite(sigma) && sigma > 0) sigmas.push_back(sigma);
  }
  const bool varies = law.range() > (kVaries - 1) * std::abs(law.high);
  if (sigmas.empty()) return {varies, 0};
  std::ranges::nth_element(sigmas, sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2));
  return {varies, measured.range() / sigmas[sigmas.size() / 2]};
}

std::optional<std::vector<double>> keysOf(const CampaignData& data,
                                          const std::vector<std::size_t>& axes, std::size_t point) {
  std::vector<double> keys;
  for (const std::size_t axis : axes) {
    const auto value = numberIn(data.points[point].values[axis]);
    if (!value || !(*value > 0)) return {};
    keys.push_back(*value);
  }
  return keys;
}

std::optional<PowerLaw> measuredLaw(const CampaignData& data, const PooledTable& pooled,
                                    std::size_t quantity, const std::vector<std::size_t>& axes) {
  if (!data.request.common_seeds) {
    std::vector<PowerLawPoint> points;
    for (std::size_t i = 0; i < data.points.size(); ++i) {
      const PooledNumber& number = pooled.points[i].numbers[quantity];
      if (!std::isfinite(number.mean) || !std::isfinite(number.sigma)) continue;
      const auto keys = keysOf(data, axes, i);
      if (!keys) return {};
      points.push_back({*keys, number.mean, number.sigma});
    }
    return fitPowerLaw(points);
  }
  // The errors of points are correlated: the runs of one seed are one set.
  std::vector<std::vector<PowerLawPoint>> sets(static_cast<std::size_t>(data.request.seeds));
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const auto& result = data.survey.rows[i].result;
    if (!result) continue;
    const std::string& name = pooled.quantities[quantity].name;
    const double value = numberOf(*result, name);
    const double sigma = numberOf(*result, name + ".standard_error");
    if (!std::isfinite(value) || !std::isfinite(sigma)) continue;
    const auto keys = keysOf(data, axes, data.rows[i].point);
    if (!keys) return {};
    sets[static_cast<std::size_t>(data.rows[i].replicate)].push_back({*keys, value, sigma});
  }
  return fitPowerLawBySets(sets);
}

std::optional<PowerLaw> exactLaw(const CampaignData& data, const PooledTable& pooled,
                                 std::size_t quantity, const std::vector<std::size_t>& axes) {
  constexpr double kWithin = 0.01;
  std::vector<PowerLawPoint> points;
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const double theory = pooled.points[i].theory[quantity];
    if (!std::isfinite(theory)) continue;
    const auto keys = keysOf(data, axes, i);
    if (!keys) return {};
    points.push_back({*keys, theory, kWithin * std::abs(theory)});
  }
  auto law = fitPowerLaw(points);
  if (!law) return {};
  for (const PowerLawPoint& point : points) {
    double value = law->prefactor.value;
    for (std::size_t k = 0; k < axes.size(); ++k) {
      value *= std::pow(point.keys[k], law->exponents[k].value);
    }
    if (std::abs(value / point.value - 1) > kWithin) return {};
  }
  return law;
}

}  // namespace

std::string letterOf(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kLetters{
      {{"alpha", "α"},
       {"beta", "β"},
       {"gamma", "γ"},
       {"epsilon", "ε"},
       {"eta", "η"},
       {"theta", "θ"},
       {"sigma", "σ"},
       {"tau", "τ"},
       {"omega", "ω"},
       {"zeta", "ζ"}}};
  const std::string first = name.substr(0, name.find('_'));
  for (const auto& [word, letter] : kLetters) {
    if (first == word) return std::string(letter) + name.substr(first.size());
  }
  return name;
}

std::string QuantityLabel::text() const {
  std::string label = letterOf(symbol);
  if (!program.empty()) label += " of " + program;
  if (!unit.empty()) label += " (" + unit + ")";
  return label;
}

QuantityLabel labelOf(const std::string& quantity) {
  QuantityLabel label;
  const std::size_t first = quantity.find('.');
  label.symbol = quantity.substr(first == std::string::npos ? 0 : first + 1);
  if (first != std::string::npos) label.program = quantity.substr(0, first);
  if (label.program == "collective") {
    const std::size_t last = label.symbol.rfind('.');
    const bool of_all = last == std::string::npos;
    label.program = of_all ? "all robots" : label.symbol.substr(0, last);
    if (!of_all) label.symbol.erase(0, last + 1);
  }
  for (const auto& [key, text] : kUnitKeys) {
    if (!label.symbol.ends_with(key)) continue;
    label.symbol.erase(label.symbol.size() - key.size());
    label.unit = text;
    break;
  }
  return label;
}

std::vector<std::size_t> leadingQuantities(const PooledTable& pooled,
                                           const std::vector<std::string>& shown,
                                           std::size_t most) {
  std::vector<std::size_t> chosen;
  for (const std::string& name : shown) {
    const std::size_t before = chosen.size();
    for (std::size_t q = 0; q < pooled.quantities.size(); ++q) {
      const std::string& known = pooled.quantities[q].name;
      if (known == name || known.ends_with("." + name)) chosen.push_back(q);
    }
    if (chosen.size() > before) continue;
    std::vector<std::string> names;
    for (const Quantity& quantity : pooled.quantities) names.push_back(quantity.name);
    throw UserError(fmt::format("--show {}: found no such column, expected one of campaign.csv{}",
                                name, didYouMean(name, names)));
  }
  if (!shown.empty()) return chosen;
  std::vector<std::pair<std::pair<bool, double>, std::size_t>> ranked;
  for (std::size_t q = 0; q < pooled.quantities.size(); ++q) {
    const Quantity& quantity = pooled.quantities[q];
    // Fits repeat the direct estimates.
    if (!quantity.has_errors || quantity.name.find(".fit.") != std::string::npos) continue;
    ranked.emplace_back(variation(pooled, q), q);
  }
  // Those whose law varies keep the order of the summary, in which the most characteristic come
  // first.
  std::ranges::stable_sort(ranked, [](const auto& one, const auto& other) {
    if (one.first.first || other.first.first) return one.first.first && !other.first.first;
    return one.first.second > other.first.second;
  });
  for (const auto& [score, q] : ranked) {
    if (chosen.size() < most) chosen.push_back(q);
  }
  return chosen;
}

double deviateFrom(const PooledNumber& number, double theory) {
  constexpr double kAsGoodAsInfinite = 1e6;
  const double t = (number.mean - theory) / number.sigma;
  if (!std::isfinite(t) || !(number.degrees_of_freedom < kAsGoodAsInfinite)) return t;
  const boost::math::students_t student(std::max(number.degrees_of_freedom, 0.5));
  const double tail = boost::math::cdf(boost::math::complement(student, std::abs(t)));
  const double z = boost::math::quantile(boost::math::complement(
      boost::math::normal(), std::max(tail, std::numeric_limits<double>::min())));
  return std::copysign(z, t);
}

LawAgreement agreementOf(const PooledTable& pooled, std::size_t quantity) {
  LawAgreement agreement;
  for (const PooledPoint& point : pooled.points) {
    const PooledNumber& number = point.numbers[quantity];
    const double theory = point.theory[quantity];
    if (!std::isfinite(theory) || !std::isfinite(number.low95) || !(number.sigma > 0)) continue;
    ++agreement.points;
    if (theory >= number.low95 && theory <= number.high95) ++agreement.held;
    double z = (number.mean - theory) / number.sigma;
    if (number.degrees_of_freedom < 1e6) {
      // The normal deviate of the same probability.
      const boost::math::students_t student(std::max(number.degrees_of_freedom, 0.5));
      const double tail = boost::math::cdf(boost::math::complement(student, std::abs(z)));
      const boost::math::normal normal;
      z = boost::math::quantile(
          boost::math::complement(normal, std::max(tail, std::numeric_limits<double>::min())));
    }
    agreement.chi2 += z * z;
    agreement.largest = std::max(agreement.largest, std::abs(z));
  }
  agreement.p = agreement.points == 0
                    ? units::kNan
                    : boost::math::cdf(boost::math::complement(
                          boost::math::chi_squared(agreement.points), agreement.chi2));
  return agreement;
}

std::optional<CampaignPowerLaw> powerLawOf(const CampaignData& data, const PooledTable& pooled,
                                           std::size_t quantity) {
  CampaignPowerLaw law;
  for (std::size_t axis = 0; axis < data.axes.size(); ++axis) {
    if (!data.axes[axis].isNumeric()) return {};
    std::set<std::string> values;
    for (const Point& point : data.points) values.insert(point.values[axis]);
    if (values.size() >= 2) law.axes.push_back(axis);
  }
  if (law.axes.empty()) return {};
  auto measured = measuredLaw(data, pooled, quantity, law.axes);
  if (!measured) return {};
  law.measured = std::move(*measured);
  law.exact = exactLaw(data, pooled, quantity, law.axes);
  return law;
}

}  // namespace lab::runner::campaign
