#include "analyzer/service/bootstrap_results.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "analyzer/curves/reference_comparison.hpp"
#include "analyzer/curves/robot_scatter.hpp"
#include "analyzer/fits/law_fit.hpp"

namespace lab::analysis {
namespace {

constexpr int kTestRecordings = 400;
constexpr std::uint64_t kFitSeed = 20210;
constexpr std::uint64_t kTestSeed = 40210;
constexpr std::uint64_t kFilmSeed = 60210;
constexpr int kPilotFilms = 12;

/// The simulated recordings of one program, for all its robots.
struct ProgramRecordings {
  SimulatedCurves fit;
  SimulatedCurves test;
  RecordingGaps gaps;               ///< Gaps of these recordings.
  std::vector<double> angular_msd;  ///< Of the pool; nan: not in these recordings.
};

void complete(ProgramResult& result, const BlockData& data, CurveOptions options,
              ProgramRecordings& recordings, bool first) {
  MeasuredCurves curves_now = measuredCurves(result.law, data);
  if (first) {
    recordings.gaps = curves_now.gaps;
    recordings.angular_msd = curves_now.angular_msd;
  }
  curves_now.gaps = recordings.gaps;
  for (std::size_t i = 0; i < curves_now.angular_msd.size(); ++i) {
    if (std::isnan(recordings.angular_msd[i]))
      curves_now.angular_msd[i] = recordings.angular_msd[i];
  }
  FitOptions fit_options;
  fit_options.systematic_floor = options.systematic_floor;
  fit_options.longest_lag = options.unbiased_lag;
  fit_options.seed = kFitSeed;
  fit_options.free_times = options.free_times;
  if (first) {
    result.fit = fitLaw(result.law, curves_now, fit_options, nullptr, &recordings.fit);
  } else if (recordings.fit.recordings > 0) {
    result.fit = fitLaw(result.law, curves_now, fit_options, &recordings.fit);
  } else {
    result.fit.emplace().refusal = "there is none of all its program's robots together";
  }
  for (const Estimate& estimate : result.fit->parameters) {
    if (result.fit->angular || estimate.name != "noise_position") continue;
    options.offset = estimate.value;
    options.offset_sigma = estimate.sigma;
  }
  if (first) recordings.test = simulateForTest(result.law, curves_now, kTestRecordings, kTestSeed);
  if (recordings.test.recordings == 0) return;
  options.recordings = &recordings.test;
  result.curves = curves(result.law, data, options);
  judgeMotion(result);
  if (!result.fit->fitted()) return;
  const TestOptions test_options{options.systematic_floor, options.speed_tolerance,
                                 options.unbiased_lag};
  const auto test = [&](TestedLaw tested) {
    return testLaw(tested, result.law, curves_now, recordings.test, test_options);
  };
  result.fit->exact = test(TestedLaw::kExact);
  result.fit->exact_msd = test(TestedLaw::kExactMsd);
  result.fit->paper = test(TestedLaw::kPaper);
  judgeMotion(result);
}

/// The intervals of the fit of all robots contain the scatter between their own fits.
void widenFit(ProgramResult& pool, const std::vector<ProgramResult>& robots) {
  if (robots.size() < 2 || !pool.fit || !pool.fit->fitted()) return;
  std::vector<const std::vector<Estimate>*> parameters;
  std::vector<const std::vector<Estimate>*> derived;
  std::vector<double> weights;
  for (const ProgramResult& robot : robots) {
    if (!robot.fit || !robot.fit->fitted()) continue;
    parameters.push_back(&robot.fit->parameters);
    derived.push_back(&robot.fit->derived);
    weights.push_back(robot.observed);
  }
  widenByRobots(pool.fit->parameters, parameters, weights);
  widenByRobots(pool.fit->derived, derived, weights);
}

/// The films of a program without curves, like the recording of `data`.
FilmReference filmsLike(const ProgramLaw& law, const BlockData& data) {
  const MeasuredCurves measured = measuredCurves(law, data);
  FilmPlan plan;
  plan.law = law;
  plan.lags = data.lags;
  plan.frame_period = data.frame_period;
  plan.gaps = measured.gaps;
  plan.seed = kFilmSeed;
  setFilms(plan, measured.observed / measured.tracks);
  // The noise of the heading follows from the shape of the curve.
  FilmPlan pilot = plan;
  pilot.films = kPilotFilms;
  FilmReference shape(pilot);
  shape.finish();
  std::vector<double> angular;
  std::vector<double> expected;
  for (std::size_t i = 0; i < shape.curves().lags.size(); ++i) {
    angular.push_back(measured.angular_msd[i]);
    expected.push_back(shape.expected(true, i));
  }
  plan.sigma = std::sqrt(std::max(0.0, measured.offset / 4));
  plan.sigma_theta =
      std::sqrt(std::max(0.0, headingOffset(angular, expected, secondLag(shape))) / 2);
  FilmReference films(plan);
  films.finish();
  return films;
}

void judgeByFilms(ProgramResult& result, const BlockData& data, const CurveOptions& options,
                  const FilmReference& films) {
  compareWithFilms(result.curves, films, result.law, data, options);
  judgeMotion(result);
}

}  // namespace

void addBootstrapResults(ProgramResult& pool, const BlockData& pool_data,
                         std::vector<ProgramResult>& robots,
                         const std::vector<const BlockData*>& robot_data,
                         const CurveOptions& options) {
  if (!(pool.observed > 0) || pool.law->motion() == nullptr) return;
  if (pool.law->isSimulated()) {
    const FilmReference films = filmsLike(pool.law, pool_data);
    judgeByFilms(pool, pool_data, options, films);
    for (std::size_t i = 0; i < robots.size(); ++i) {
      if (robots[i].observed > 0) judgeByFilms(robots[i], *robot_data[i], options, films);
    }
    return;
  }
  if (!ExactLaw(pool.law).exists()) return;
  ProgramRecordings recordings;
  complete(pool, pool_data, options, recordings, true);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (!(robots[i].observed > 0)) continue;
    if (robots.size() == 1) {
      robots[i].fit = pool.fit;  // the pool of one robot is that robot
      robots[i].curves = pool.curves;
      robots[i].verdict = pool.verdict;
    } else {
      complete(robots[i], *robot_data[i], options, recordings, false);
    }
  }
  widenFit(pool, robots);
}

}  // namespace lab::analysis
