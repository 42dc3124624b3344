#include "analyzer/laws/held_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "analyzer/laws/geometric_sums.hpp"
#include "analyzer/laws/numerics.hpp"
#include "common/math/saturated.hpp"

namespace lab::analysis {
namespace {

/// The Gauss rule for half of a symmetric integral that `count` points resolve. Cached, because
/// laws are built often.
const GaussRule& halfRule(int count) {
  thread_local std::map<int, GaussRule> rules;
  auto found = rules.find(count);
  if (found == rules.end()) {
    found = rules.emplace(count, gaussLegendre(count / 2 + 4)).first;
  }
  return found->second;
}

}  // namespace

/// The functions on one hold.
struct HeldNoise::Tables {
  ChebyshevSeries first;        ///< g on the first hold.
  ChebyshevSeries first_once;   ///< Its integral.
  ChebyshevSeries first_twice;  ///< Its double integral.
  ChebyshevSeries later;        ///< g on the second hold. On hold m + 1 g is this times q^(m-1).
  ChebyshevSeries later_once;
  ChebyshevSeries later_twice;
  ChebyshevSeries spread;  ///< (1 - s/epsilon) psi(s).
  ChebyshevSeries spread_once;
  ChebyshevSeries spread_twice;
  // At the end of the hold.
  double first_once_end = 0;
  double first_twice_end = 0;
  double later_once_end = 0;
  double later_twice_end = 0;
  double spread_once_end = 0;
  double spread_twice_end = 0;
};

struct HeldNoise::LazyTables {
  std::once_flag once;
  std::shared_ptr<const Tables> tables;
};

HeldNoise HeldNoise::uniformTurning(double v, double eta, double epsilon) {
  return {v, {Noise::kTurning, eta, 0, epsilon}};
}

HeldNoise HeldNoise::uniformWheels(double va, double amplitude, double wheel_base, double epsilon) {
  return {va, {Noise::kWheels, amplitude / wheel_base, amplitude, epsilon}};
}

HeldNoise::HeldNoise(double va, const Shape& shape)
    : va_(va),
      shape_(shape),
      omega2_(shape.noise == Noise::kTurning ? shape.width * shape.width / 3
                                             : 2 * shape.width * shape.width / 3),
      q_(chi(shape.epsilon)),
      lazy_(std::make_shared<LazyTables>()) {}

HeldNoise::Tables HeldNoise::makeTables() const {
  const double epsilon = shape_.epsilon;
  const int count = points();
  const GaussRule& rule = halfRule(count);
  // The integrands are symmetric about total / 2.
  const auto convolve = [&](double from, double total) {
    const double half = 0.5 * total - from;
    double sum = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double a = from + half * rule.nodes[i];
      sum += rule.weights[i] * chi(a) * chi(total - a);
    }
    return 2 * half * sum / epsilon;
  };
  std::vector<double> first;
  std::vector<double> later;
  std::vector<double> spread;
  for (const double r : ChebyshevSeries::points(epsilon, count)) {
    const double inside = convolve(0, r);
    first.push_back((1 - r / epsilon) * chi(r) + inside);
    later.push_back(q_ * inside + convolve(r, epsilon + r));
    spread.push_back((1 - r / epsilon) * psi(r));
  }
  Tables tables;
  tables.first = ChebyshevSeries(first, epsilon);
  tables.later = ChebyshevSeries(later, epsilon);
  tables.spread = ChebyshevSeries(spread, epsilon);
  tables.first_once = tables.first.integral();
  tables.first_twice = tables.first_once.integral();
  tables.later_once = tables.later.integral();
  tables.later_twice = tables.later_once.integral();
  tables.spread_once = tables.spread.integral();
  tables.spread_twice = tables.spread_once.integral();
  tables.first_once_end = tables.first_once(epsilon);
  tables.first_twice_end = tables.first_twice(epsilon);
  tables.later_once_end = tables.later_once(epsilon);
  tables.later_twice_end = tables.later_twice(epsilon);
  tables.spread_once_end = tables.spread_once(epsilon);
  tables.spread_twice_end = tables.spread_twice(epsilon);
  return tables;
}

const HeldNoise::Tables& HeldNoise::tables() const {
  std::call_once(lazy_->once, [this] {
    // Thousands of sines: an analysis asks for the same few programs repeatedly.
    constexpr std::size_t kKept = 32;
    thread_local std::vector<std::pair<Shape, std::shared_ptr<const Tables>>> kept;
    thread_local std::size_t oldest = 0;
    for (const auto& [known, tables] : kept) {
      if (known == shape_) {
        lazy_->tables = tables;
        return;
      }
    }
    lazy_->tables = std::make_shared<const Tables>(makeTables());
    if (kept.size() < kKept) {
      kept.emplace_back(shape_, lazy_->tables);
    } else {
      kept[oldest] = {shape_, lazy_->tables};
      oldest = (oldest + 1) % kKept;
    }
  });
  return *lazy_->tables;
}

int HeldNoise::points() const {
  // chi makes width * epsilon / (2 pi) oscillations in a hold, its square twice as many.
  const double more = 6 * shape_.width * shape_.epsilon;
  return more < 182 ? 18 + saturated<int>(more) : 200;  // also if `more` is nan
}

double HeldNoise::chi(double t) const {
  const double a = sinc(shape_.width * t);
  return shape_.noise == Noise::kTurning ? a : a * a;
}

double HeldNoise::psi(double t) const {
  if (shape_.noise == Noise::kTurning) {
    return 0;
  }
  // V^2/2 (A'^2 - A A'') for A = sinc(k); the closed forms lose digits at small k.
  const double k = shape_.width * t;
  const double k2 = k * k;
  double slope = 0;
  double curvature = 0;
  if (k < 0.3) {
    slope = -k / 3 * (1 - k2 / 10 * (1 - k2 / 28 * (1 - k2 / 54 * (1 - k2 / 88))));
    curvature = -(1.0 / 3) *
                (1 - 3 * k2 / 10 * (1 - 5 * k2 / 84 * (1 - 7 * k2 / 270 * (1 - 9 * k2 / 616))));
  } else {
    slope = (std::cos(k) - sinc(k)) / k;
    curvature = -sinc(k) - 2 * slope / k;
  }
  return 0.5 * shape_.amplitude * shape_.amplitude * (slope * slope - sinc(k) * curvature);
}

double HeldNoise::meanSpeedPart(double tau) const {
  const Tables& table = tables();
  const double epsilon = shape_.epsilon;
  if (tau <= epsilon) {
    return table.first_twice(tau);
  }
  const double holds = std::floor(tau / epsilon);
  const double rest = std::clamp(tau - holds * epsilon, 0.0, epsilon);
  const GeometricSums sums = geometricSums(q_, holds - 1);
  return table.first_twice_end + table.first_once_end * (tau - epsilon) +
         sums.plain * (table.later_twice_end + rest * table.later_once_end) +
         sums.weighted * epsilon * table.later_once_end +
         std::pow(q_, holds - 1) * table.later_twice(rest);
}

double HeldNoise::spreadPart(double tau) const {
  if (shape_.noise == Noise::kTurning) return 0;
  const Tables& table = tables();
  if (tau <= shape_.epsilon) return table.spread_twice(tau);
  return table.spread_twice_end + table.spread_once_end * (tau - shape_.epsilon);
}

double HeldNoise::msd(double tau) const {
  return 2 * (va_ * va_ * meanSpeedPart(tau) + spreadPart(tau));
}

double HeldNoise::angularMsd(double tau) const {
  const double epsilon = shape_.epsilon;
  return tau <= epsilon ? omega2_ * tau * tau * (1 - tau / (3 * epsilon))
                        : omega2_ * epsilon * (tau - epsilon / 3);
}

double HeldNoise::directionCorrelation(double s) const {
  const double epsilon = shape_.epsilon;
  if (s <= epsilon) {
    return tables().first(s);
  }
  const double holds = std::floor(s / epsilon);
  const double rest = std::clamp(s - holds * epsilon, 0.0, epsilon);
  return std::pow(q_, holds - 1) * tables().later(rest);
}

double HeldNoise::velocityCorrelation(double s) const {
  return va_ * va_ * directionCorrelation(s) + (s < shape_.epsilon ? tables().spread(s) : 0.0);
}

/// The displacements of two holds are independent except for their directions: with
/// c = int_0^epsilon chi, those of holds n apart have the mean product va^2 c^2 q^(n-1). Within a
/// hold it is 2 int_0^epsilon (epsilon - t) (va^2 chi(t) + psi(t)) dt.
double HeldNoise::diffusivity() const {
  const double epsilon = shape_.epsilon;
  if (va_ != 0 && 1 - q_ < 1e-15) {
    return std::numeric_limits<double>::infinity();
  }
  const GaussRule& rule = halfRule(points());
  double once = 0;
  double own = 0;
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    const double t = epsilon * rule.nodes[i];
    const double turned = chi(t);
    once += rule.weights[i] * turned;
    own += rule.weights[i] * (1 - rule.nodes[i]) * (va_ * va_ * turned + psi(t));
  }
  const double pairs = va_ == 0 ? 0 : va_ * va_ * once * once / (1 - q_);
  return 0.5 * epsilon * (own + pairs);
}

}  // namespace lab::analysis
