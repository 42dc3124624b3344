#include "report/pose_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <set>
#include <string_view>

#include "analyzer/analysis_feed.hpp"
#include "common/experiment_file.hpp"
#include "common/experiment_messages.hpp"
#include "common/units.hpp"

namespace lab::report {
namespace {

using analysis::Frame;
using analysis::FramePose;

constexpr double kTouching = 0.001;  // [m] of a gap that cannot be told from none
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// An experiment in which every robot runs the program. Its checks are those of any experiment.
Experiment experimentOf(const std::string& name, const PoseProgram& program) {
  // Some program is needed for the file to be one; it is taken out again.
  const bool given = !program.model.empty();
  const std::string text = fmt::format(
      "fileversion = 1\nname = \"poses\"\nduration_s = 1\nprogram = \"{0}\"\n[[robots]]\nid = 1\n"
      "[programs.{0}]\nmodel = \"{0}\"\n{1}",
      given ? program.model : "bp", given ? "" : "V_cm_s = 1\nepsilon_s = 1\n");
  std::vector<std::string> set;
  for (const std::string& one : program.set) {
    const bool plain = one.substr(0, one.find('=')).find('.') == std::string::npos;
    if (plain && !given) {
      throw ExperimentError({fmt::format(
          "--set {}: found a parameter without a program, expected --program too", one)});
    }
    set.push_back(plain ? fmt::format("programs.{}.{}", program.model, one) : one);
  }
  Experiment experiment = parseExperiment(text, "--program", set);
  if (!given) experiment.programs.clear();
  experiment.name = name;
  experiment.robots.clear();
  experiment.light_table.bands.clear();
  experiment.light = {};
  return experiment;
}

/// Which robots touch another one, or a wall of a known arena.
std::set<int> touching(const Frame& frame, const Experiment& experiment, bool in_arena) {
  std::set<int> robots;
  const double diameter = experiment.hardware.diameter;
  const double nearest = diameter / 2 + kTouching;
  for (std::size_t i = 0; i < frame.poses.size(); ++i) {
    const FramePose& a = frame.poses[i];
    if (in_arena && (a.x < nearest || a.y < nearest || a.x > experiment.arena_width - nearest ||
                     a.y > experiment.arena_height - nearest)) {
      robots.insert(a.robot);
    }
    for (std::size_t k = i + 1; k < frame.poses.size(); ++k) {
      const FramePose& b = frame.poses[k];
      if (std::hypot(a.x - b.x, a.y - b.y) > diameter + kTouching) continue;
      robots.insert(a.robot);
      robots.insert(b.robot);
    }
  }
  return robots;
}

/// Feeds the analysis and keeps what it says of every row.
class PoseFeed {
 public:
  PoseFeed(const PoseFile& poses, const Experiment& experiment, const analysis::ProgramLaw& law)
      : poses_(poses), experiment_(experiment), law_(law), analysis_(configOf(poses, experiment)) {
    const bool runs = law.kind == analysis::ProgramKind::kRtp && law.gamma > 0;
    run_share_ = runs ? 1 / (1 + law.gamma * law.tau_t) : 1;
    analysis_.onSample([this](int robot, const analysis::ProgramLaw&,
                              const analysis::Sample& sample) { judge(robot, sample); });
  }

  void run(RunRecord& record, analysis::Depth depth) {
    for (const Frame& frame : poses_.frames) take(frame, record);
    analysis_.flush();
    record.tracks = std::move(tracks_);
    for (analysis::ProgramResult& result : analysis_.results(depth)) {
      record.results.push_back({record.programs.front().program, std::move(result)});
    }
  }

 private:
  static analysis::AnalysisConfig configOf(const PoseFile& poses, const Experiment& experiment) {
    analysis::AnalysisConfig config = analysis::analysisConfig(experiment);
    config.frame_period = poses.frame_period;
    config.stitcher.headings = poses.headings;
    config.without_law = experiment.programs.empty();
    return config;
  }

  void take(const Frame& frame, RunRecord& record) {
    const std::set<int> contacts = touching(frame, experiment_, poses_.in_arena);
    tracks_.frames.push_back({units::microseconds(frame.time), frame.frame, tracks_.rows.size()});
    record.poses->in_contact += static_cast<std::int64_t>(contacts.size());
    for (const FramePose& pose : frame.poses) {
      analysis::RobotTelemetry telemetry;
      telemetry.time = frame.time;
      telemetry.program_start = poses_.frames.front().time;
      telemetry.contact = contacts.contains(pose.robot);
      telemetry.run_time = run_share_ * (frame.time - telemetry.program_start);
      analysis_.addTelemetry(pose.robot, law_, telemetry);
      waiting_[pose.robot].push_back({frame.time, tracks_.rows.size()});
      tracks_.rows.push_back({pose.robot, static_cast<float>(pose.x), static_cast<float>(pose.y),
                              static_cast<float>(pose.theta), 0, -1});
    }
    analysis_.addFrame(frame);
  }

  void judge(int robot, const analysis::Sample& sample) {
    std::deque<Waiting>& waiting = waiting_[robot];
    while (!waiting.empty() && waiting.front().time < sample.time) waiting.pop_front();
    if (waiting.empty() || waiting.front().time != sample.time) return;
    tracks_.rows[waiting.front().row].segment = sample.piece;
    waiting.pop_front();
  }

  struct Waiting {
    double time;
    std::size_t row;
  };

  const PoseFile& poses_;
  const Experiment& experiment_;
  analysis::ProgramLaw law_;
  double run_share_ = 1;
  analysis::Analysis analysis_;
  Tracks tracks_;
  std::map<int, std::deque<Waiting>> waiting_;
};

/// The frame of a picture whose arena is not known: all that was seen.
void adoptExtent(const PoseFile& poses, Experiment& experiment) {
  experiment.arena_width = experiment.arena_height = 0;
  for (const Frame& frame : poses.frames) {
    for (const FramePose& pose : frame.poses) {
      experiment.arena_width = std::max(experiment.arena_width, pose.x);
      experiment.arena_height = std::max(experiment.arena_height, pose.y);
    }
  }
}

/// What only the robots could have told.
void leaveOpen(analysis::ProgramResult& result) {
  if (result.law.kind != analysis::ProgramKind::kRtp) return;
  constexpr std::array<std::string_view, 4> kOfTumbles{"gamma", "tau_r", "D", "L_s"};
  for (analysis::Estimate& estimate : result.estimates) {
    if (estimate.name == "v") estimate.note += ", its share as programmed";
    if (std::find(kOfTumbles.begin(), kOfTumbles.end(), estimate.name) == kOfTumbles.end())
      continue;
    estimate.value = estimate.sigma = estimate.low95 = estimate.high95 = kNan;
    estimate.n_eff = 0;
    estimate.note = "needs the tumbles, which only the robots report";
  }
}

/// Robots as the report lists them: one program from their first frame to their last.
void fillRobots(RunRecord& record) {
  for (std::size_t i = 0; i < record.tracks.frames.size(); ++i) {
    const std::int64_t utime = record.tracks.frames[i].utime;
    for (std::size_t r = record.tracks.frames[i].first_row; r < record.tracks.endOf(i); ++r) {
      RobotRecord& robot = record.robots[record.tracks.rows[r].robot];
      if (robot.programs.empty()) robot.programs.push_back({utime, utime, 0});
      robot.programs.front().end_utime = utime;
    }
  }
}

}  // namespace

RunRecord poseRun(const PoseFile& poses, const std::string& name, const PoseProgram& program,
                  analysis::Depth depth) {
  RunRecord record;
  record.experiment = experimentOf(name, program);
  const Experiment& experiment = *record.experiment;
  RunProgram robots_run{{}, "motion"};
  if (!experiment.programs.empty()) {
    const ProgramSpec& spec = experiment.programs.begin()->second;
    robots_run = {toMessage(spec), spec.name};
  }
  record.programs.push_back(robots_run);
  if (!poses.in_arena) adoptExtent(poses, *record.experiment);
  record.poses = PoseSource{.headings = poses.headings,
                            .rows = poses.rows,
                            .without_pose = poses.without_pose,
                            .without_id = poses.without_id};
  record.log.frames = static_cast<std::int64_t>(poses.frames.size());
  record.missing_frames = poses.missing_frames;
  record.frame_period = poses.frame_period;
  record.start_utime = units::microseconds(poses.frames.front().time);
  record.end_utime = units::microseconds(poses.frames.back().time);
  record.ended = true;

  PoseFeed(poses, experiment, analysis::toLaw(robots_run.program, experiment.hardware.diameter))
      .run(record, depth);
  for (analysis::FeedResult& result : record.results) leaveOpen(result.result);
  fillRobots(record);
  return record;
}

}  // namespace lab::report
