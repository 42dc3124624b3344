#include "analyzer/report/record/run_record.hpp"

#include <algorithm>
#include <set>

#include "analyzer/report/record/crowd_records.hpp"
#include "analyzer/report/record/event_record.hpp"
#include "analyzer/service/collective_feed.hpp"
#include "analyzer/service/program_keys.hpp"
#include "common/bus/channels.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/program_colours.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"

namespace lab::report {
namespace {

/// Stores every pose with what the analysis made of it.
class TrackRecord {
 public:
  explicit TrackRecord(analysis::AnalysisFeed& feed) : feed_(feed) {
    feed_.onFrame([this](int robot, const analysis::FrameReport& frame) {
      collector_.classified(robot, frame);
    });
    feed_.onSample(
        [this](int robot, const analysis::Sample& sample) { collector_.sampled(robot, sample); });
  }

  /// Call it before the analysis takes the frame, whose rows it marks.
  void take(const tracked_frame_t& frame) {
    // Frame numbers are consecutive within one instance of the tracker.
    const std::vector<TrackFrame>& before = collector_.tracks().frames;
    if (!before.empty() && frame.instance == instance_) {
      const std::int64_t gap = frame.frame - before.back().frame - 1;
      if (gap <= kMostMissing) missing_ += std::max<std::int64_t>(0, gap);
    }
    instance_ = frame.instance;
    period_ = frame.frame_period;
    collector_.beginFrame(frame.utime, frame.frame);
    feed_.anchor(frame.utime);
    const double time = feed_.seconds(frame.utime);
    for (const tracked_pose_t& pose : frame.robots) {
      if (collector_.robots() >= analysis::Analysis::kMostRobots &&
          !collector_.knows(pose.robot_id)) {
        continue;
      }
      TrackRow row;
      row.robot = pose.robot_id;
      row.x = static_cast<float>(pose.x);
      row.y = static_cast<float>(pose.y);
      row.theta = static_cast<float>(pose.theta);
      collector_.add(time, row);
    }
  }

  void finish(RunRecord& record) {
    record.tracks = collector_.takeTracks();
    record.missing_frames = missing_;
    record.frame_period = period_;
  }

 private:
  static constexpr std::int64_t kMostMissing = 10'000'000;  // a larger gap is a damaged number

  analysis::AnalysisFeed& feed_;
  TrackCollector collector_;
  std::int64_t instance_ = 0;
  std::int64_t missing_ = 0;
  double period_ = 0;
};

/// Sets the program of every row to the one that its robot reported for that time.
void fillPrograms(RunRecord& record) {
  std::map<std::int32_t, std::size_t> next;
  record.tracks.eachRow([&](const TrackFrame& frame, TrackRow& row) {
    const auto robot = record.robots.find(row.robot);
    if (robot == record.robots.end()) return;
    const std::vector<ProgramSpan>& spans = robot->second.programs;
    std::size_t& at = next[row.robot];
    while (at < spans.size() && spans[at].end_utime < frame.utime) ++at;
    if (at == spans.size()) {
      at = spans.size() - 1;  // frames after the last report
      return;
    }
    if (spans[at].begin_utime <= frame.utime) {
      row.program = static_cast<std::int16_t>(spans[at].program);
    }
  });
}

/// Replayed robots were analyzed in the run that is replayed.
void excludeReplayed(RunRecord& record) {
  std::set<std::int32_t> replayed;
  for (const RobotSpec& robot : record.experimentOrDefault().robots) {
    if (robot.body == Body::kReplay) replayed.insert(robot.id);
  }
  if (replayed.empty()) return;
  record.tracks.rows.each([&](TrackRow& row) {
    if (replayed.contains(row.robot)) row.state = analysis::FrameState::kOther;
  });
}

/// Converts the times of pieces to the time of the record, and sums the corrections of headings.
void fillStitching(const analysis::AnalysisFeed& feed, RunRecord& record) {
  const double start = feed.seconds(record.start_utime);
  for (PieceRecord& one : record.pieces) {
    for (double analysis::Piece::*time :
         {&analysis::Piece::begin, &analysis::Piece::end, &analysis::Piece::reversal_start,
          &analysis::Piece::reversal_end}) {
      one.piece.*time -= start;
    }
  }
  for (const int robot : feed.robots()) {
    const analysis::StitcherCounters counters = feed.robotCounters(robot);
    record.headings.flips += counters.flips;
    record.headings.jumps += counters.flip_jumps;
    record.headings.sense_turns += counters.sense_turns;
  }
}

/// Sets the experiment from the START event.
void adoptStart(const std::optional<experiment_event_t>& start, RunRecord& record) {
  if (!start) {
    record.experiment_problem = "the log has no START: names and parameters of the run are unknown";
    return;
  }
  record.experiment_text = start->text;
  try {
    record.experiment = parseExperiment(start->text, "experiment in the log");
  } catch (const ExperimentError& error) {
    record.experiment_problem =
        "the experiment in the log cannot be read: " + error.problems().front();
  }
}

}  // namespace

double RunRecord::seconds(std::int64_t utime) const { return units::seconds(utime - start_utime); }

const Experiment& RunRecord::experimentOrDefault() const {
  static const Experiment none;
  return experiment ? *experiment : none;
}

std::string RunRecord::programNameOf(int key) const {
  const auto index = static_cast<std::size_t>(key);
  return key >= 0 && index < programs.size() ? programs[index].name : std::string();
}

RunRecord readRun(const std::vector<std::filesystem::path>& files, const ReadOptions& options) {
  const analysis::Depth depth = options.depth;
  RunRecord record;
  adoptStart(findStart(files), record);
  const Experiment& experiment = record.experimentOrDefault();

  analysis::AnalysisFeed feed(experiment);
  if (depth == analysis::Depth::kFull) feed.findRuns();
  feed.wholeMotion();
  feed.stitch(options.stitch, depth == analysis::Depth::kFull);
  feed.freeTimes(options.free_times);
  analysis::ProgramKeys keys;
  record.stitched = options.stitch;
  feed.onPiece([&](int robot, const program_id_t& program, const analysis::Piece& piece) {
    record.pieces.push_back({robot, keys.key(program), piece});
  });
  analysis::CollectiveFeed crowd(experiment);
  TrackRecord tracks(feed);
  LightTimeline light(experiment.arena_width, experiment.arena_height);
  RobotTimelines robots([&keys](const program_id_t& program) { return keys.key(program); });
  EventRecord events;
  ServiceRecords services;
  LinkRecords links;
  SenseRecords senses;

  MessageSinks sinks;
  sinks.frame = [&](const tracked_frame_t& frame) {
    crowd.take(frame);
    tracks.take(frame);
    feed.take(frame);
  };
  sinks.robots = [&](const robot_status_t& status) {
    robots.take(status);
    feed.take(status);
    crowd.take(status);
  };
  sinks.light = [&](const light_status_t& status) {
    light.take(status);
    feed.take(status);
  };
  sinks.command = [&](const robot_command_t& command) { feed.take(command); };
  sinks.event = [&](const experiment_event_t& event) { events.take(event); };
  sinks.service = [&](const service_status_t& status) { services.take(status); };
  sinks.link = [&](const link_status_t& status) { links.take(status); };
  sinks.senses = [&](const robot_senses_t& message) { senses.take(message); };
  record.log = readMessages(files, sinks);
  feed.flush();

  tracks.finish(record);
  record.light = light.spans();
  record.calibration = light.calibration();
  record.robots = robots.records();
  std::size_t unnamed = 0;  // programs of the log that the experiment does not name
  for (std::size_t key = 0; key < keys.programs().size(); ++key) {
    const program_id_t& program = keys.programs()[key];
    std::string name = programName(experiment, program);
    const bool taken = std::ranges::any_of(
        record.programs, [&](const RunProgram& other) { return other.name == name; });
    if (taken) name += " " + std::to_string(key + 1);
    if (!experiment.programs.contains(name)) ++unnamed;
    record.programs.push_back(
        {program, name, hexText(programColour(experiment, name, unnamed - 1))});
  }
  fillPrograms(record);
  excludeReplayed(record);
  record.results = feed.results(depth);
  events.finish(record);
  fillStitching(feed, record);
  fillCrowds(
      crowd.analysis(), crowd.seconds(record.start_utime),
      [&](int group) { return keys.key(crowd.programOf(group)); }, record);
  record.left_out = feed.counters().left_out;
  if (feed.refused() > 0) {
    RefusedMessages& refused = record.log.refused[std::string(channels::kRobotStatus)];
    if (refused.first.empty()) refused.first = feed.refusal();
    refused.count += feed.refused();
  }
  services.finish(record);
  record.links = links.records();
  record.senses = senses.records(experiment.senses);
  return record;
}

Percentiles senseDelays(const RunRecord& record) {
  std::vector<double> delays;
  for (const auto& [id, robot] : record.robots) {
    delays.insert(delays.end(), robot.sense_delays_ms.begin(), robot.sense_delays_ms.end());
  }
  return percentilesOf(std::move(delays));
}

}  // namespace lab::report
