// A night in an emulated lab: simulated runs, and robots that stall, reboot and are taken away by a
// seeded plan, as the messages of a real lab would show it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/log_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/math/random.hpp"
#include "runner/campaign/campaign_data.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/campaign_plan.hpp"
#include "runner/campaign/campaign_table.hpp"
#include "runner/campaign/live/live_engine.hpp"
#include "runner/campaign/live/live_journal.hpp"
#include "runner/campaign/live/robot_problems.hpp"
#include "runner/runs/run_directory.hpp"
#include "runner/virtual_time/run_virtual.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner::campaign {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSecond_us = 1'000'000;
constexpr std::int64_t kHour_us = 3600 * kSecond_us;
constexpr std::int64_t kEvening_us = 1'769'875'200 * kSecond_us;  // 2026-01-31T16:00:00Z

/// A failure of a robot's hardware.
struct Failure {
  std::int32_t robot = 0;
  RobotProblem kind = RobotProblem::kStalled;
  std::int64_t from_us = 0;
  std::int64_t to_us = 0;
};

/// Failures of robots in a night: reboots, stalls and absences at random times.
std::vector<Failure> failuresOfANight(int robots, std::int64_t hours, std::uint64_t seed) {
  std::vector<Failure> failures;
  Random random(seed);
  const auto draw = [&](RobotProblem kind, double per_hour, double duration_s) {
    for (int robot = 1; robot <= robots; ++robot) {
      double hour = 0;
      while ((hour += -std::log(1 - random.uniform()) / per_hour) < static_cast<double>(hours)) {
        const std::int64_t from =
            kEvening_us + static_cast<std::int64_t>(hour * static_cast<double>(kHour_us));
        failures.push_back({robot, kind, from, from + static_cast<std::int64_t>(duration_s * 1e6)});
      }
    }
  };
  draw(RobotProblem::kRebooted, 0.04, 0);
  draw(RobotProblem::kStalled, 0.02, 1800);
  draw(RobotProblem::kVanished, 0.02, 900);
  // Its battery is empty: it stays where it is.
  failures.push_back({2, RobotProblem::kStalled, kEvening_us + hours * kHour_us / 3,
                      kEvening_us + 2 * hours * kHour_us});
  return failures;
}

/// Simulated runs on a clock of its own.
class EmulatedLab {
 public:
  explicit EmulatedLab(std::vector<Failure> failures) : failures_(std::move(failures)) {}

  LiveMachine machine() {
    LiveMachine machine;
    machine.play = [this](const fs::path& file, const fs::path& parent) {
      return play(file, parent);
    };
    machine.now = [this] { return now_us_; };
    machine.wait = [this](std::int64_t until_us) { now_us_ = std::max(now_us_, until_us); };
    machine.interrupted = [this] { return runs_ >= power_cut_after; };
    machine.say = [this](const std::string& line) { lines.push_back(line); };
    return machine;
  }

  /// Continues after a power cut, 20 minutes later.
  void restart() {
    power_cut_after = std::numeric_limits<int>::max();
    now_us_ += 1200 * kSecond_us;
  }

  [[nodiscard]] std::int64_t now() const { return now_us_; }

  int power_cut_after = std::numeric_limits<int>::max();  ///< number of runs
  std::vector<std::string> lines;

 private:
  PlayedRun play(const fs::path& file, const fs::path& parent) {
    ++runs_;
    const Experiment experiment = loadExperiment(file, {});
    const PreparedRun run = [&] {
      PreparedRun prepared = prepareRun(experiment, file.parent_path(), parent, now_us_);
      prepared.live_analysis = false;
      return prepared;
    }();
    static_cast<void>(runVirtual(
        run, [](const Progress&) {}, [] { return false; }));
    applyFailures(run.directory / files::kLog);
    now_us_ += static_cast<std::int64_t>(experiment.duration * 1e6) + 3 * kSecond_us;
    return {run.directory, {}};
  }

  /// Rewrites a log as the messages would have been.
  void applyFailures(const fs::path& log) const {
    const fs::path healthy = log.string() + ".healthy";
    fs::rename(log, healthy);
    {
      LogWriter writer(log);
      std::int64_t begin_us = 0;
      std::map<std::int32_t, tracked_pose_t> stuck;
      std::map<std::int32_t, std::int32_t> epochs;
      readLog({healthy}, [&](const Packet& packet) {
        if (begin_us == 0) begin_us = packet.received_utime;
        const std::int64_t now = now_us_ + packet.received_utime - begin_us;
        if (packet.channel == channels::kTrackedFrame) {
          writeChanged<tracked_frame_t>(writer, packet,
                                        [&](tracked_frame_t& frame) { change(frame, now, stuck); });
        } else if (packet.channel == channels::kRobotStatus) {
          writeChanged<robot_status_t>(
              writer, packet, [&](robot_status_t& status) { change(status, now, epochs); });
        } else {
          writer.write(packet);
        }
      });
    }
    fs::remove(healthy);
  }

  template <class Message, class Change>
  static void writeChanged(LogWriter& writer, const Packet& packet, const Change& change) {
    Message message;
    EXPECT_TRUE(decode(packet.data, message));
    change(message);
    const std::vector<std::uint8_t> bytes = encode(message);
    Packet result = packet;
    result.data = bytes;
    writer.write(result);
  }

  [[nodiscard]] bool has(std::int32_t robot, RobotProblem kind, std::int64_t now) const {
    return std::ranges::any_of(failures_, [&](const Failure& failure) {
      return failure.robot == robot && failure.kind == kind && now >= failure.from_us &&
             now < failure.to_us;
    });
  }

  void change(tracked_frame_t& frame, std::int64_t now,
              std::map<std::int32_t, tracked_pose_t>& stuck) const {
    std::erase_if(frame.robots, [&](const tracked_pose_t& pose) {
      return has(pose.robot_id, RobotProblem::kVanished, now);
    });
    frame.num_robots = static_cast<std::int32_t>(frame.robots.size());
    for (tracked_pose_t& pose : frame.robots) {
      if (has(pose.robot_id, RobotProblem::kStalled, now)) {
        const tracked_pose_t& place = stuck.try_emplace(pose.robot_id, pose).first->second;
        pose.x = place.x;
        pose.y = place.y;
        pose.theta = place.theta;
      } else {
        stuck.erase(pose.robot_id);
      }
    }
  }

  void change(robot_status_t& status, std::int64_t now,
              std::map<std::int32_t, std::int32_t>& epochs) const {
    for (robot_state_t& state : status.robots) {
      std::int32_t& offset = epochs[state.robot_id];
      const std::int64_t run_begin = now_us_;
      for (const Failure& failure : failures_) {
        const bool here = failure.robot == state.robot_id &&
                          failure.kind == RobotProblem::kRebooted && failure.from_us >= run_begin &&
                          failure.from_us <= now;
        if (here && offset == 0) offset = state.program_epoch;  // counts from 0 again
      }
      state.program_epoch -= offset;
    }
  }

  std::vector<Failure> failures_;
  std::int64_t now_us_ = kEvening_us;
  int runs_ = 0;
};

constexpr int kRobots = 6;

constexpr const char* kExperiment = R"(fileversion = 1
name = "night"
duration_s = 300
program = "abp"
[[robots]]
id = 1
count = 6
[programs.abp]
model = "abp"
v_cm_s = 3
[camera]
fps = 10
)";

Request requestOfNight(const fs::path& folder, std::int64_t seeds) {
  Request request;
  request.name = "night";
  request.file = (folder / "night.toml").string();
  request.over = {"programs.abp.eta_rad_s=1,2,3", "programs.abp.epsilon_s=0.2,0.5"};
  request.seeds = seeds;
  request.keep = Keep::kSummary;
  request.live = LivePlan{};
  request.live->rest_s = 30;
  return request;
}

/// A campaign in a folder, as `lab sweep` makes it.
fs::path makeCampaign(const fs::path& folder, const Request& request) {
  const Plan plan = planCampaign(request, kExperiment);
  const fs::path campaign = folder / "campaign";
  writeCampaign(campaign, {request, "2026-01-31T16:00:00Z", kExperiment, plan.points}, plan.files);
  return campaign;
}

struct Night {
  CampaignData data;
  std::vector<JournalEntry> journal;
};

Night play(EmulatedLab& lab, const fs::path& campaign) {
  CampaignData data = dataOf(readCampaign(campaign));
  data.survey = surveyRows(campaign, data.rows);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (data.survey.rows[i].kind == RowState::Kind::kMissing) rows.push_back(i);
  }
  const EngineEnd end = runLive(data, campaign, rows, lab.machine());
  EXPECT_FALSE(end.disk_full) << end.note;
  return {std::move(data), readJournal(journalText(campaign)).entries};
}

/// The part of a run in which a robot has a failure of this kind; reboots count as the whole.
double shareOf(const std::vector<Failure>& failures, const JournalEntry& run, std::int32_t robot) {
  double share = 0;
  const auto length = static_cast<double>(run.end_us - run.begin_us);
  for (const Failure& failure : failures) {
    if (failure.robot != robot || failure.from_us >= run.end_us) continue;
    if (failure.kind == RobotProblem::kRebooted) {
      if (failure.from_us >= run.begin_us) share = std::max(share, 1.0);
      continue;
    }
    const std::int64_t from = std::max(failure.from_us, run.begin_us);
    const std::int64_t to = std::min(failure.to_us, run.end_us);
    share = std::max(share, static_cast<double>(to - from) / length);
  }
  return share;
}

/// Every failure is named, and nothing else.
void expectFailuresNamed(const Night& night, const std::vector<Failure>& failures) {
  int named = 0;
  for (const JournalEntry& run : night.journal) {
    if (run.what != JournalEntry::What::kRun || run.end_us == 0) continue;
    for (const auto& [robot, problem] : run.robots) {
      const double share = shareOf(failures, run, robot);
      named += problem.empty() ? 0 : 1;
      if (share == 0) {
        EXPECT_EQ(problem, "") << "robot " << robot << " in " << journalLine(run);
      }
      // Up to a reboot within the first or last seconds, which no message shows.
      if (share > 0.9 && share < 1) {
        EXPECT_NE(problem, "") << "robot " << robot << " in " << journalLine(run);
      }
    }
  }
  EXPECT_GT(named, 0);
}

void expectTimeAccounted(const Night& night, const EmulatedLab& lab) {
  const TimeAccount account = accountOf(night.journal);
  EXPECT_NEAR(account.total_s, static_cast<double>(lab.now() - kEvening_us) * 1e-6, 60);
  EXPECT_NEAR(account.kept_s + account.marked_s + account.lost_s + account.clear_s +
                  account.rest_s + account.wait_s + account.idle_s,
              account.total_s, 1e-3);
}

/// The largest deviation of the pooled D_r from the law, in standard errors.
double largestDeviation(const CampaignData& data) {
  const PooledTable pooled = poolCampaign(data);
  double largest = 0;
  for (std::size_t q = 0; q < pooled.quantities.size(); ++q) {
    if (pooled.quantities[q].name != "abp.D_r_rad2_s") continue;
    for (const PooledPoint& point : pooled.points) {
      const double z = (point.numbers[q].mean - point.theory[q]) / point.numbers[q].sigma;
      largest = std::max(largest, std::abs(z));
    }
  }
  return largest;
}

void playNight(std::int64_t hours, std::int64_t seeds, int power_cut_after) {
  const TemporaryFolder temporary;
  const std::vector<Failure> failures = failuresOfANight(kRobots, hours, 11);
  EmulatedLab lab(failures);
  const fs::path campaign = makeCampaign(temporary.path(), requestOfNight(temporary.path(), seeds));
  lab.power_cut_after = power_cut_after;
  const Night evening = play(lab, campaign);
  EXPECT_GT(evening.data.survey.count(RowState::Kind::kMissing), 0U);
  lab.restart();
  const Night night = play(lab, campaign);

  EXPECT_EQ(night.data.survey.count(RowState::Kind::kDone), night.data.rows.size());
  expectFailuresNamed(night, failures);
  expectTimeAccounted(night, lab);
  EXPECT_GT(accountOf(night.journal).lost_s, 1000);  // the power cut
  EXPECT_TRUE(std::ranges::any_of(lab.lines, [](const std::string& line) {
    return line.find("robot    2 is left out from now on") != std::string::npos;
  })) << fmt::format("{}", fmt::join(lab.lines, "\n"));
  EXPECT_LT(largestDeviation(night.data), 4);
  testing::Test::RecordProperty("hours",
                                std::to_string(lab.now() / kHour_us - kEvening_us / kHour_us));
  testing::Test::RecordProperty("account", accountText(accountOf(night.journal)));
}

TEST(Night, AnEveningOfTwoHoursIsAccountedFor) { playNight(2, 3, 7); }

TEST(NightLong, AWholeDayIsAccountedFor) { playNight(24, 40, 100); }

TEST(Night, EndsBeforeTheTimeThatWasSet) {
  const TemporaryFolder temporary;
  EmulatedLab lab({});
  Request request = requestOfNight(temporary.path(), 3);
  request.live->until_us = kEvening_us + kHour_us / 2;
  const Night night = play(lab, makeCampaign(temporary.path(), request));
  EXPECT_LE(lab.now(), request.live->until_us);
  EXPECT_EQ(night.data.survey.count(RowState::Kind::kDone), 5U);  // of 333 s each
}

TEST(Night, ARunThatCannotBePlayedIsGivenUpAfterItsTries) {
  const TemporaryFolder temporary;
  EmulatedLab lab({});
  LiveMachine machine = lab.machine();
  machine.play = [](const fs::path&, const fs::path&) {
    return PlayedRun{{}, "lab run: the camera is not there"};
  };
  Request request = requestOfNight(temporary.path(), 1);
  request.over = {"programs.abp.eta_rad_s=1,2"};
  const fs::path campaign = makeCampaign(temporary.path(), request);
  CampaignData data = dataOf(readCampaign(campaign));
  data.survey = surveyRows(campaign, data.rows);
  const EngineEnd end = runLive(data, campaign, {0, 1}, machine);
  EXPECT_FALSE(end.known);
  ASSERT_EQ(data.survey.count(RowState::Kind::kFailed), 2U);
  EXPECT_NE(data.survey.rows[0].note.find("the camera is not there"), std::string::npos);
  EXPECT_DOUBLE_EQ(accountOf(readJournal(journalText(campaign)).entries).wait_s, 6 * 300.0);
}

}  // namespace
}  // namespace lab::runner::campaign
