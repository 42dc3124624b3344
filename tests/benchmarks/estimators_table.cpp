// Prints the table of docs/estimators.md: bias and standard deviation of every estimator over
// simulated one-hour recordings, as Markdown. Arguments: number of recordings (default 1000), seed
// (default 1).

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "analyzer/fits/law_fit.hpp"

namespace lab::analysis {
namespace {

constexpr double kHour = 3600;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// y = intercept + slope x, ordinary least squares.
struct Line {
  double intercept = 0;
  double slope = 0;
};

Line lineThrough(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0;
  double sy = 0;
  double sxx = 0;
  double sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sx += x[i];
    sy += y[i];
    sxx += x[i] * x[i];
    sxy += x[i] * y[i];
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  return {(sy - slope * sx) / n, slope};
}

double slopeThroughOrigin(const std::vector<double>& x, const std::vector<double>& y) {
  double sxx = 0;
  double sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sxx += x[i] * x[i];
    sxy += x[i] * y[i];
  }
  return sxy / sxx;
}

/// A set of recordings and its slope: 2 D_r of the angular MSD (ABP), or 4 D_t of the MSD (BP). For
/// tau >= epsilon the curve is the slope times (tau - epsilon/3).
struct Set {
  const char* title;
  ProgramLaw law;
  double fps;
  double sigma;
  double sigma_theta;
  bool angular;
};

struct Film {
  MeasuredCurves curves;
  bool angular = false;
  double epsilon = 0;

  [[nodiscard]] const std::vector<double>& values() const {
    return angular ? curves.angular_msd : curves.msd;
  }
  /// The lags within a range, and the values of the curve.
  void range(double from, double to, std::vector<double>& x, std::vector<double>& y) const {
    x.clear();
    y.clear();
    for (std::size_t i = 0; i < curves.lags.size(); ++i) {
      if (curves.lags[i] < 0.99 * from || curves.lags[i] > 1.01 * to) continue;
      x.push_back(curves.lags[i]);
      y.push_back(values()[i]);
    }
  }
  [[nodiscard]] std::size_t nearest(double tau) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < curves.lags.size(); ++i) {
      if (std::abs(curves.lags[i] - tau) < std::abs(curves.lags[best] - tau)) best = i;
    }
    return best;
  }
};

/// The shape of both curves for unit slope.
double shape(double tau, double epsilon) {
  return tau < epsilon ? tau * tau / epsilon * (1 - tau / (3 * epsilon)) : tau - epsilon / 3;
}

/// From two lags, as the analyzer does live: independent of constant offsets.
double covarianceBased(const Film& film) {
  const std::size_t one = film.nearest(film.epsilon);
  const std::size_t two = film.nearest(2 * film.epsilon);
  return (film.values()[two] - film.values()[one]) /
         (shape(film.curves.lags[two], film.epsilon) - shape(film.curves.lags[one], film.epsilon));
}

struct Estimator {
  const char* name;
  std::function<double(const Film&)> slope;
};

std::vector<Estimator> estimators() {
  static std::vector<double> x;
  static std::vector<double> y;
  return {
      {"the paper's: line through the origin, lags ε to 8ε",
       [](const Film& film) {
         film.range(film.epsilon, 8 * film.epsilon, x, y);
         return slopeThroughOrigin(x, y);
       }},
      {"the same, lags 0.1 s to 8ε",
       [](const Film& film) {
         film.range(0, 8 * film.epsilon, x, y);
         return slopeThroughOrigin(x, y);
       }},
      {"line with intercept, lags ε to 8ε",
       [](const Film& film) {
         film.range(film.epsilon, 8 * film.epsilon, x, y);
         return lineThrough(x, y).slope;
       }},
      {"trackpy: `imsd` + `polyfit(log lag, log MSD, 1)`, all lags to 8ε",
       [](const Film& film) {
         film.range(0, 8 * film.epsilon, x, y);
         for (double& value : x) value = std::log(value);
         for (double& value : y) value = std::log(value);
         return std::exp(lineThrough(x, y).intercept);
       }},
      {"least squares, exact shape and offset, lags 0.1 s to 8ε",
       [](const Film& film) {
         film.range(0, 8 * film.epsilon, x, y);
         for (double& value : x) value = shape(value, film.epsilon);
         return lineThrough(x, y).slope;
       }},
      {"live, covariance-based: [A(t₂) − A(t₁)] / [F(t₂) − F(t₁)], t ≈ ε, 2ε", covarianceBased},
  };
}

struct Scatter {
  double n = 0;
  double sum = 0;
  double sum2 = 0;
  void add(double x) {
    n += 1;
    sum += x;
    sum2 += x * x;
  }
  [[nodiscard]] double mean() const { return sum / n; }
  [[nodiscard]] double sd() const { return std::sqrt((sum2 - sum * sum / n) / (n - 1)); }
};

void row(const char* name, const Scatter& scatter, double covered) {
  std::printf("| %s | %+.2f ± %.2f | %.2f | ", name, 100 * scatter.mean(),
              100 * scatter.sd() / std::sqrt(scatter.n), 100 * scatter.sd());
  std::printf(std::isfinite(covered) ? "%.1f |\n" : "– |\n", covered);
}

MeasuredCurves emptyCurves(const Set& set) {
  MeasuredCurves curves;
  curves.frame_period = 1 / set.fps;
  curves.observed = kHour;
  curves.offset = 4 * set.sigma * set.sigma;
  curves.angular_offset = 2 * set.sigma_theta * set.sigma_theta;
  return curves;
}

void measure(const Set& set, int films, std::uint64_t seed) {
  std::vector<int> lags;
  const double epsilon = set.law->parameter("epsilon");
  const double hold = epsilon * set.fps;
  for (double frames = 1; frames < 8.2 * hold; frames *= 1.15) {
    const int lag = static_cast<int>(std::lround(frames));
    if (lags.empty() || lag > lags.back()) lags.push_back(lag);
  }
  for (const double holds : {1, 2}) lags.push_back(static_cast<int>(std::lround(holds * hold)));
  std::sort(lags.begin(), lags.end());
  lags.erase(std::unique(lags.begin(), lags.end()), lags.end());

  Film film{emptyCurves(set), set.angular, epsilon};
  MeasuredCurves& curves = film.curves;
  for (const int lag : lags) {
    curves.lags.push_back(lag * curves.frame_period);
    curves.joined.push_back(1);
  }
  const RecordingPlan plan{set.law, kHour, curves.frame_period, set.sigma, set.sigma_theta, 0};
  const double truth =
      set.angular ? 2 * set.law->rotationalDiffusivity() : 4 * set.law->translationalDiffusivity();
  const std::vector<Estimator> list = estimators();
  std::vector<Scatter> scatter(list.size());
  Scatter fitted;
  int covered = 0;
  const FitOptions options;
  SimulatedCurves covariance;
  RecordingPoses poses;
  const auto n = static_cast<std::ptrdiff_t>(lags.size());
  for (int i = 0; i < films; ++i) {
    simulateRecording(plan, seed * 1'000'000 + static_cast<std::uint64_t>(i), poses);
    const std::vector<double> both = recordingCurves(poses, lags);
    curves.msd.assign(both.begin(), both.begin() + n);
    curves.angular_msd.assign(both.begin() + n, both.end());
    for (std::size_t e = 0; e < list.size(); ++e) {
      scatter[e].add(list[e].slope(film) / truth - 1);
    }
    if (i == 0) {
      covariance = simulateForFit(set.law, curves.offset, curves.angular_offset, curves,
                                  planFit(set.law, curves, options), options);
    }
    const LawFit fit = fitLaw(set.law, curves, options, &covariance);
    const std::string wanted = set.angular ? "D_r" : "D_t";
    for (const Estimate& estimate : fit.derived) {
      if (estimate.name != wanted) continue;
      fitted.add(estimate.value / estimate.theory - 1);
      covered += estimate.low95 <= estimate.theory && estimate.theory <= estimate.high95 ? 1 : 0;
    }
  }
  const double draws = kHour / epsilon * (set.angular ? 1 : 2);
  std::printf(
      "\n%s; limit %.2f %%\n\n| estimator | bias, %% | sd, %% | 95 %% interval covers, %% |\n"
      "|---|---|---|---|\n",
      set.title, 100 * std::sqrt(0.8 / draws));
  for (std::size_t e = 0; e < list.size(); ++e) row(list[e].name, scatter[e], kNan);
  row("**GLS, exact law, MSD and angular MSD**", fitted, 100.0 * covered / fitted.n);
  std::fflush(stdout);
}

ProgramLaw abp(double eta, double epsilon) {
  return closedForm("abp", {{"v", 0.03}, {"epsilon", epsilon}, {"eta", eta}}, kPaperWheelBase);
}

ProgramLaw bp(double amplitude, double epsilon) {
  return closedForm("bp", {{"V", amplitude}, {"epsilon", epsilon}}, kPaperWheelBase);
}

}  // namespace
}  // namespace lab::analysis

int main(int argc, char** argv) {
  using namespace lab::analysis;
  const int films = argc > 1 ? std::atoi(argv[1]) : 1000;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoi(argv[2]) : 1);
  const std::array sets{
      Set{"D_r, Fig. 2b: v = 3 cm/s, ε = 0.5 s, η = 3 rad/s; 9.97 frames/s, noise 0.05 cm, 3°",
          abp(3, 0.5), 9.97, 0.0005, 0.0524, true},
      Set{"D_r, Fig. 2d: ε = 0.25 s, η = 1 rad/s; 9.97 frames/s, noise 0.05 cm, 0.3°", abp(1, 0.25),
          9.97, 0.0005, 0.00524, true},
      Set{"D_r, Fig. 2d: ε = 0.25 s, η = 6 rad/s; 9.97 frames/s, noise 0.05 cm, 0.3°", abp(6, 0.25),
          9.97, 0.0005, 0.00524, true},
      Set{"D_t, Fig. 3c: V = 7 cm/s, ε = 0.2 s; 19.97 frames/s, noise 0.05 cm, 1.4°", bp(0.07, 0.2),
          19.97, 0.0005, 0.025, false}};
  for (const Set& set : sets) measure(set, films, seed);
}
