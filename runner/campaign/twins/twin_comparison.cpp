#include "runner/campaign/twins/twin_comparison.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/math/random.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"
#include "common/text/json_text.hpp"
#include "runner/campaign/run_result.hpp"

namespace lab::runner::campaign {
namespace {

constexpr int kDraws = 20000;         // of correlated normal numbers
constexpr double kFewestShare = 0.8;  // of the twins that must have a number
constexpr std::size_t kFewestTwins = 5;
constexpr std::size_t kOutliers = 3;  // of the twins' maxima

/// How a look is transformed, so that its distribution is closer to the normal one.
enum class Transform { kNone, kCubeRoot, kLogarithm };

double apply(Transform transform, double value) {
  switch (transform) {
    case Transform::kNone:
      break;
    case Transform::kCubeRoot:
      return std::cbrt(value);
    case Transform::kLogarithm:
      return std::log(value);
  }
  return value;
}

double invert(Transform transform, double value) {
  switch (transform) {
    case Transform::kNone:
      break;
    case Transform::kCubeRoot:
      return value * value * value;
    case Transform::kLogarithm:
      return std::exp(value);
  }
  return value;
}

/// A look in the units in which it is compared.
struct Transformed {
  double run = 0;
  std::vector<double> twins;  ///< nan replaced by the mean: no information
  Transform transform = Transform::kNone;
};

bool isUsable(const Look& look) {
  const auto finite =
      std::ranges::count_if(look.twins, [](double value) { return std::isfinite(value); });
  return std::isfinite(look.run) && static_cast<std::size_t>(finite) >= kFewestTwins &&
         static_cast<double>(finite) >= kFewestShare * static_cast<double>(look.twins.size());
}

struct Moments {
  double mean = 0;
  double sigma = 0;
  double count = 0;
};

/// @param without index of a twin that is left out; none if it is too large
Moments momentsOf(const std::vector<double>& values,
                  std::size_t without = std::numeric_limits<std::size_t>::max()) {
  Moments moments;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i == without) continue;
    moments.mean += values[i];
    ++moments.count;
  }
  moments.mean /= moments.count;
  double squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i != without) squares += (values[i] - moments.mean) * (values[i] - moments.mean);
  }
  moments.sigma = std::sqrt(squares / (moments.count - 1));
  return moments;
}

double skewnessOf(const std::vector<double>& values) {
  const Moments moments = momentsOf(values);
  double cubes = 0;
  for (const double value : values) cubes += std::pow((value - moments.mean) / moments.sigma, 3);
  return cubes / moments.count;
}

/// The transform that leaves the least skewness. The cube root is that of Wilson and Hilferty for
/// mean squares such as the MSD.
Transform transformFor(const std::vector<double>& values, bool positive) {
  Transform best = Transform::kNone;
  double least = std::numeric_limits<double>::infinity();
  for (const Transform transform :
       {Transform::kCubeRoot, Transform::kLogarithm, Transform::kNone}) {
    if (transform == Transform::kLogarithm && !positive) continue;
    std::vector<double> transformed;
    for (const double value : values) transformed.push_back(apply(transform, value));
    const double skewness = std::abs(skewnessOf(transformed));
    if (!(skewness < least)) continue;
    least = skewness;
    best = transform;
  }
  return best;
}

Transformed transformed(const Look& look) {
  std::vector<double> finite;
  std::ranges::copy_if(look.twins, std::back_inserter(finite),
                       [](double value) { return std::isfinite(value); });
  const bool positive =
      look.run > 0 && std::ranges::all_of(finite, [](double value) { return value > 0; });
  Transformed t;
  t.transform = transformFor(finite, positive);
  t.run = apply(t.transform, look.run);
  double mean = 0;
  for (const double value : finite) {
    mean += apply(t.transform, value) / static_cast<double>(finite.size());
  }
  for (const double value : look.twins) {
    t.twins.push_back(std::isfinite(value) ? apply(t.transform, value) : mean);
  }
  return t;
}

/// Two-sided probability of Student's t, and the normal deviate with the same.
struct Deviate {
  double z = 0;
  double p = 1;
};

Deviate deviateOf(double value, const Moments& moments) {
  const double t = (value - moments.mean) / (moments.sigma * std::sqrt(1 + 1 / moments.count));
  const boost::math::students_t student(moments.count - 1);
  const double tail = std::max(boost::math::cdf(boost::math::complement(student, std::abs(t))),
                               std::numeric_limits<double>::min());
  const double z = boost::math::quantile(boost::math::complement(boost::math::normal(), tail));
  return {std::copysign(z, t), 2 * tail};
}

/// The correlation of the twins' numbers, shrunk towards none.
Eigen::MatrixXd correlationOf(const std::vector<Transformed>& looks) {
  const auto size = static_cast<Eigen::Index>(looks.size());
  const auto twins = static_cast<Eigen::Index>(looks.front().twins.size());
  Eigen::MatrixXd normal(twins, size);
  for (Eigen::Index q = 0; q < size; ++q) {
    const Transformed& look = looks[static_cast<std::size_t>(q)];
    const Moments moments = momentsOf(look.twins);
    for (Eigen::Index i = 0; i < twins; ++i) {
      normal(i, q) = (look.twins[static_cast<std::size_t>(i)] - moments.mean) / moments.sigma;
    }
  }
  const Eigen::MatrixXd sample = normal.transpose() * normal / static_cast<double>(twins - 1);
  // The optimal share of the identity (Schaefer and Strimmer 2005): the variance of the
  // correlations over their size.
  double variance = 0;
  double squares = 0;
  for (Eigen::Index a = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b < size; ++b) {
      if (a == b) continue;
      const double r = sample(a, b);
      squares += r * r;
      variance += (1 - r * r) * (1 - r * r) / static_cast<double>(twins - 1);
    }
  }
  const double share = squares > 0 ? std::clamp(variance / squares, 0.05, 1.0) : 1.0;
  return (1 - share) * sample + share * Eigen::MatrixXd::Identity(size, size);
}

/// The largest |z| of correlated normal numbers, many times, rising.
std::vector<double> drawnMaxima(const Eigen::MatrixXd& correlation, std::uint64_t seed) {
  const Eigen::MatrixXd root = correlation.llt().matrixL();
  Random random(deriveSeed(seed, 0, "looks of twins"));
  Eigen::VectorXd independent(correlation.rows());
  std::vector<double> maxima;
  maxima.reserve(kDraws);
  for (int i = 0; i < kDraws; ++i) {
    for (Eigen::Index q = 0; q < independent.size(); ++q) independent(q) = random.normal();
    maxima.push_back((root * independent).cwiseAbs().maxCoeff());
  }
  std::ranges::sort(maxima);
  return maxima;
}

/// The twins' own maxima, each twin compared with the others; rising.
std::vector<double> ownMaxima(const std::vector<Transformed>& looks) {
  std::vector<double> own;
  for (std::size_t i = 0; i < looks.front().twins.size(); ++i) {
    double largest = 0;
    for (const Transformed& look : looks) {
      largest = std::max(largest, std::abs(deviateOf(look.twins[i], momentsOf(look.twins, i)).z));
    }
    own.push_back(largest);
  }
  std::ranges::sort(own);
  return own;
}

/// Probability that a further draw is at least `limit`, by those that are known: its rank among
/// them, and beyond all but the largest ones an exponential tail, whose scale these determine. The
/// predictive distribution takes into account that they are few (it is a Pareto distribution).
/// @param largest number of values that determine the tail
double predictedBeyond(double limit, const std::vector<double>& known, std::size_t largest) {
  const double all = static_cast<double>(known.size()) + 1;
  const double threshold = known[known.size() - largest - 1];
  if (limit <= threshold) {
    const auto beyond = static_cast<double>(known.end() - std::ranges::lower_bound(known, limit));
    return (beyond + 1) / all;
  }
  const auto count = static_cast<double>(largest);
  double excess = 0;
  for (std::size_t i = known.size() - largest; i < known.size(); ++i) {
    excess += known[i] - threshold;
  }
  return (count + 1) / all * std::pow(1 + (limit - threshold) / excess, -count);
}

/// Probability that the largest of all is at least |z|: that of correlated normal numbers, or that
/// of the twins' own maxima if it is larger, because their numbers are not normal.
double probabilityOfMaximum(double z, const std::vector<double>& drawn,
                            const std::vector<double>& own, double looks) {
  const double limit = std::abs(z);
  const auto beyond = static_cast<double>(drawn.end() - std::ranges::lower_bound(drawn, limit));
  constexpr double kFewest = 20;  // draws beyond, for a probability from draws
  double normal = beyond / static_cast<double>(drawn.size());
  if (beyond < kFewest) {
    // Bonferroni's bound, which is close in the far tail.
    const double tail = boost::math::cdf(boost::math::complement(boost::math::normal(), limit));
    normal = std::min(2 * tail * looks, kFewest / static_cast<double>(drawn.size()));
  }
  // The upper quarter is the best known tail; the largest ones show outliers among the twins.
  const std::size_t quarter = std::max(kOutliers, own.size() / 4);
  return std::min(
      1.0, std::max({normal, predictedBeyond(limit, own, quarter),
                     predictedBeyond(limit, own, kOutliers), predictedBeyond(limit, own, 1)}));
}

PlacedLook placed(const Look& look, const Transformed& t) {
  PlacedLook result;
  result.name = look.name;
  result.run = look.run;
  std::vector<double> finite;
  for (const double value : look.twins) {
    if (!std::isfinite(value)) continue;
    finite.push_back(value);
    if (value < look.run) ++result.below;
    if (value > look.run) ++result.above;
  }
  const Moments plain = momentsOf(finite);
  result.mean = plain.mean;
  result.sigma = plain.sigma;
  const Moments moments = momentsOf(t.twins);
  const boost::math::students_t student(moments.count - 1);
  const double half =
      boost::math::quantile(student, 0.975) * moments.sigma * std::sqrt(1 + 1 / moments.count);
  result.low95 = invert(t.transform, moments.mean - half);
  result.high95 = invert(t.transform, moments.mean + half);
  return result;
}

/// The sections of a summary from which looks at curves are taken.
void addCurve(const nlohmann::json& pool, const char* key, const std::string& name,
              std::vector<SummaryLook>& looks) {
  const auto curve = pool.find(key);
  if (curve == pool.end() || !curve->is_object() || !curve->contains("lag_s")) return;
  std::string column;
  for (const auto& [part, values] : curve->items()) {
    if (part.starts_with("value_")) column = part;
  }
  if (column.empty()) return;
  const auto& lags = (*curve)["lag_s"];
  const auto& values = (*curve)[column];
  const std::string unit = column.substr(std::string_view("value_").size());
  // One lag per octave, the same ones for every recording of the experiment: powers of two.
  std::map<int, std::pair<double, std::size_t>> nearest;  // octave -> distance, index
  for (std::size_t i = 0; i < lags.size() && i < values.size(); ++i) {
    if (!lags[i].is_number() || !values[i].is_number() || !(lags[i].get<double>() > 0)) continue;
    const double octave = std::log2(lags[i].get<double>());
    const int whole = static_cast<int>(std::lround(octave));
    const double distance = std::abs(octave - whole);
    const auto known = nearest.find(whole);
    if (known == nearest.end() || distance < known->second.first) {
      nearest[whole] = {distance, i};
    }
  }
  for (const auto& [octave, found] : nearest) {
    constexpr double kNear = 0.26;  // of an octave: lags are about six per octave
    if (found.first > kNear) continue;
    looks.push_back(
        {fmt::format("{}.{} at {} s ({})", name, key, shortText(std::exp2(octave)), unit),
         values[found.second].get<double>()});
  }
}

}  // namespace

TwinComparison compareWithTwins(const std::vector<Look>& looks, std::uint64_t seed) {
  TwinComparison comparison;
  std::vector<Transformed> varying;
  std::vector<std::size_t> index;  // of varying in comparison.looks
  for (const Look& look : looks) {
    comparison.twins = static_cast<int>(look.twins.size());
    if (!isUsable(look)) {
      comparison.absent.push_back(look.name);
      continue;
    }
    Transformed t = transformed(look);
    const Moments moments = momentsOf(t.twins);
    PlacedLook one = placed(look, t);
    // Below the rounding of the summary nothing varies.
    const bool varies = moments.sigma > 1e-6 * std::max(1e-12, std::abs(moments.mean));
    if (varies) {
      const Deviate deviate = deviateOf(t.run, moments);
      one.z = deviate.z;
      one.p = deviate.p;
      index.push_back(comparison.looks.size());
      varying.push_back(std::move(t));
    } else {
      // Only the rank is known.
      const bool same = std::abs(t.run - moments.mean) <= 1e-5 * std::abs(moments.mean);
      one.z = units::kNan;
      one.p = same ? 1 : 2.0 / (comparison.twins + 1);
    }
    one.p_all = one.p;
    comparison.looks.push_back(std::move(one));
  }
  if (comparison.looks.empty()) return comparison;
  if (!varying.empty()) {
    const std::vector<double> maxima = drawnMaxima(correlationOf(varying), seed);
    const std::vector<double> own = ownMaxima(varying);
    for (const std::size_t i : index) {
      comparison.looks[i].p_all = probabilityOfMaximum(comparison.looks[i].z, maxima, own,
                                                       static_cast<double>(varying.size()));
    }
  }
  for (std::size_t i = 0; i < comparison.looks.size(); ++i) {
    PlacedLook& one = comparison.looks[i];
    if (std::isnan(one.z)) {
      one.p_all = std::min(1.0, one.p * static_cast<double>(comparison.looks.size()));
    }
    if (one.p_all < comparison.looks[comparison.most].p_all) comparison.most = i;
  }
  comparison.p = comparison.looks[comparison.most].p_all;
  return comparison;
}

std::vector<SummaryLook> looksOf(std::string_view summary_json) {
  std::vector<SummaryLook> looks;
  const Columns columns = columnsOf(summary_json);
  const auto has = [&](const std::string& name) {
    return std::ranges::any_of(columns, [&](const auto& column) { return column.first == name; });
  };
  constexpr std::array<std::string_view, 2> kShares{".contact_share", ".reversals"};
  for (const auto& [name, cell] : columns) {
    const bool share = std::ranges::any_of(
        kShares, [&](std::string_view ending) { return name.ends_with(ending); });
    // Estimates have errors; of fits the parameters repeat the direct estimates.
    const bool estimate = has(name + ".standard_error") && name.find(".fit.") == std::string::npos;
    if (!share && !estimate) continue;
    const auto* number = std::get_if<double>(&cell);
    looks.push_back({name, number == nullptr ? units::kNan : *number});
  }
  const auto summary = parseJsonText(summary_json);
  if (!summary.contains("programs")) return looks;
  for (const auto& program : summary["programs"]) {
    if (!program.contains("pool")) continue;
    const std::string name = program.value("name", "program");
    addCurve(program["pool"], "msd", name, looks);
    addCurve(program["pool"], "angular_msd", name, looks);
  }
  return looks;
}

std::vector<Look> looksOf(std::string_view run, const std::vector<std::string>& twins) {
  std::vector<Look> looks;
  std::map<std::string, std::size_t> known;
  for (SummaryLook& look : looksOf(run)) {
    known.emplace(look.name, looks.size());
    looks.push_back(
        {std::move(look.name), look.value, std::vector<double>(twins.size(), units::kNan)});
  }
  for (std::size_t i = 0; i < twins.size(); ++i) {
    for (const SummaryLook& look : looksOf(twins[i])) {
      const auto found = known.find(look.name);
      if (found != known.end()) looks[found->second].twins[i] = look.value;
    }
  }
  return looks;
}

}  // namespace lab::runner::campaign
