#include "analyzer/report/poses/pose_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/report/poses/pose_units.hpp"
#include "analyzer/report/record/crowd_records.hpp"
#include "analyzer/report_error.hpp"
#include "analyzer/service/collective_feed.hpp"
#include "analyzer/tracks/reversal_finder.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/program_colours.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "common/programs/shipped_programs.hpp"

namespace lab::report {
namespace {

using analysis::Frame;
using analysis::FramePose;
using units::kNan;

constexpr double kTouching = 0.001;  // [m] smallest gap that can be distinguished from contact

/// Reports the problems of a program by the names that the user typed, not by those of the
/// generated experiment file.
[[noreturn]] void refuse(const ExperimentError& error, const std::string& model) {
  std::vector<std::string> problems;
  const std::string key = "programs." + model + ".";
  for (const std::string& problem : error.problems()) {
    const std::size_t at = problem.find(": " + key);
    problems.push_back(at == std::string::npos ? problem
                                               : "--set " + problem.substr(at + 2 + key.size()));
  }
  throw ExperimentError(problems);
}

/// Poses are compared with the parameters that the robots had, never with those of the shipped
/// file.
void requireParameters(const Program& shipped, const PoseProgram& program) {
  std::vector<std::string> problems;
  for (const ProgramParameter& parameter : shipped.parameters) {
    const bool set = std::ranges::any_of(
        program.set, [&](const std::string& one) { return one.starts_with(parameter.name + "_"); });
    if (set) continue;
    problems.push_back(
        fmt::format("--set {0}: found nothing, expected the value that the robots had, with the "
                    "unit in its name: v_cm_s=3, epsilon_s=0.5, eta_rad_s=3, gamma_per_s=1",
                    parameter.name));
  }
  if (!problems.empty()) throw ExperimentError(problems);
}

/// An experiment in which every robot runs the program. It passes the checks of experiment files.
Experiment experimentOf(const std::string& name, const PoseProgram& program) {
  // An experiment file needs a program; without a given one it is removed again below.
  const bool given = !program.model.empty();
  const std::vector<std::string> known = shippedProgramNames();
  if (given && std::ranges::find(known, program.model) == known.end()) {
    throw ExperimentError({fmt::format("--program: found \"{}\", expected one of {}", program.model,
                                       fmt::join(known, ", "))});
  }
  const std::string text = fmt::format(
      "fileversion = 1\nname = \"poses\"\nduration_s = 1\nprogram = \"{0}\"\n[[robots]]\nid = 1\n"
      "[programs.{0}]\n{1}\n",
      given ? program.model : "still",
      given ? fmt::format("model = \"{}\"", program.model) : "phases.still = {hold = \"forever\"}");
  std::vector<std::string> set;
  for (const std::string& one : program.set) {
    const bool plain = one.substr(0, one.find('=')).find('.') == std::string::npos;
    if (plain && !given) {
      throw ExperimentError({fmt::format(
          "--set {}: found a parameter without a program, expected --program too", one)});
    }
    set.push_back(plain ? fmt::format("programs.{}.{}", program.model, one) : one);
  }
  Experiment experiment;
  try {
    experiment = parseExperiment(text, "--program", set);
  } catch (const ExperimentError& error) {
    refuse(error, program.model);
  }
  if (given) requireParameters(experiment.programs.begin()->second, program);
  if (!given) experiment.programs.clear();
  experiment.name = name;
  experiment.robots.clear();
  experiment.light_table.bands.clear();
  experiment.light = {};
  return experiment;
}

struct Contacts {
  std::set<int> robots;    ///< that touch another one
  std::set<int> at_walls;  ///< that touch a wall, if the arena is known
};

Contacts contactsIn(std::span<const Pose> robots, const Experiment& experiment, bool in_arena) {
  Contacts contacts;
  const double diameter = experiment.hardware.diameter;
  const double nearest = diameter / 2 + kTouching;
  std::vector<const Pose*> from_left;
  for (const Pose& pose : robots) {
    from_left.push_back(&pose);
    if (in_arena &&
        (pose.x < nearest || pose.y < nearest || pose.x > experiment.arena_width - nearest ||
         pose.y > experiment.arena_height - nearest)) {
      contacts.at_walls.insert(pose.robot);
    }
  }
  std::ranges::sort(from_left, {}, &Pose::x);
  const std::size_t n = from_left.size();
  std::vector<bool> touching(n);
  const auto near = [&](std::size_t a, std::size_t b) {
    return std::abs(from_left[a]->x - from_left[b]->x) <= diameter + kTouching;
  };
  const auto touches = [&](std::size_t a, std::size_t b) {
    return std::hypot(from_left[a]->x - from_left[b]->x, from_left[a]->y - from_left[b]->y) <=
           diameter + kTouching;
  };
  // One neighbour is enough: a file with thousands of robots at one place must not cost all pairs.
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n && !touching[a] && near(a, b); ++b) {
      if (touches(a, b)) touching[a] = touching[b] = true;
    }
    for (std::size_t b = a; b > 0 && !touching[a] && near(a, b - 1); --b) {
      if (touches(a, b - 1)) touching[a] = touching[b - 1] = true;
    }
    if (touching[a]) contacts.robots.insert(from_left[a]->robot);
  }
  return contacts;
}

/// Feeds the analysis and stores its classification of every row.
class PoseFeed {
 public:
  PoseFeed(PoseFile poses, const Experiment& experiment, const analysis::ProgramLaw& law,
           bool speed_is_known)
      : poses_(std::move(poses)),
        experiment_(experiment),
        law_(law),
        speed_is_known_(speed_is_known),
        epoch_start_(poses_.frames.front().time),
        analysis_(configOf(poses_, experiment)),
        crowd_(analysis::crowdConfig(experiment)) {
    const auto runs = law->runs();
    run_share_ = runs && runs->rate > 0 ? 1 / (1 + runs->rate * runs->turn_time) : 1;
    analysis_.onSample([this](int robot, const analysis::ProgramLaw&,
                              const analysis::Sample& sample) { rows_.sampled(robot, sample); });
    analysis_.onFrame(
        [this](int robot, const analysis::FrameReport& frame) { rows_.classified(robot, frame); });
    analysis_.wholeMotion();
  }

  void run(RunRecord& record, const ReadOptions& options) {
    analysis_.stitch(options.stitch, options.depth == analysis::Depth::kFull);
    analysis_.freeTimes(options.free_times);
    analysis_.onPiece([&record](int robot, const analysis::ProgramLaw&, analysis::Piece piece) {
      const double start = units::seconds(record.start_utime);
      for (double analysis::Piece::*time :
           {&analysis::Piece::begin, &analysis::Piece::end, &analysis::Piece::reversal_start,
            &analysis::Piece::reversal_end}) {
        piece.*time -= start;
      }
      // Programs do not change here; only a step of the clock starts a new epoch.
      if (piece.reason == analysis::PieceEnd::kProgramSwitch) {
        piece.reason = analysis::PieceEnd::kClockStep;
      }
      record.pieces.push_back({robot, 0, piece});
    });
    examine(record);
    poses_.eachFrame(
        [&](const PoseFrame& frame, std::span<const Pose> robots) { take(frame, robots, record); });
    analysis_.flush();
    record.left_out = analysis_.counters().left_out;
    fillCrowds(
        crowd_, units::seconds(record.start_utime), [](int) { return -1; }, record);
    record.tracks = rows_.takeTracks();
    for (analysis::ProgramResult& result : analysis_.results(options.depth)) {
      const bool given = !experiment_.programs.empty();
      record.results.push_back({record.programs.front().program,
                                given ? experiment_.programs.begin()->second : Program(),
                                std::move(result)});
    }
  }

 private:
  static analysis::AnalysisConfig configOf(const PoseFile& poses, const Experiment& experiment) {
    analysis::AnalysisConfig config = analysis::analysisConfig(experiment);
    config.frame_period = poses.frame_period;
    config.stitcher.headings = poses.headings;
    config.without_law = experiment.programs.empty();
    config.find_runs = true;
    return config;
  }

  /// Corrects headings and finds reversals, robot by robot.
  void examine(RunRecord& record) {
    const Reversal& reversal = experiment_.reversal;
    analysis::ReversalSearch search =
        analysis::reversalSearch(law_, speed_is_known_ ? reversal.speed : kNan, reversal.distance);
    search.headings = poses_.headings;
    search.max_turn_rate = 2 * experiment_.hardware.max_wheel_speed / experiment_.hardware.diameter;
    // Without a program, reversals cannot be distinguished from its motion.
    search.wanted = !experiment_.programs.empty() && reversal.on != ReverseOn::kNever;
    const std::map<int, Presence> all = presences();
    requireTracks(all);
    for (const auto& [robot, presence] : all) {
      std::vector<analysis::TrackPoint> track = trackOf(robot, presence);
      if (poses_.headings) {
        const double noise = heading_noise_[robot] = analysis::headingNoise(track);
        for (analysis::TrackPoint& point : track) point.sigma_theta = noise;
      }
      const analysis::TrackFindings found = analysis::examineTrack(track, search);
      record.headings.flips += found.flips;
      record.headings.jumps += found.flip_jumps;
      record.headings.sense_turns += found.sense_turns;
      record.poses->reversals += static_cast<std::int64_t>(found.reversals.size());
      reporters_.try_emplace(robot, found.reversals);
      if (found.flips != 0 || found.sense_turns != 0) correct(robot, presence, track);
    }
  }

  /// The first and the last frame with valid poses of a robot: indices.
  struct Presence {
    std::size_t first = 0;
    std::size_t last = 0;
  };

  [[nodiscard]] std::map<int, Presence> presences() const {
    std::map<int, Presence> all;
    std::size_t i = 0;
    poses_.eachFrame([&](const PoseFrame& /*frame*/, std::span<const Pose> robots) {
      for (const Pose& pose : robots) {
        if (pose.valid) all.try_emplace(pose.robot, Presence{i, i}).first->second.last = i;
      }
      ++i;
    });
    return all;
  }

  /// Every robot's frames are looked through one by one.
  void requireTracks(const std::map<int, Presence>& all) const {
    constexpr double kManyFrames = 3e8;  // about half a minute
    constexpr double kLeastShare = 0.02;
    double frames = 0;
    for (const auto& [robot, presence] : all) {
      frames += static_cast<double>(presence.last - presence.first + 1);
    }
    const double share = static_cast<double>(poses_.poses.size()) / frames;
    if (frames < kManyFrames || share > kLeastShare) return;
    throw ReportError(
        fmt::format("found {} robots that are seen in {:.2g} % of the frames between their first "
                    "and their last "
                    "pose, expected tracks; give a robot that comes back another id",
                    all.size(), 100 * share));
  }

  /// Calls visit(frame, pose) for the valid poses of one robot, in order.
  template <class Visit>
  void eachPoseOf(int robot, const Presence& presence, Visit&& visit) {
    for (std::size_t i = presence.first; i <= presence.last; ++i) {
      const std::span<Pose> robots = poses_.posesOf(i);
      const auto found = std::ranges::lower_bound(robots, robot, {}, &Pose::robot);
      if (found != robots.end() && found->robot == robot && found->valid) {
        visit(poses_.frames[i], *found);
      }
      poses_.poses.keepNear(poses_.frames[i].first);
    }
    poses_.poses.releaseMemory();
  }

  [[nodiscard]] std::vector<analysis::TrackPoint> trackOf(int robot, const Presence& presence) {
    std::vector<analysis::TrackPoint> track;
    eachPoseOf(robot, presence, [&](const PoseFrame& frame, const Pose& pose) {
      track.push_back({frame.time, frame.frame, pose.x, pose.y, pose.theta, 0, 0, true});
    });
    return track;
  }

  void correct(int robot, const Presence& presence,
               const std::vector<analysis::TrackPoint>& track) {
    auto point = track.begin();
    eachPoseOf(robot, presence,
               [&](const PoseFrame& /*frame*/, Pose& pose) { pose.theta = (point++)->theta; });
  }

  void take(const PoseFrame& now, std::span<const Pose> robots, RunRecord& record) {
    while (next_step_ < poses_.clock_steps.size() && poses_.clock_steps[next_step_] <= now.time) {
      epoch_start_ = poses_.clock_steps[next_step_++];
    }
    const Contacts contacts = contactsIn(robots, experiment_, poses_.in_arena);
    rows_.beginFrame(units::microseconds(now.time), now.frame);
    frame_.time = now.time;
    frame_.frame = now.frame;
    frame_.poses.clear();
    for (const Pose& one : robots) {
      FramePose pose;
      pose.robot = one.robot;
      pose.x = one.x;
      pose.y = one.y;
      pose.theta = one.theta;
      pose.valid = one.valid;
      const auto noise = heading_noise_.find(pose.robot);
      if (noise != heading_noise_.end()) pose.sigma_theta = noise->second;
      analysis::RobotTelemetry telemetry;
      telemetry.time = now.time;
      telemetry.program_epoch = static_cast<std::int64_t>(next_step_);
      telemetry.program_start = epoch_start_;
      telemetry.contact_robot = contacts.robots.contains(pose.robot);
      telemetry.contact_wall = contacts.at_walls.contains(pose.robot);
      telemetry.contact = telemetry.contact_robot || telemetry.contact_wall;
      record.poses->in_contact += telemetry.contact ? 1 : 0;
      telemetry.run_time = now.time - poses_.frames.front().time;
      const auto reporter = reporters_.find(pose.robot);
      if (reporter != reporters_.end()) {
        reporter->second.report(telemetry);
        telemetry.run_time -= reporter->second.removed();
      }
      telemetry.run_time *= run_share_;
      TrackRow row;
      row.robot = pose.robot;
      row.x = static_cast<float>(pose.x);
      row.y = static_cast<float>(pose.y);
      row.theta = static_cast<float>(pose.theta);
      row.program = 0;
      rows_.add(now.time, row);
      analysis_.addTelemetry(pose.robot, law_, telemetry);
      frame_.poses.push_back(pose);
    }
    analysis_.addFrame(frame_);
    crowd_poses_.clear();
    for (const FramePose& pose : frame_.poses) {
      if (!pose.valid) continue;
      crowd_poses_.push_back(
          {pose.robot, pose.x, pose.y, poses_.headings ? pose.theta : kNan, -1, -1});
    }
    crowd_.addFrame(now.time, poses_.frame_period, crowd_poses_);
  }

  PoseFile poses_;
  const Experiment& experiment_;
  analysis::ProgramLaw law_;
  bool speed_is_known_ = false;
  double run_share_ = 1;
  std::map<int, analysis::ReversalReporter> reporters_;
  std::map<int, double> heading_noise_;  ///< by robot [rad]
  std::size_t next_step_ = 0;
  double epoch_start_ = 0;
  analysis::Analysis analysis_;
  collective::CrowdAnalysis crowd_;
  Frame frame_;
  std::vector<collective::CrowdPose> crowd_poses_;
  TrackCollector rows_;
};

/// Sets the size of an unknown arena to the range of the poses.
void adoptExtent(const PoseFile& poses, Experiment& experiment) {
  experiment.arena_width = experiment.arena_height = 0;
  poses.poses.each([&](const Pose& pose) {
    experiment.arena_width = std::max(experiment.arena_width, pose.x);
    experiment.arena_height = std::max(experiment.arena_height, pose.y);
  });
}

/// Replaces estimates that need telemetry of tumbles by those from poses.
void adoptRuns(analysis::ProgramResult& result) {
  if (!result.law->runs()) return;
  const std::string problem = result.runs ? result.runs->problem : std::string();
  constexpr std::array<std::string_view, 5> kOfTumbles{"gamma", "tau_r", "v", "D", "L_s"};
  for (analysis::Estimate& estimate : result.estimates) {
    if (std::find(kOfTumbles.begin(), kOfTumbles.end(), estimate.name) == kOfTumbles.end())
      continue;
    const analysis::Estimate* seen = result.runs ? result.runs->find(estimate.name) : nullptr;
    if (seen != nullptr) {
      estimate = *seen;
      continue;
    }
    if (estimate.name == "v") {
      estimate.note += ", its share as programmed";
      continue;
    }
    estimate.value = estimate.sigma = estimate.low95 = estimate.high95 = kNan;
    estimate.n_eff = 0;
    estimate.note = "needs the tumbles, and the poses show none: " + problem;
  }
}

/// Fills the list of robots: one program from the first frame to the last one.
void fillRobots(RunRecord& record) {
  record.tracks.eachRow([&](const TrackFrame& frame, const TrackRow& row) {
    RobotRecord& robot = record.robots[row.robot];
    if (robot.programs.empty()) robot.programs.push_back({frame.utime, frame.utime, 0});
    robot.programs.front().end_utime = frame.utime;
  });
}

}  // namespace

RunRecord poseRun(PoseFile poses, const std::string& name, const PoseProgram& program,
                  const ReadOptions& options) {
  if (poses.frames.size() < 2) {
    throw ReportError(
        fmt::format("{}: found poses in {}, expected at least two: a single picture has no motion",
                    name, poses.frames.empty() ? "no frame" : "one frame"));
  }
  RunRecord record;
  record.stitched = options.stitch;
  record.experiment = experimentOf(name, program);
  const Experiment& experiment = *record.experiment;
  analysis::ProgramLaw law;
  RunProgram& robots_run = record.programs.emplace_back();
  robots_run.name = "motion";
  robots_run.colour = hexText(kProgramColours.front());
  if (!experiment.programs.empty()) {
    const auto& [name_in_file, first] = *experiment.programs.begin();
    analysis::RobotBody body = analysis::bodyOf(experiment.hardware);
    body.pwm_steps = false;  // the motors that moved the robots are not known
    law = analysis::lawOf(first, body);
    robots_run.program = toId(first);
    robots_run.name = name_in_file;
    robots_run.colour = hexText(programColour(experiment, name_in_file));
  }
  if (!poses.in_arena) adoptExtent(poses, *record.experiment);
  record.poses = PoseSource{.headings = poses.headings,
                            .rows = poses.rows,
                            .without_pose = poses.without_pose,
                            .without_id = poses.without_id,
                            .repeated = poses.repeated,
                            .contradicted = poses.contradicted,
                            .bad_times = poses.bad_times,
                            .clock_steps = static_cast<std::int64_t>(poses.clock_steps.size()),
                            .doubts = unitWarnings(poses)};
  record.log.frames = static_cast<std::int64_t>(poses.frames.size());
  record.missing_frames = poses.missing_frames;
  record.frame_period = poses.frame_period;
  record.start_utime = units::microseconds(poses.frames.front().time);
  record.end_utime = units::microseconds(poses.frames.back().time);
  record.ended = true;

  const bool speed_is_known =
      std::any_of(program.set.begin(), program.set.end(),
                  [](const std::string& set) { return set.starts_with("reversal.speed_cm_s="); });
  PoseFeed(std::move(poses), experiment, law, speed_is_known).run(record, options);
  for (analysis::FeedResult& result : record.results) adoptRuns(result.result);
  fillRobots(record);
  return record;
}

}  // namespace lab::report
