/// Everything that a closed log says about a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/log_source.hpp"
#include "analyzer/report/record/link_records.hpp"
#include "analyzer/report/record/timelines.hpp"
#include "common/calibration/light_file.hpp"
#include "common/experiment/experiment.hpp"

namespace lab::report {

/// One showing of one step of the light script. Times in us since 1970, 0: never.
struct StepRecord {
  int number = 0;
  std::string label;
  std::int64_t commanded_utime = 0;
  std::int64_t presented_utime = 0;
  std::int64_t seen_utime = 0;
  std::int64_t first_acted_utime = 0;
  std::int64_t last_acted_utime = 0;
  int robots_acted = 0;
  int robots_expected = 0;
  std::string ended_by;  ///< what ended the step before it, empty: its time was up
};

/// A fault or a mark.
struct Remark {
  std::int64_t utime = 0;
  std::string text;
};

/// One start of one service.
struct ServiceRecord {
  std::string name;
  int start = 1;  ///< counts the service's starts from 1
  std::string version;
  std::int8_t origin = 0;
  bool ended = false;  ///< said so; false: killed, or the log ends before
  std::string last_error;
};

/// What a service missed of another one, as it said last.
struct ListenerLoss {
  std::string listener;
  std::string channel;
  std::string sender;  ///< empty: decode errors of any sender
  std::int64_t lost = 0;
  std::int64_t decode_errors = 0;
};

/// One robot in one frame, as tracked.
struct TrackRow {
  std::int32_t robot = 0;
  float x = 0;                ///< [m]
  float y = 0;                ///< [m]
  float theta = 0;            ///< [rad]
  std::int16_t program = -1;  ///< key into RunRecord::programs, -1: none that is known
  std::int32_t segment = -1;  ///< stretch of free motion, counted from 0 per robot; -1: not free
};

struct TrackFrame {
  std::int64_t utime = 0;
  std::int64_t frame = 0;
  std::size_t first_row = 0;  ///< into Tracks::rows
};

/// Every tracked pose of the run, frame by frame.
struct Tracks {
  std::vector<TrackFrame> frames;
  std::vector<TrackRow> rows;

  /// Behind the last row of frames[i].
  [[nodiscard]] std::size_t endOf(std::size_t i) const {
    return i + 1 < frames.size() ? frames[i + 1].first_row : rows.size();
  }
};

/// A program as the run knew it.
struct RunProgram {
  program_t program{};
  std::string name;  ///< of the experiment file, else of the model
};

/// Where a run without a lab comes from: a file of poses.
struct PoseSource {
  bool headings = false;          ///< it says where robots head
  std::int64_t rows = 0;          ///< of the file
  std::int64_t without_pose = 0;  ///< of these, rows without numbers
  std::int64_t without_id = 0;    ///< of these, rows that belong to no track
  std::int64_t repeated = 0;      ///< of these, rows that say another one again
  std::int64_t contradicted = 0;  ///< poses left out: a robot in two places at once
  std::int64_t in_contact = 0;    ///< of these, poses that touch a robot or a wall
  std::int64_t reversals = 0;     ///< found
  std::int64_t bad_times = 0;     ///< frames left out: their times go back
  std::int64_t clock_steps = 0;   ///< where the track was cut
  /// Of the units of headings and times.
  std::vector<std::string> doubts;
};

/// A stretch of free motion of one robot, times in s since the start.
struct PieceRecord {
  int robot = 0;
  int program = -1;  ///< key into RunRecord::programs
  analysis::Piece piece;
};

/// Headings that were off by pi, over all robots.
struct HeadingRecord {
  std::int64_t flips = 0;        ///< headings turned round
  std::int64_t jumps = 0;        ///< jumps by pi that were mended
  std::int64_t sense_turns = 0;  ///< tracks whose head was the tail
};

struct RunRecord {
  std::optional<PoseSource> poses;       ///< where there is no log
  std::optional<Experiment> experiment;  ///< as run; nothing: the log has no readable START
  std::string experiment_text;           ///< the effective file
  std::string experiment_problem;        ///< why it is not there
  std::string version;                   ///< of the software that ran it
  int contract_version = 0;
  LogFacts log;

  std::int64_t start_utime = 0;  ///< time 0 of the report: the light script's start
  std::int64_t end_utime = 0;
  bool ended = false;  ///< has an END
  std::string end_reason;

  std::vector<StepRecord> steps;
  std::vector<Remark> faults;
  std::vector<Remark> marks;
  std::vector<LightSpan> light;
  std::string calibration;                            ///< of the projector, empty: none
  std::optional<LightCalibration> light_calibration;  ///< that the robots' bands went by
  std::map<std::int32_t, RobotRecord> robots;
  std::vector<ServiceRecord> services;
  std::vector<ListenerLoss> listeners;
  std::vector<LinkRecord> links;

  Tracks tracks;
  std::int64_t missing_frames = 0;  ///< numbers that the camera counted and the log has not
  double frame_period = 0;          ///< [s] nominal
  std::vector<PieceRecord> pieces;  ///< of free motion
  HeadingRecord headings;
  bool stitched = true;              ///< reversals were joined, not cut
  std::vector<RunProgram> programs;  ///< by key
  std::vector<analysis::FeedResult> results;

  /// Seconds since the start.
  [[nodiscard]] double seconds(std::int64_t utime) const;
  [[nodiscard]] double duration() const { return seconds(end_utime); }
  [[nodiscard]] const Experiment& experimentOrDefault() const;
  [[nodiscard]] std::string programNameOf(int key) const;
};

/// How a run is analyzed.
struct ReadOptions {
  analysis::Depth depth = analysis::Depth::kFull;
  bool stitch = true;  ///< false: reversals cut
};

/// Reads the log once, and analyzes it on the way.
/// @throws ReportError when it was written under another contract.
[[nodiscard]] RunRecord readRun(const std::vector<std::filesystem::path>& files,
                                const ReadOptions& options = {});

}  // namespace lab::report
