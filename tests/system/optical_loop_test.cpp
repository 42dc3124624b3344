// The optical loop without a shortcut: robots, painted frames, detector, identities after the
// handshake, log and the analyzer's feed, held against the exact laws. One program a run, in virtual
// time.
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <lab/sim_truth_t.hpp>
#include <lab/tracker_status_t.hpp>

#include "tests/system/lab_process.hpp"
#include "tests/system/law_of_a_run.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;

/// Walls and reversals leave a film fewer windows than it has frames.
const RunSize kSize{3, 600, 120, 0.6};

/// Each frame of the table in the long tier; in the CI tier about ten a second.
int thinning(double fps) {
  constexpr double kRate = 10;  // [1/s]
  if (std::getenv("LAB_LONG") != nullptr) return 1;
  return std::max(1, static_cast<int>(std::lround(fps / kRate)));
}

fs::path writeExperimentFile(const fs::path& folder, const Chain& chain, int thinned) {
  const fs::path file = folder / "loop.toml";
  std::ofstream(file) << "fileversion = 1\nname = \"loop\"\nseed = 3\nduration_s = "
                      << kSize.duration + 5
                      << "\nprogram = \"dut\"\n"
                         "[robot]\nclock_error_percent = 0\n"
                         "[[robots]]\nid = 1\ncount = "
                      << kSize.robots
                      << "\n[reversal]\non = \"any\"\ndistance_cm = 15\n[programs.dut]\n"
                      << chain.program << "[camera]\ntracker = \"camera\"\ncamera = \"sim\"\nfps = "
                      << readReferenceSet(chain.table).fps / thinned << "\n";
  return file;
}

struct Truth {
  double worst = 0;     ///< [m] largest distance of a pose from the truth at its time
  double worst_turn = 0;  ///< [rad]
  std::int64_t compared = 0;
  std::int64_t collisions = 0;
  tracker_status_t tracker{};
};

/// Poses against SIM_TRUTH, where both are of the same instant: 10 Hz.
Truth compareWithTruth(const fs::path& run_folder) {
  Truth result;
  std::map<std::int64_t, std::map<std::int32_t, true_pose_t>> truth;
  std::map<std::int64_t, std::vector<tracked_pose_t>> seen;
  readLog({run_folder / "log.lcmlog"}, [&](const Packet& packet) {
    sim_truth_t message{};
    tracked_frame_t frame{};
    if (packet.channel == channels::kSimTruth && decode(packet.data, message)) {
      for (const true_pose_t& pose : message.robots) truth[message.utime][pose.robot_id] = pose;
      result.collisions = message.collisions;
    }
    if (packet.channel == channels::kTrackedFrame && decode(packet.data, frame)) {
      seen[frame.utime] = frame.robots;
    }
    if (packet.channel == channels::kTrackerStatus) {
      static_cast<void>(decode(packet.data, result.tracker));
    }
  });
  for (const auto& [utime, poses] : seen) {
    const auto at = truth.find(utime);
    if (at == truth.end()) continue;
    for (const tracked_pose_t& pose : poses) {
      const true_pose_t& expected = at->second.at(pose.robot_id);
      result.worst = std::max(result.worst, std::hypot(pose.x - expected.x, pose.y - expected.y));
      result.worst_turn = std::max(
          result.worst_turn,
          std::abs(std::remainder(pose.theta - expected.theta, 2 * std::numbers::pi)));
      ++result.compared;
    }
  }
  return result;
}

class OpticalLoop : public testing::TestWithParam<Chain> {};

TEST_P(OpticalLoop, AgreesWithTheExactLaw) {
  const int thinned = thinning(readReferenceSet(GetParam().table).fps);
  const TemporaryFolder folder;
  const fs::path file = writeExperimentFile(folder.path(), GetParam(), thinned);
  const Finished lab = run("lab run " + file.string() + " --virtual-time --no-report --out " +
                               (folder.path() / "runs").string(),
                           std::chrono::hours(1));
  ASSERT_EQ(lab.exit_code, 0) << lab.output;
  EXPECT_THAT(lab.output, testing::Not(testing::HasSubstr("marked"))) << lab.output;

  const fs::path run_folder = onlyRun(folder.path() / "runs");
  const Truth truth = compareWithTruth(run_folder);
  std::cout << truth.compared << " poses against the truth: worst " << truth.worst * 1e3 << " mm, "
            << truth.worst_turn * 180 / std::numbers::pi << " degrees; " << truth.collisions
            << " collisions; spacing error " << truth.tracker.spacing_error * 1e6 << " um\n";
  EXPECT_GT(truth.compared, 1000);
  EXPECT_LT(truth.worst, 1e-3);
  EXPECT_LT(truth.worst_turn, 0.02);
  EXPECT_EQ(truth.tracker.bindings, kSize.robots);
  EXPECT_EQ(truth.tracker.unbindings, 0);
  EXPECT_EQ(truth.tracker.flips, 0);
  EXPECT_EQ(truth.tracker.moved, 0) << truth.tracker.warning;

  const Measured measured = measure(run_folder, GetParam().table, kSize, thinned);
  const double films = expectLaw(measured, GetParam().table, kSize.film);
  EXPECT_GE(films, 0.8 * kSize.robots * kSize.duration / kSize.film) << "films";
}

INSTANTIATE_TEST_SUITE_P(ABP, OpticalLoop, testing::Values(kAbpChain));
INSTANTIATE_TEST_SUITE_P(NABP, OpticalLoop, testing::Values(kNoisyAbpChain));
INSTANTIATE_TEST_SUITE_P(BP, OpticalLoop, testing::Values(kBpChain));
INSTANTIATE_TEST_SUITE_P(RTP, OpticalLoop, testing::Values(kRtpChain));

}  // namespace
}  // namespace lab::system_test
