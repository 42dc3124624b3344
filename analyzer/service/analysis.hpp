#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

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

/// A camera frame. The frame number is kept for people; windows go by time.
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
  /// Fills ProgramResult::runs. Keeps up to 20 places a second of every RTP, 3 MB an hour, so it is
  /// for recordings that end, not for live displays.
  bool find_runs = false;
  bool samples_only = false;  ///< Tracks are stitched and passed on; there are no results.
  bool without_law =
      false;  ///< Robots with no program (kNone) are analysed: curves, and their speed.
};

struct AnalysisCounters {
  std::int64_t frames = 0;  ///< Camera frames received.
  std::int64_t duplicate_robots =
      0;                       ///< Poses dropped since their robot was seen twice in a frame.
  std::int64_t telemetry = 0;  ///< Telemetry of robots received.
};

/// The physics of a whole lab: takes camera frames and telemetry of many robots in the order in
/// which they arrive, and gives curves, estimates and verdicts at any time. Online and offline are
/// the same calls.
class Analysis {
 public:
  explicit Analysis(const AnalysisConfig& config) : config_(config) {}

  /// Takes a frame. A robot seen twice in it is dropped from it.
  void addFrame(const Frame& frame);

  /// Takes the telemetry of one robot and the law of the program it runs; telemetry.program is set
  /// here. Standing and constant wheel speeds have no law and are not analysed.
  void addTelemetry(int robot, const ProgramLaw& law, RobotTelemetry telemetry);

  /// End of data: judges what still waits for telemetry.
  void flush();

  /// Says whether the light depends on place. Then a robot leaves its program by where it goes, and
  /// the windows of lags comparable to its stay are selected by the motion: lags above 0.1 of the
  /// median stay are marked and get no verdict. Once set for a recording it stays.
  void setSpatialLight(bool spatial) { spatial_light_ = spatial_light_ || spatial; }

  /// Every sample that enters the statistics, for trajectory files.
  void onSample(std::function<void(int robot, const ProgramLaw& law, const Sample&)> sink) {
    sink_ = std::move(sink);
  }

  /// Every piece of free motion once it has ended (the last ones from flush()), in time order for
  /// each robot.
  void onPiece(std::function<void(int robot, const ProgramLaw& law, const Piece&)> sink) {
    piece_sink_ = std::move(sink);
  }

  /// Before the first frame: whether the motion around reversals is joined or cut, and whether
  /// windows across joins are compared with those within pieces (AnalysisConfig::compare_joins).
  void stitch(bool join, bool compare) {
    config_.stitcher.join = join;
    config_.compare_joins = compare;
  }

  /// As AnalysisConfig::find_runs; to be said before the first frame.
  void findRuns() { config_.find_runs = true; }

  /// As AnalysisConfig::samples_only; to be said before the first frame.
  void samplesOnly() { config_.samples_only = true; }

  /// Per program with a law, in the order of first appearance: the pool of all its robots, then
  /// each robot by number. Programs without a sample are left out.
  [[nodiscard]] std::vector<ProgramResult> results(Depth depth = Depth::kLive) const;

  /// The programs in the order of first appearance; Sample::program is an index into them.
  [[nodiscard]] const std::vector<ProgramLaw>& programs() const { return programs_; }
  [[nodiscard]] const AnalysisCounters& counters() const { return counters_; }
  /// Of one robot; zeros for one that never appeared.
  [[nodiscard]] StitcherCounters robotCounters(int robot) const;
  [[nodiscard]] std::vector<int> robots() const;
  /// The median stay of robots in a program before they left it, s; 0: none has left.
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

  Robot& robotOf(int id);
  int programOf(const ProgramLaw& law);
  void recordDwellTime(Robot& robot, const RobotTelemetry& telemetry);
  void dispatch(const Frame& frame);
  void measurePeriod(bool force);
  void take(int id, Robot& robot);

  AnalysisConfig config_;
  AnalysisCounters counters_;
  std::map<int, Robot> robots_;
  std::vector<ProgramLaw> programs_;
  std::vector<std::vector<float>> dwell_times_;  ///< Per program, s.
  std::vector<Frame> first_frames_;              ///< Wait until the frame period is known.
  std::vector<Sample> samples_;
  bool spatial_light_ = false;
  std::function<void(int, const ProgramLaw&, const Sample&)> sink_;
  std::function<void(int, const ProgramLaw&, const Piece&)> piece_sink_;
};

}  // namespace lab::analysis
