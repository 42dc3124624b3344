// The whole chain, without a shortcut: the firmware's binary on simulated chips, its PWM, the arena,
// the tracker's frames, the serial lines, the bridge, the log and the analyzer's feed, held against
// the exact laws. One program a run, in virtual time.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>

#include "analyzer/analysis_feed.hpp"
#include "common/channels.hpp"
#include "common/experiment_file.hpp"
#include "common/log_file.hpp"
#include "tests/system/hour_ensemble.hpp"
#include "tests/system/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;

struct Chain {
  std::string table;    ///< of tests/reference
  std::string program;  ///< the keys of the experiment file
};

const Chain kAbpChain{"fig2b_ABP_v3_eps0.5_eta3",
                      "model = \"abp\"\nv_cm_s = 3\nepsilon_s = 0.5\neta_rad_s = 3\n"};
const Chain kNoisyAbpChain{"fig3b_NABP_va1_V10_eps0.1",
                           "model = \"noisy_abp\"\nva_cm_s = 1\nV_cm_s = 10\nepsilon_s = 0.1\n"};
const Chain kBpChain{"fig3d_BP_V7_eps0.2", "model = \"bp\"\nV_cm_s = 7\nepsilon_s = 0.2\n"};
const Chain kRtpChain{"fig4d_RTP_v5_gam3_tt0.5",
                      "model = \"rtp\"\nv_cm_s = 5\ngamma_per_s = 3\ntau_t_s = 0.5\n"};

struct Size {
  int robots = 4;
  double duration = 600;  ///< [s]
  double film = 120;      ///< [s] one robot's film is cut into so many equal ones
};

/// Short in the CI tier, hours in the long one.
Size sizeOfRun() {
  if (std::getenv("LAB_LONG") != nullptr) return {8, 3600, 600};
  return {};
}

fs::path writeExperimentFile(const fs::path& folder, const Chain& chain, const Size& size) {
  const double fps = readReferenceSet(chain.table).fps;
  const fs::path file = folder / "chain.toml";
  std::ofstream(file) << "fileversion = 1\nname = \"chain\"\nseed = 5\nduration_s = "
                      << size.duration + 5
                      << "\nprogram = \"dut\"\n"
                         "[arena]\nwidth_cm = 1000\nheight_cm = 1000\n"
                         "[[robots]]\nid = 1\nbody = \"firmware\"\ncount = "
                      << size.robots << "\n[reversal]\non = \"any\"\n[programs.dut]\n"
                      << chain.program << "[camera]\nfps = " << fps << "\n";
  return file;
}

/// A robot's clock against the host's, from its own record of draws: what it held for how long, and
/// when the next draw came.
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

/// The program as a robot with this clock executes it.
analysis::ProgramLaw withClock(analysis::ProgramLaw law, double rate) {
  law.epsilon /= rate;
  law.gamma *= rate;
  law.tau_t /= rate;
  return law;
}

/// What a run has measured, and the law that its robots' clocks make of the program.
struct Measured {
  HourCurves curves;
  std::vector<double> msd;          ///< exact, mean over the films, m^2
  std::vector<double> angular_msd;  ///< rad^2
};

Measured measure(const fs::path& run_folder, const std::string& table, const Size& size) {
  Measured measured;
  HourCurves& curves = measured.curves;
  curves.set = readReferenceSet(table);
  // Lags up to a fifth of a film: longer ones have too few windows for a mean over films.
  std::vector<int>& lags = curves.set.lags;
  std::erase_if(lags, [&](int lag) { return lag / curves.set.fps > size.film / 5; });
  curves.msd.resize(lags.size());
  curves.angular_msd.resize(lags.size());

  std::map<std::pair<int, int>, analysis::MsdAccumulator> films;
  std::map<int, ClockFromDraws> clocks;
  analysis::AnalysisFeed feed(loadExperiment(run_folder / "experiment.toml"));
  feed.onSample([&](int robot, const analysis::Sample& sample) {
    const int number = static_cast<int>(sample.time / size.film);
    films.try_emplace({robot, number}, lags, 1 / curves.set.fps).first->second.add(sample);
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
  for (const auto& [key, accumulator] : films) {
    const analysis::BlockSums sums = accumulator.data().total();
    // Films that were begun late or cut off; the shortest lag has a window for nearly every frame.
    if (sums.lags.front().windows < 0.9 * size.film * curves.set.fps) continue;
    const analysis::ExactLaw law(withClock(curves.set.law, clocks.at(key.first).rate()));
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

class ChipChain : public testing::TestWithParam<Chain> {};

TEST_P(ChipChain, AgreesWithTheExactLaw) {
  constexpr double kSystematicFloor = 0.002;
  constexpr double kLargestZ = 4;
  const Size size = sizeOfRun();
  const TemporaryFolder folder;
  const fs::path file = writeExperimentFile(folder.path(), GetParam(), size);
  const Finished lab = run("lab run " + file.string() + " --virtual-time --no-report --out " +
                               (folder.path() / "runs").string(),
                           std::chrono::hours(1));
  ASSERT_EQ(lab.exit_code, 0) << lab.output;
  EXPECT_THAT(lab.output, testing::Not(testing::HasSubstr("marked"))) << lab.output;

  const auto [curves, msd, angular_msd] =
      measure(onlyRun(folder.path() / "runs"), GetParam().table, size);
  ASSERT_GE(curves.msd.front().n, 0.8 * size.robots * size.duration / size.film) << "films";
  const double factor = speedFactor(curves);
  const Deviation translation = largestDeviation(curves.set, curves.msd, msd, kSystematicFloor);
  const Deviation rotation =
      largestDeviation(curves.set, curves.angular_msd, angular_msd, kSystematicFloor);
  std::cout << GetParam().table << ": " << curves.msd.front().n << " films of " << size.film
            << " s, MSD " << translation << ", angular MSD " << rotation << ", v "
            << 100 * (std::sqrt(factor) - 1) << " %\n";
  EXPECT_LT(std::abs(translation.z), kLargestZ) << translation;
  EXPECT_LT(std::abs(rotation.z), kLargestZ) << rotation;
  EXPECT_NEAR(factor, 1, 0.03);  // half a step of the wheels at 5 cm/s, twice
}

INSTANTIATE_TEST_SUITE_P(Programs, ChipChain,
                         testing::Values(kAbpChain, kNoisyAbpChain, kBpChain, kRtpChain),
                         [](const auto& chain) { return testName(chain.param.table); });

}  // namespace
}  // namespace lab::system_test
