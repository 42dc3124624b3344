/// Everything that a closed log contains about a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/collective/crowd_analysis.hpp"
#include "analyzer/log_source.hpp"
#include "analyzer/report/record/link_records.hpp"
#include "analyzer/report/record/sense_records.hpp"
#include "analyzer/report/record/timelines.hpp"
#include "analyzer/report/record/track_rows.hpp"
#include "common/calibration/light_file.hpp"
#include "common/camera/run_film.hpp"
#include "common/experiment/experiment.hpp"
#include "common/math/percentiles.hpp"

namespace lab::report {

/// One presentation of one step of the light script. Times in us since 1970; 0: never.
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
  std::string ended_by;  ///< what ended the previous step; empty: its duration
};

/// A fault or a mark.
struct Remark {
  std::int64_t utime = 0;
  std::string text;
};

/// One start of one service.
struct ServiceRecord {
  std::string name;
  int start = 1;  ///< number of the start of the service, from 1
  std::string version;
  std::int8_t origin = 0;
  bool ended = false;  ///< reported its end; false: killed, or the log ends earlier
  std::string last_error;
};

/// Messages of another service that a service missed, by its last report.
struct ListenerLoss {
  std::string listener;
  std::string channel;
  std::string sender;  ///< empty: decode errors of any sender
  std::int64_t lost = 0;
  std::int64_t decode_errors = 0;
};

/// A robot's serial line, by the last report of robot_bridge.
struct SerialLine {
  std::string text;  ///< the robot, its restarts, the programs that it loaded and how long it took
  std::int64_t received = 0;
  std::int64_t lost = 0;
  std::int64_t decode_errors = 0;
};

/// A program of the run.
struct RunProgram {
  program_id_t program{};
  std::string name;                ///< name in the experiment file, else that of its definition
  std::string colour = "#9A9A9A";  ///< as in the dashboard
};

/// The source of a run without a log: a file of poses.
struct PoseSource {
  bool headings = false;          ///< the file has headings
  std::int64_t rows = 0;          ///< rows in the file
  std::int64_t without_pose = 0;  ///< of these, rows without a position or heading
  std::int64_t without_id = 0;    ///< of these, rows that belong to no track
  std::int64_t repeated = 0;      ///< of these, rows that repeat another one
  std::int64_t contradicted = 0;  ///< poses omitted: a robot at two positions at the same time
  std::int64_t in_contact = 0;    ///< of these, poses that touch a robot or a wall
  std::int64_t reversals = 0;     ///< found
  std::int64_t bad_times = 0;     ///< frames omitted: their times do not increase
  std::int64_t clock_steps = 0;   ///< steps of the clock, at which tracks are cut
  /// Doubts about the units of headings and times.
  std::vector<std::string> doubts;
};

/// A piece of free motion of one robot, times in s since the start.
struct PieceRecord {
  int robot = 0;
  int program = -1;  ///< key into RunRecord::programs
  analysis::Piece piece;
};

/// Headings that were wrong by pi, over all robots.
struct HeadingRecord {
  std::int64_t flips = 0;        ///< headings flipped
  std::int64_t jumps = 0;        ///< jumps by pi that were corrected
  std::int64_t sense_turns = 0;  ///< tracks in which head and tail were confused
};

/// What a group of robots did together.
struct CrowdRecord {
  int program = -1;  ///< key into RunRecord::programs; -1: all robots
  collective::CrowdResult result;
  std::vector<collective::Stretch> stretches;  ///< times in s since the start
  collective::CrowdMap map;
};

struct RunRecord {
  std::optional<PoseSource> poses;       ///< if the source is a file of poses
  std::optional<Experiment> experiment;  ///< the experiment; nullopt: the log has no readable START
  std::string experiment_text;           ///< text of the effective experiment file
  std::string experiment_problem;        ///< why there is no experiment
  std::string version;                   ///< version of the software of the run
  int contract_version = 0;
  LogFacts log;
  std::vector<FilmFacts> films;  ///< of the run: of each camera, for each start of the tracker
  std::string film_note;         ///< how the poses were tracked again; empty: they are the run's
  bool film_stills = false;      ///< film.jpg lies beside the report
  bool film_clip = false;        ///< film.mp4 does

  std::int64_t start_utime = 0;  ///< time 0 of the report: start of the light script
  std::int64_t end_utime = 0;
  bool ended = false;  ///< the log has an END event
  std::string end_reason;

  std::vector<StepRecord> steps;
  std::vector<Remark> faults;
  std::vector<Remark> marks;
  std::vector<LightSpan> light;
  std::string calibration;  ///< id of the projector calibration; empty: none
  std::optional<LightCalibration> light_calibration;  ///< light calibration of the run
  std::map<std::int32_t, RobotRecord> robots;
  std::vector<ServiceRecord> services;
  std::vector<ListenerLoss> listeners;
  std::vector<SerialLine> serial_lines;
  std::vector<LinkRecord> links;
  std::vector<SenseRecord> senses;  ///< by their numbers

  Tracks tracks;
  std::int64_t left_out = 0;        ///< reports of robots and programs beyond the limits
  std::int64_t missing_frames = 0;  ///< frame numbers of the camera that are missing in the log
  double frame_period = 0;          ///< [s] nominal
  std::vector<PieceRecord> pieces;  ///< pieces of free motion
  HeadingRecord headings;
  bool stitched = true;              ///< tracks were joined at reversals, not cut
  std::vector<RunProgram> programs;  ///< indexed by key
  std::vector<analysis::FeedResult> results;
  std::vector<CrowdRecord> crowds;         ///< all robots, then programs; empty below two robots
  collective::CrowdPicture crowd_picture;  ///< the last evaluated frame
  std::int64_t crowd_left_out = 0;         ///< poses that are not in the collective numbers
  std::int64_t crowd_most = 0;             ///< robots in the fullest frame

  /// Seconds since the start.
  [[nodiscard]] double seconds(std::int64_t utime) const;
  [[nodiscard]] double duration() const { return seconds(end_utime); }
  [[nodiscard]] const Experiment& experimentOrDefault() const;
  [[nodiscard]] std::string programNameOf(int key) const;
};

/// Options of the analysis.
struct ReadOptions {
  analysis::Depth depth = analysis::Depth::kFull;
  bool stitch = true;                        ///< false: cut at reversals
  std::vector<std::string> free_times = {};  ///< durations that fits free
};

/// Reads the log once and analyzes it.
/// @throws ReportError if it was written under another contract version.
[[nodiscard]] RunRecord readRun(const std::vector<std::filesystem::path>& files,
                                const ReadOptions& options = {});

/// Delays of the virtual senses of all robots, from the exposure of the frame to the reception by
/// the robot [ms].
[[nodiscard]] Percentiles senseDelays(const RunRecord& record);

}  // namespace lab::report
