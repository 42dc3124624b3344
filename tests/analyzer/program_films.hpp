/// Films of programs without a closed form, as the analysis gets them.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "analyzer/bootstrap/simulated_recording.hpp"
#include "analyzer/laws/law_of.hpp"
#include "analyzer/service/bootstrap_results.hpp"
#include "analyzer/service/program_analysis.hpp"
#include "tests/support/programs.hpp"

namespace lab::analysis {

/// A shipped program whose file names no law.
inline Program withoutLaw(const std::string& name,
                          const std::vector<language::NamedText>& changes = {}) {
  Program program = shippedProgram(name, changes, kWidestWheels);
  program.law = {};
  return program;
}

struct FilmOptions {
  double duration = 3600;  ///< s.
  double fps = 20;
  double sigma = 0.0005;       ///< m.
  double sigma_theta = 0.01;   ///< rad.
  double clock_error = 0.005;  ///< As robots in experiments.
};

inline RobotBody bodyFor(const FilmOptions& options) {
  RobotBody body;
  body.clock_error = options.clock_error;
  return body;
}

/// What the sums of one film of `truth` are, for a program `asked`.
inline BlockData filmOf(const Program& truth, const ProgramLaw& asked, std::uint64_t seed,
                        const FilmOptions& options = {}) {
  RecordingPoses poses;
  const double period = 1 / options.fps;
  simulateRecording({lawOf(truth, bodyFor(options)), options.duration, period, options.sigma,
                     options.sigma_theta, 0},
                    seed, poses);
  ProgramAnalysis analysis(asked, period, 100);
  for (std::size_t i = 0; i < poses.x.size(); ++i) {
    Sample sample;
    sample.time = sample.free_time = static_cast<double>(i) * period;
    sample.frame = static_cast<std::int64_t>(i);
    sample.x = poses.x[i];
    sample.y = poses.y[i];
    sample.theta = poses.theta[i];
    analysis.add(sample);
  }
  return analysis.data();
}

/// The complete result for a film, as in a report.
inline ProgramResult judgeFilm(const ProgramLaw& asked, const BlockData& data) {
  ProgramResult pool = analyse(asked, data, {}, {}, Depth::kFull);
  std::vector<ProgramResult> robots{pool};
  addBootstrapResults(pool, data, robots, {&data}, {});
  return pool;
}

}  // namespace lab::analysis
