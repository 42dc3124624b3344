#include "analyzer/curves/reference_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "analyzer/curves/estimates.hpp"
#include "analyzer/curves/frame_phases.hpp"
#include "analyzer/laws/numerics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr double kRecordingsPerLag = 20;  // as in curves()
constexpr double kMinDraws = 100;
constexpr double kOffsetError = 0.05;     // relative error of the noise
constexpr double kMostScatter = 0.5;      // of a cube root; beyond, a lag is not judged
constexpr double kTolerance = 0.05;       // of an MSD, for calibration
constexpr double kOnePercentZ = 3.2;      // the largest |z| of normal lags exceeds it in 1 %
constexpr double kRareShare = 0.9975;     // of films
constexpr double kRareZ = 3.8;            // below the limit of the verdict
constexpr std::size_t kLastNoiseLag = 8;  // index of the second lag for the noise of the heading
constexpr int kFewestFilms = 20;

/// The ratios of one pair of curves to the expected ones, without noise: MSD, then angular MSD.
using Ratios = std::vector<double>;

class Comparison {
 public:
  Comparison(Curves& result, const FilmReference& films, const ProgramLaw& law,
             const BlockData& data, const CurveOptions& options)
      : result_(result),
        films_(films),
        data_(data),
        options_(options),
        total_(data.total()),
        gaps_(gapsOf(data, total_)),
        lags_(films.curves().lags.size()) {
    observed_ = data.observed();
    segments_ = std::max(static_cast<double>(data.tracks.size()), total_.segments);
    enough_draws_ = observed_ / law->drawTime() >= kMinDraws;
    noise_known_ = std::isfinite(Estimator(law, data)(total_)[kPositionOffset]);
    for (std::size_t i = 0; i < lags_; ++i) {
      shape_.push_back(films_.expected(true, i));
    }
    second_lag_ = secondLag(films_);
    setPhaseErrors(law);
    for (std::size_t column = 0; column < 2 * lags_; ++column) {
      point(column).exact = films_.expected(column >= lags_, column % lags_);
      scales_.push_back(errorScale(films.curves(), observed_, segments_, tau(column)));
      if (mayBeJudged(column)) columns_.push_back(column);
    }
  }

  void run() {
    const SimulatedCurves& simulated = films_.curves();
    const Ratios measured = ofMeasurement();
    std::vector<Ratios> each;
    for (int film = 0; film < simulated.recordings; ++film) each.push_back(ofFilm(film));
    const std::optional<std::size_t> reference = calibrationLag(measured, each);
    const bool calibrated = reference && std::abs(measured[*reference] - 1) <= kTolerance;
    Ratios now = measured;
    if (calibrated) {
      relate(now, *reference);
      for (Ratios& film : each) relate(film, *reference);
    }
    for (Ratios& film : each) {
      for (const std::size_t column : columns_) film[column] = normalised(film[column]);
    }
    fill(now, each, calibrated ? reference : std::nullopt);
  }

 private:
  [[nodiscard]] CurvePoint& point(std::size_t column) const {
    return column < lags_ ? result_.msd[column] : result_.angular_msd[column - lags_];
  }
  [[nodiscard]] double tau(std::size_t column) const {
    return films_.curves().lags[column % lags_];
  }

  [[nodiscard]] Ratios ofMeasurement() const {
    std::vector<double> angular;
    for (std::size_t i = 0; i < lags_; ++i) angular.push_back(result_.angular_msd[i].value);
    const double offset = headingOffset(angular, shape_, second_lag_);
    Ratios ratios(2 * lags_);
    for (std::size_t i = 0; i < lags_; ++i) {
      CurvePoint& msd = result_.msd[i];
      CurvePoint& turn = result_.angular_msd[i];
      turn.noise = std::max(0.0, offset);
      ratios[i] = (msd.value - msd.noise) / films_.expected(false, i);
      ratios[lags_ + i] = (turn.value - offset) / shape_[i];
    }
    return ratios;
  }

  /// Scaled to the errors of the measured time. The noise of the heading is estimated as in the
  /// measurement, even if the film has none: it is what is known worst.
  [[nodiscard]] Ratios ofFilm(int film) const {
    const SimulatedCurves& simulated = films_.curves();
    const double offset = 4 * films_.plan().sigma * films_.plan().sigma;
    std::vector<double> angular;
    for (std::size_t i = 0; i < lags_; ++i) angular.push_back(simulated.value(film, lags_ + i));
    const double angular_offset = headingOffset(angular, shape_, second_lag_);
    Ratios ratios(2 * lags_, kNan);
    for (const std::size_t column : columns_) {
      const double value =
          simulated.value(film, column) - (column < lags_ ? offset : angular_offset);
      ratios[column] = 1 + scales_[column] * (value / point(column).exact - 1);
    }
    return ratios;
  }

  [[nodiscard]] bool mayBeJudged(std::size_t column) const {
    const CurvePoint& one = point(column);
    const bool angular = column >= lags_;
    const double covered =
        coveredShare(gaps_, tau(column) / data_.frame_period, total_.lags[column % lags_], angular);
    return enough_draws_ && (angular || noise_known_) && !one.selection_biased &&
           std::isfinite(one.value) && std::isfinite(one.exact) && covered >= kLeastCovered &&
           kRecordingsPerLag * tau(column) <= covered * observed_;
  }

  /// Of frames that keep their phases of the hold: films of which this is true are rare, but are
  /// far off.
  void setPhaseErrors(const ProgramLaw& law) {
    const double hold = law->steadyHold();
    std::size_t after = 0;  // the first lag that is not shorter
    while (after + 1 < lags_ && films_.curves().lags[after] < hold) ++after;
    const FramePhases phases(law, std::max(hold, films_.curves().lags[after]), shape_[after],
                             data_.frame_period, observed_,
                             static_cast<double>(data_.tracks.size()));
    std::vector<FramePhases::Deviations> all;
    for (std::size_t i = 0; i < lags_; ++i) all.push_back(phases.of(true, data_.lags[i]));
    for (std::size_t phase = 0; phases.matter() && phase < FramePhases::kPhases; ++phase) {
      std::vector<double> curve;
      for (const FramePhases::Deviations& one : all) curve.push_back(one[phase]);
      const double noise = headingOffset(curve, shape_, second_lag_);
      for (FramePhases::Deviations& one : all) one[phase] -= noise;
    }
    phase_errors_ = errorsOf(all);
  }

  /// The lag at which the MSD is most precise, and mostly motion.
  [[nodiscard]] std::optional<std::size_t> calibrationLag(const Ratios& measured,
                                                          const std::vector<Ratios>& films) const {
    std::optional<std::size_t> best;
    double least = 0;
    for (std::size_t i = 0; i < lags_; ++i) {
      const double noise = std::abs(result_.msd[i].noise) / films_.expected(false, i);
      const bool usable = std::ranges::binary_search(columns_, i);
      if (!usable || !(noise < kTolerance) || !std::isfinite(measured[i])) continue;
      const double sigma = std::hypot(moments(films, i).sigma, kOffsetError * noise);
      if (best && sigma >= least) continue;
      best = i;
      least = sigma;
    }
    return best;
  }

  void relate(Ratios& ratios, std::size_t reference) const {
    const double factor = ratios[reference];
    for (std::size_t i = 0; i < lags_; ++i) ratios[i] /= factor;
  }

  struct Moments {
    double mean = 0;
    double sigma = 0;
  };
  /// Of the films that have windows of this lag.
  static Moments moments(const std::vector<Ratios>& films, std::size_t column) {
    double sum = 0;
    double squares = 0;
    double n = 0;
    for (const Ratios& film : films) {
      const double value = film[column];
      if (!std::isfinite(value)) continue;
      sum += value;
      squares += value * value;
      n += 1;
    }
    return {sum / n, std::sqrt(std::max(0.0, (squares - sum * sum / n) / (n - 1)))};
  }

  /// @param films normalised
  void fill(const Ratios& measured, const std::vector<Ratios>& films,
            std::optional<std::size_t> reference) const {
    std::vector<double> largest(films.size(), 0);
    for (const std::size_t column : columns_) {
      CurvePoint& one = point(column);
      const bool angular = column >= lags_;
      const double expected = one.exact;
      const Moments of = moments(films, column);
      const double noise = std::abs(one.noise) / expected;
      const double floor =
          angular ? phase_errors_[column - lags_] / expected : options_.systematic_floor;
      const double of_reference =
          of.sigma / scales_[column] / std::sqrt(static_cast<double>(films.size()));
      const double sigma =
          std::hypot(std::hypot(of.sigma, of_reference), std::hypot(floor, kOffsetError * noise));
      if (std::isfinite(of.sigma) && of.sigma > 0) one.sigma = of.sigma * (expected + one.noise);
      one.z = (normalised(measured[column]) - of.mean) / sigma;
      one.judged = std::isfinite(one.z) && sigma < kMostScatter && column != reference;
      if (!one.judged) continue;
      for (std::size_t film = 0; film < films.size(); ++film) {
        const double z = std::abs(films[film][column] - of.mean) / sigma;
        largest[film] = std::max(largest[film], z);
      }
    }
    std::ranges::sort(largest);
    const auto quantile = [&](double share) {
      return largest[static_cast<std::size_t>(
          std::floor(share * static_cast<double>(largest.size() - 1)))];
    };
    // The second one for rare films that are far off: of holds of two frames that keep step with
    // the camera.
    const double factor =
        std::max({1.0, quantile(0.99) / kOnePercentZ, quantile(kRareShare) / kRareZ});
    for (std::size_t column = 0; column < 2 * lags_; ++column) point(column).z /= factor;
  }

  Curves& result_;
  const FilmReference& films_;
  const BlockData& data_;
  const CurveOptions& options_;
  BlockSums total_;
  RecordingGaps gaps_;
  std::size_t lags_;
  double observed_ = 0;
  double segments_ = 1;
  bool enough_draws_ = false;
  bool noise_known_ = false;
  std::vector<double> shape_;         ///< Expected angular MSD.
  std::size_t second_lag_ = 0;        ///< For the noise of the heading.
  std::vector<double> phase_errors_;  ///< Of the angular MSD, rad^2.
  std::vector<std::size_t> columns_;  ///< That may be judged, ascending.
  std::vector<double> scales_;        ///< From the error of a film to that of the measured time.
};

}  // namespace

double headingOffset(const std::vector<double>& angular, const std::vector<double>& shape,
                     std::size_t second) {
  if (second == 0 || second >= shape.size()) return 0;
  const double scale = (angular[second] - angular[0]) / (shape[second] - shape[0]);
  const double offset = angular[0] - scale * shape[0];
  return std::isfinite(offset) ? offset : 0;
}

std::size_t secondLag(const FilmReference& films) {
  const SimulatedCurves& curves = films.curves();
  const std::size_t lags = curves.lags.size();
  std::vector<double> shape;
  for (std::size_t i = 0; i < lags; ++i) shape.push_back(films.expected(true, i));
  std::size_t best = 0;
  double least = 0;
  for (std::size_t second = 1; second < lags && second <= kLastNoiseLag; ++second) {
    double sum = 0;
    double squares = 0;
    for (int film = 0; film < curves.recordings; ++film) {
      std::vector<double> angular(lags);
      angular[0] = curves.value(film, lags);
      angular[second] = curves.value(film, lags + second);
      const double offset = headingOffset(angular, shape, second);
      sum += offset;
      squares += offset * offset;
    }
    const double scatter = squares - sum * sum / curves.recordings;
    if (best != 0 && !(scatter < least)) continue;
    best = second;
    least = scatter;
  }
  return best;
}

void compareWithFilms(Curves& result, const FilmReference& films, const ProgramLaw& law,
                      const BlockData& data, const CurveOptions& options) {
  if (result.msd.empty() || films.curves().recordings < kFewestFilms ||
      films.curves().lags.empty()) {
    return;
  }
  Comparison(result, films, law, data, options).run();
}

}  // namespace lab::analysis
