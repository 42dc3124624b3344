#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "analyzer/runs/run_finder.hpp"
#include "tests/analyzer/walker.hpp"

namespace lab::analysis {

/// A recording of a run-and-tumble robot with its true runs and tumbles; also with laws other than
/// that of RTP.
struct RunRecording {
  using Draw = std::function<double(std::mt19937_64&)>;

  ProgramLaw law;
  double duration = 3600;  ///< s.
  double fps = 49.7;
  double sigma = 0.0005;       ///< m.
  double sigma_theta = 0.025;  ///< rad.
  double missing = 0;          ///< Share of frames that are lost.
  std::uint64_t seed = 1;
  Draw run{};               ///< s; none: exponential.
  Draw turn{};              ///< rad; none: uniform on (-pi, pi].
  double speed_factor = 1;  ///< Speed of the robot over the programmed one.
  double tumble_factor = 1;
  double circling = 0;  ///< Turning rate in runs, rad/s.
};

struct TrueRuns {
  std::vector<double> runs;
  std::vector<double> turns;
  double run_time = 0;
};

/// The samples of a recording in an infinite plane.
inline std::vector<Sample> recordRuns(const RunRecording& recording, TrueRuns* truth = nullptr) {
  std::mt19937_64 random(recording.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const RunsAndTurns programmed = *recording.law->runs();
  const double v = programmed.speed * recording.speed_factor;
  const double tau = programmed.turn_time * recording.tumble_factor;
  const auto draw_run = [&] {
    return recording.run ? recording.run(random)
                         : std::exponential_distribution<double>(programmed.rate)(random);
  };
  const auto draw_turn = [&] {
    return recording.turn ? recording.turn(random) : (2 * uniform(random) - 1) * std::numbers::pi;
  };
  double x = 0;
  double y = 0;
  double theta = 0;
  // Begins long before the recording, in order to be in the stationary state.
  double time = -20 * (1 / programmed.rate + tau) * uniform(random);
  bool run = true;
  double left = draw_run();
  double turning = 0;
  double next = uniform(random) / recording.fps;
  std::vector<Sample> samples;
  while (time < recording.duration) {
    const bool is_frame = next < time + left;
    const double dt = is_frame ? next - time : left;
    if (run) {
      // The chord of an arc.
      const double half = recording.circling * dt / 2;
      const double chord = half == 0 ? v * dt : v * dt * std::sin(half) / half;
      x += chord * std::cos(theta + half);
      y += chord * std::sin(theta + half);
      theta += recording.circling * dt;
      if (truth != nullptr) truth->run_time += std::max(0.0, std::min(dt, time + dt));
    } else {
      theta += turning * dt;
    }
    time += dt;
    left -= dt;
    if (is_frame) {
      Sample sample;
      sample.time = sample.free_time = time;
      sample.x = x + recording.sigma * normal(random);
      sample.y = y + recording.sigma * normal(random);
      sample.theta = theta + recording.sigma_theta * normal(random);
      sample.program = 0;
      if (uniform(random) >= recording.missing) samples.push_back(sample);
      next += 1 / recording.fps;
      continue;
    }
    run = !run;
    left = run ? draw_run() : tau;
    if (!run) turning = draw_turn() / tau;
    if (truth != nullptr && time > 0) {
      (run ? truth->runs : truth->turns).push_back(run ? left : turning * tau);
    }
  }
  return samples;
}

inline FoundRuns findRuns(const RunRecording& recording, const std::vector<Sample>& samples) {
  RunFinder finder(recording.law, 1 / recording.fps);
  for (const Sample& sample : samples) finder.add(sample);
  return finder.find();
}

}  // namespace lab::analysis
