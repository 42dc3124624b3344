#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analyzer/bootstrap/film_reference.hpp"
#include "analyzer/service/program_analysis.hpp"

namespace lab::analysis {

/// One robot of a camera frame.
struct FramePose {
  int robot = 0;
  double x = 0;            ///< m.
  double y = 0;            ///< m.
  double theta = 0;        ///< rad.
  double sigma = 0;        ///< Standard error of x and of y, m; 0: unknown.
  double sigma_theta = 0;  ///< rad; 0: unknown.
  bool valid = true;
};

/// A camera frame. The frame number is only for display; windows are defined by time.
struct Frame {
  double time = 0;  ///< Middle of the exposure, s.
  std::int64_t frame = 0;
  std::vector<FramePose> poses;
};

struct AnalysisConfig {
  double frame_period = 0;  ///< Nominal, s; 0: the median of the first frames.
  double max_lag = 100;     ///< s; bounds the memory.
  StitcherConfig stitcher;
  CurveOptions curves;
  bool compare_joins = false;  ///< Fills ProgramResult::joins; doubles the work of a frame.
  /// Fills ProgramResult::runs. Keeps up to 20 positions per second of programs with runs (3 MB per
  /// hour), so it is for closed recordings, not for live displays.
  bool find_runs = false;
  /// Fills ProgramResult::whole, also of programs without free motion; doubles the work of a frame.
  bool whole_motion = false;
  bool samples_only = false;  ///< Tracks are stitched and output as samples; there are no results.
  bool without_law =
      false;  ///< Robots without a program (kNone) are analysed too: curves and speed.
};

struct AnalysisCounters {
  std::int64_t frames = 0;  ///< Camera frames received.
  std::int64_t duplicate_robots =
      0;                       ///< Poses dropped because their robot appears twice in a frame.
  std::int64_t telemetry = 0;  ///< Telemetry messages received.
  std::int64_t left_out = 0;   ///< Poses and telemetry of robots and programs beyond the limits.
};

/// The analysis of a whole lab: takes camera frames and telemetry of many robots in the order of
/// arrival, and gives curves, estimates and verdicts at any time. The calls are the same online and
/// offline.
class Analysis {
 public:
  /// More than any lab has; what exceeds them is left out and counted. A program of a robot takes
  /// up to 150 kB.
  static constexpr std::size_t kMostRobots = 1000;
  static constexpr std::size_t kMostPrograms = 100;   ///< as in an experiment file
  static constexpr std::size_t kMostOfRobots = 4000;  ///< programs, summed over the robots

  explicit Analysis(const AnalysisConfig& config) : config_(config) {}

  /// Takes a frame. A robot that appears twice in it is dropped from it.
  void addFrame(const Frame& frame);

  /// Takes the telemetry of one robot and the law of the program it runs; telemetry.program is set
  /// by this function. Standing and constant wheel speeds have no law and are not analysed.
  void addTelemetry(int robot, const ProgramLaw& law, RobotTelemetry telemetry);

  /// End of data: processes the frames that still wait for telemetry.
  void flush();

  /// Sets whether the light depends on the position. Then the motion determines when a robot leaves
  /// its program, which selects the windows of lags comparable to its dwell time: lags above 0.1 of
  /// the median dwell time are marked and not judged. Once true, it remains true.
  void setSpatialLight(bool spatial) { spatial_light_ = spatial_light_ || spatial; }

  /// Called with every sample of the statistics, for trajectory files.
  void onSample(std::function<void(int robot, const ProgramLaw& law, const Sample&)> sink) {
    sink_ = std::move(sink);
  }

  /// Called with every piece of free motion after its end (the last ones from flush()), in time
  /// order for each robot.
  void onPiece(std::function<void(int robot, const ProgramLaw& law, const Piece&)> sink) {
    piece_sink_ = std::move(sink);
  }

  /// Called with every frame that was classified, in time order for each robot; the frames whose
  /// pose or time is invalid are left out. Its sample, if it has one, follows. Call it before the
  /// first frame.
  void onFrame(std::function<void(int robot, const FrameReport& frame)> sink) {
    frame_sink_ = std::move(sink);
    config_.stitcher.report_frames = true;
  }

  /// Sets AnalysisConfig::whole_motion. Call it before the first frame.
  void wholeMotion() {
    config_.whole_motion = true;
    config_.stitcher.report_frames = true;
  }

  /// Simulates some more films of each program whose reference must be simulated
  /// (Law::isSimulated), for the verdicts of Depth::kLive. A call takes some tens of milliseconds;
  /// after about fifteen, the references are complete. Depth::kFull does not need it.
  void simulateReferences();

  /// Sets whether the track is joined or cut at reversals, and AnalysisConfig::compare_joins. Call
  /// it before the first frame.
  void stitch(bool join, bool compare) {
    config_.stitcher.join = join;
    config_.compare_joins = compare;
  }

  /// Durations that fits free (FitOptions::free_times).
  void freeTimes(const std::vector<std::string>& names) { config_.curves.free_times = names; }

  /// Sets AnalysisConfig::find_runs. Call it before the first frame.
  void findRuns() { config_.find_runs = true; }

  /// Sets AnalysisConfig::samples_only. Call it before the first frame.
  void samplesOnly() { config_.samples_only = true; }

  /// Per program with a law, in the order of first appearance: the pool of all its robots, then
  /// each robot by number. Programs without a sample are left out, unless the whole motion is
  /// wanted.
  /// @param meanwhile called after each robot, because hundreds of them take seconds; may be empty
  [[nodiscard]] std::vector<ProgramResult> results(
      Depth depth = Depth::kLive, const std::function<void()>& meanwhile = {}) const;

  /// The programs in the order of first appearance; Sample::program is an index into them.
  [[nodiscard]] const std::vector<ProgramLaw>& programs() const { return programs_; }
  [[nodiscard]] const AnalysisCounters& counters() const { return counters_; }
  /// Counters of one robot; zeros if it is unknown.
  [[nodiscard]] StitcherCounters robotCounters(int robot) const;
  [[nodiscard]] std::vector<int> robots() const;
  /// The median dwell time of robots in a program, s; 0: no robot has left it.
  [[nodiscard]] double medianDwellTime(int program) const;

 private:
  struct Robot {
    explicit Robot(const StitcherConfig& config) : stitcher(config) {}
    TrackStitcher stitcher;
    std::map<int, std::unique_ptr<ProgramAnalysis>> programs;
    std::int64_t epoch = -1;
    int program = -1;
    double program_start = 0;
  };

  Robot* robotOf(int id);  ///< nullptr: beyond the limit
  int programOf(const ProgramLaw& law);
  void recordDwellTime(Robot& robot, const RobotTelemetry& telemetry);
  void dispatch(const Frame& frame);
  void measurePeriod(bool force);
  void take(int id, Robot& robot);
  [[nodiscard]] std::vector<ProgramResult> programResults(
      int program, Depth depth, const CurveOptions& options,
      const std::function<void()>& meanwhile) const;
  /// The last result, or a new one if it is not of these samples.
  ProgramResult liveResult(LiveResult& last, int program, std::int64_t samples,
                           const ProgramTally& tally, const CurveOptions& options,
                           const std::function<const BlockData&()>& data) const;
  void takeReports(int id, Robot& robot);
  /// nullptr: beyond the limit.
  ProgramAnalysis* analysisOf(Robot& robot, int program);
  void judgeLive(int program, const BlockData& data, const CurveOptions& options,
                 ProgramResult& result) const;

  AnalysisConfig config_;
  AnalysisCounters counters_;
  std::map<int, Robot> robots_;
  std::vector<ProgramLaw> programs_;
  std::vector<std::vector<float>> dwell_times_;  ///< Per program, s.
  std::size_t of_robots_ = 0;                    ///< Programs, summed over the robots.
  std::vector<Frame> first_frames_;  ///< Frames that wait until the frame period is known.
  std::vector<Sample> samples_;
  std::vector<int> frame_robots_;            ///< Kept to reuse its memory.
  std::map<int, FilmReference> references_;  ///< By program.
  mutable std::map<int, LiveResult> pools_;  ///< The last ones, by program.
  bool spatial_light_ = false;
  std::function<void(int, const ProgramLaw&, const Sample&)> sink_;
  std::function<void(int, const ProgramLaw&, const Piece&)> piece_sink_;
  std::function<void(int, const FrameReport&)> frame_sink_;
};

}  // namespace lab::analysis
