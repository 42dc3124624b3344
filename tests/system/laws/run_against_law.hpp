/// Compares the log of a whole run with the exact law of its program.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "analyzer/analysis_feed.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "tests/system/laws/hour_ensemble.hpp"

namespace lab::system_test {

/// A program and its exact table.
struct Chain {
  std::string table;    ///< name of a table in tests/reference
  std::string program;  ///< keys of the experiment file
};

inline const Chain kAbpChain{"fig2b_ABP_v3_eps0.5_eta3",
                             "model = \"abp\"\nv_cm_s = 3\nepsilon_s = 0.5\neta_rad_s = 3\n"};
inline const Chain kNoisyAbpChain{
    "fig3b_NABP_va1_V10_eps0.1",
    "model = \"noisy_abp\"\nva_cm_s = 1\nV_cm_s = 10\nepsilon_s = 0.1\n"};
inline const Chain kBpChain{"fig3d_BP_V7_eps0.2", "model = \"bp\"\nV_cm_s = 7\nepsilon_s = 0.2\n"};
inline const Chain kRtpChain{"fig4d_RTP_v5_gam3_tt0.5",
                             "model = \"rtp\"\nv_cm_s = 5\ngamma_per_s = 3\ntau_t_s = 0.5\n"};

struct RunSize {
  int robots = 4;
  double duration = 600;  ///< [s]
  double film = 120;      ///< [s] the recording of a robot is cut into pieces of this length
  double least = 0.9;     ///< [1] least share of the windows of a piece at the shortest lag
};

/// Rate of a robot's clock relative to the host's, from its step log: the duration of each step by
/// the robot's clock, and the arrival of the next step by the host's.
class ClockFromDraws {
 public:
  void take(const robot_step_t& step) {
    if (step.draw_count == last_.draw_count + 1 && last_.duration > 0) {
      robot_s_ += last_.duration;
      host_s_ += static_cast<double>(step.utime - last_.utime) * 1e-6;
    }
    last_ = step;
  }
  [[nodiscard]] double rate() const { return robot_s_ / host_s_; }

 private:
  robot_step_t last_{};
  double robot_s_ = 0;
  double host_s_ = 0;
};

/// The law of the program executed with this clock rate.
inline analysis::ProgramLaw withClock(analysis::ProgramLaw law, double rate) {
  for (const analysis::LawParameter& parameter : law->parameters()) {
    if (parameter.unit == "s") law = law.with(parameter.name, parameter.value / rate);
    if (parameter.unit == "1/s") law = law.with(parameter.name, parameter.value * rate);
  }
  return law;
}

/// The measured curves, and the exact law with the clock rates of the robots.
struct Measured {
  HourCurves curves;
  std::vector<double> msd;          ///< exact, mean over the pieces [m^2]
  std::vector<double> angular_msd;  ///< [rad^2]
};

/// Keeps the lags of a recording with every `thinned`-th frame.
inline void thin(ReferenceSet& set, int thinned) {
  std::vector<int> lags;
  std::vector<double> msd;
  std::vector<double> angular_msd;
  for (std::size_t i = 0; i < set.lags.size(); ++i) {
    if (set.lags[i] % thinned != 0) continue;
    lags.push_back(set.lags[i] / thinned);
    msd.push_back(set.msd[i]);
    angular_msd.push_back(set.angular_msd[i]);
  }
  set.lags = lags;
  set.msd = msd;
  set.angular_msd = angular_msd;
  set.fps /= thinned;
}

/// @param thinned the recording has every `thinned`-th frame of the table
inline Measured measure(const std::filesystem::path& run_folder, const std::string& table,
                        const RunSize& size, int thinned = 1) {
  Measured measured;
  HourCurves& curves = measured.curves;
  curves.set = readReferenceSet(table);
  thin(curves.set, thinned);
  // Lags up to a fifth of a piece: longer ones have too few windows for a mean over pieces.
  std::vector<int>& lags = curves.set.lags;
  std::erase_if(lags, [&](int lag) { return lag / curves.set.fps > size.film / 5; });
  curves.msd.resize(lags.size());
  curves.angular_msd.resize(lags.size());

  std::map<std::pair<int, int>, analysis::MsdAccumulator> pieces;
  std::map<int, ClockFromDraws> clocks;
  analysis::AnalysisFeed feed(loadExperiment(run_folder / "experiment.toml"));
  feed.onSample([&](int robot, const analysis::Sample& sample) {
    const int number = static_cast<int>(sample.time / size.film);
    pieces.try_emplace({robot, number}, lags, 1 / curves.set.fps).first->second.add(sample);
  });
  readLog({run_folder / "log.lcmlog"}, [&](const Packet& packet) {
    tracked_frame_t frame{};
    robot_status_t status{};
    robot_steps_t steps{};
    if (packet.channel == channels::kTrackedFrame && decode(packet.data, frame)) feed.take(frame);
    if (packet.channel == channels::kRobotStatus && decode(packet.data, status)) feed.take(status);
    if (packet.channel == channels::kRobotSteps && decode(packet.data, steps)) {
      for (const robot_step_t& step : steps.steps) clocks[step.robot_id].take(step);
    }
  });
  feed.flush();

  measured.msd.assign(lags.size(), 0);
  measured.angular_msd.assign(lags.size(), 0);
  const auto clock_rate = [&clocks](int robot) {  // a robot without a step log has an exact clock
    const auto clock = clocks.find(robot);
    return clock == clocks.end() ? 1.0 : clock->second.rate();
  };
  for (const auto& [key, accumulator] : pieces) {
    const analysis::BlockSums sums = accumulator.data().total();
    // Skips incomplete pieces. At the shortest lag nearly every frame has a window.
    if (sums.lags.front().windows < size.least * size.film * curves.set.fps) continue;
    const analysis::ExactLaw law(withClock(curves.set.law, clock_rate(key.first)));
    for (std::size_t i = 0; i < lags.size(); ++i) {
      curves.msd[i].add(sums.lags[i].r2 / sums.lags[i].windows);
      curves.angular_msd[i].add(sums.lags[i].a2 / sums.lags[i].angular_windows);
      measured.msd[i] += law.msd(lags[i] / curves.set.fps);
      measured.angular_msd[i] += law.angularMsd(lags[i] / curves.set.fps);
    }
    curves.pool.pool(accumulator.data());
  }
  if (curves.msd.front().n == 0) return measured;
  const double factor = speedFactor(curves);
  for (double& value : measured.msd) value *= factor / curves.msd.front().n;
  for (double& value : measured.angular_msd) value /= curves.msd.front().n;
  for (const auto& [id, clock] : clocks) {
    std::cout << "robot " << id << ": clock " << 100 * (clock.rate() - 1) << " %\n";
  }
  return measured;
}

/// Expects max|z| < 4 for both curves. @return number of pieces
inline double expectLaw(const Measured& measured, const std::string& table, double film) {
  constexpr double kSystematicFloor = 0.002;
  constexpr double kLargestZ = 4;
  const auto& [curves, msd, angular_msd] = measured;
  if (curves.msd.front().n == 0) return 0;
  const double factor = speedFactor(curves);
  const Deviation translation = largestDeviation(curves.set, curves.msd, msd, kSystematicFloor);
  const Deviation rotation =
      largestDeviation(curves.set, curves.angular_msd, angular_msd, kSystematicFloor);
  std::cout << table << ": " << curves.msd.front().n << " recordings of " << film << " s, MSD "
            << translation << ", angular MSD " << rotation << ", v "
            << 100 * (std::sqrt(factor) - 1) << " %\n";
  EXPECT_LT(std::abs(translation.z), kLargestZ) << translation;
  EXPECT_LT(std::abs(rotation.z), kLargestZ) << rotation;
  return curves.msd.front().n;
}

}  // namespace lab::system_test
