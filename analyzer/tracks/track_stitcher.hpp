#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "analyzer/tracks/flip_filter.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {

/// One robot in one camera frame: SI units, arena frame.
struct TrackPoint {
  double time = 0;         ///< Middle of the exposure, s.
  std::int64_t frame = 0;  ///< Number of the camera frame.
  double x = 0;            ///< m.
  double y = 0;            ///< m.
  double theta = 0;        ///< rad, any branch.
  double sigma = 0;        ///< Standard error of x and of y, m; 0: unknown.
  double sigma_theta = 0;  ///< Standard error of theta, rad; 0: unknown.
  bool valid = true;       ///< False: the tracker marked the pose as unreliable.
};

/// The state that one robot reports for one time. Every message has the complete state, so the next
/// one replaces a lost one.
struct RobotTelemetry {
  double time = 0;                  ///< Time of sampling, on the clock of the frames, s.
  int program = -1;                 ///< The caller's key of the program; -1: standing.
  std::int64_t program_epoch = 0;   ///< Counts the starts of programs; each start draws anew.
  double program_start = 0;         ///< Beginning of this epoch, s.
  std::int64_t reversal_count = 0;  ///< Reversals begun.
  double reversal_start = 0;        ///< Of the last reversal, s.
  double reversal_end = 0;          ///< Of the last reversal, s; ignored while reversing.
  /// Displacement of the last reversal, m, if it was found in the poses (examineTrack()); nan: the
  /// free motion around it is computed from the held wheel speeds.
  double reversal_dx = units::kNan;
  double reversal_dy = units::kNan;
  bool reversing = false;
  double v_l = 0;              ///< The program's held wheel speeds, also while
  double v_r = 0;              ///< reversing, m/s.
  bool contact = false;        ///< Touches another robot or a wall.
  bool contact_robot = false;  ///< Touches a robot; only reported, not used.
  bool contact_wall = false;   ///< Touches a wall; only reported, not used.
  float light_front = static_cast<float>(units::kNan);  ///< Sensor readings, 0 to 1; nan: unknown.
  float light_back = static_cast<float>(units::kNan);
  bool stopped = false;           ///< Stopped by a command.
  std::int64_t tumble_count = 0;  ///< Tumbles begun.
  double run_time = 0;            ///< Time spent in runs, reversals excluded, s.
  double sense_distance = 0;      ///< See senseDistance(), m.
};

/// One point of the free motion. Free time and stitched coordinates are comparable only within a
/// segment.
struct Sample {
  double time = 0;       ///< Camera time, s.
  double free_time = 0;  ///< Camera time without the reversals, s.
  std::int64_t frame = 0;
  double x = 0;             ///< Stitched, m.
  double y = 0;             ///< Stitched, m.
  double theta = 0;         ///< Unwrapped, rad; nan: unknown.
  int segment = 0;          ///< No window may cross a change of segment.
  int angular_segment = 0;  ///< No angular window may cross a change of this one.
  int piece =
      0;  ///< Also changes where a reversal was removed; within a piece, frames are equally spaced.
  int program = -1;  ///< The caller's key.
  std::int64_t tumble_count = 0;
  double run_time = 0;  ///< s.
};

/// What a robot did in a frame.
enum class FrameState : std::uint8_t {
  kFree,       ///< In the statistics.
  kReversing,  ///< Turns back from an obstacle.
  kContact,    ///< Touches a robot or a wall, or did so shortly before or after.
  kStopped,    ///< Stopped by a command or by the end of its lease.
  kLost,       ///< The pose, the robot's state or the times of a reversal are not known.
  kOther,      ///< Runs no program of motion.
};

/// A frame of a robot as it was classified, whether or not it is in the statistics. SI units.
struct FrameReport {
  double time = 0;  ///< Camera time, s.
  double x = 0;     ///< As tracked, m.
  double y = 0;
  double theta = 0;        ///< rad, any branch; nan: unknown.
  int program = -1;        ///< The caller's key.
  std::int64_t epoch = 0;  ///< Of the program.
  FrameState state = FrameState::kLost;
  bool contact_robot = false;  ///< As the robot reported at the time next to the frame's.
  bool contact_wall = false;
  float light_front = static_cast<float>(units::kNan);
  float light_back = static_cast<float>(units::kNan);
};

/// Limits of the robots, and waiting times.
struct StitcherConfig {
  double reorder_delay = 0.5;   ///< Longest wait of a frame for telemetry, s.
  double contact_guard = 0.1;   ///< Time that is cut before and after a contact, s.
  double reversal_guard = 0.0;  ///< Frames closer to a reversal are dropped, s.
  double max_join_gap =
      0.3;  ///< Longest free time around a reversal that is computed from the held wheel speeds, s.
  double max_angular_gap = 0.3;   ///< After a longer gap the heading is ambiguous, s.
  double max_wheel_speed = 0.27;  ///< m/s.
  double wheel_base = 0.075;      ///< m.
  bool headings = true;           ///< False: theta of the frames is not used.
  bool join = true;               ///< False: reversals are removed, and the track is cut there.
  bool report_frames = false;     ///< Fills TrackStitcher::takeReports().
};

/// Reason for the end of a piece of free motion.
enum class PieceEnd : std::uint8_t {
  kJoined,         ///< A reversal was removed, and the motion after it joined.
  kNotJoined,      ///< A reversal was removed, and the track cut (StitcherConfig::join is false).
  kLostReversal,   ///< A reversal with unknown times, or without frames close to it.
  kProgramSwitch,  ///< Another program, or a restart of the same one.
  kContact,        ///< Touches another robot.
  kStop,           ///< Standing, or stopped by a command.
  kJump,           ///< Two or more frames agree with each other and not with the track.
  kClockSetBack,   ///< The time stamps of the camera were set back.
  kClockStep,      ///< The clock of a file of poses jumped.
  kEnd,            ///< End of data.
};

/// A stretch of free motion without a gap. SI units.
struct Piece {
  int program = -1;  ///< As in the samples.
  int segment = 0;
  int piece = 0;
  double begin = 0;  ///< Camera time of the first frame, s.
  double end = 0;    ///< Camera time of the last frame, s.
  std::int64_t frames = 0;
  PieceEnd reason = PieceEnd::kEnd;
  /// The reversal that ended the piece, if it was joined; else nan.
  double reversal_start = units::kNan;  ///< s.
  double reversal_end = units::kNan;    ///< s.
  double dx = units::kNan;              ///< Displacement removed from the track, m.
  double dy = units::kNan;              ///< m.
  /// Change of the heading between the frames around the reversal, rad. It stays in the track: the
  /// robot keeps its heading while it reverses, and the free motion before and after turned it.
  double rotation = units::kNan;
};

/// Counts of the frames, over all programs.
struct StitcherCounters {
  std::int64_t frames = 0;        ///< Received.
  std::int64_t samples = 0;       ///< Output as samples.
  std::int64_t invalid = 0;       ///< Not finite, or marked invalid.
  std::int64_t out_of_order = 0;  ///< Time stamp repeated or earlier.
  std::int64_t uncovered = 0;     ///< No telemetry covers their time.
  std::int64_t standing = 0;      ///< No program, or stopped.
  std::int64_t in_reversal = 0;
  std::int64_t in_contact = 0;
  std::int64_t outliers = 0;        ///< Not reachable by the wheels.
  std::int64_t bad_telemetry = 0;   ///< Repeated, too late or not finite.
  std::int64_t jumps = 0;           ///< Cuts at an unmarked jump.
  std::int64_t lost_reversals = 0;  ///< Cuts at reversals whose times were lost.
  std::int64_t reversals = 0;       ///< Removed and joined.
  std::int64_t flips = 0;           ///< Headings flipped, because head and tail were confused.
  std::int64_t flip_jumps = 0;      ///< Jumps of the heading by pi that were corrected.
  std::int64_t sense_turns = 0;     ///< Times that the motion showed head and tail to be confused.
};

/// Counts of one program.
struct ProgramTally {
  std::int64_t samples = 0;
  std::int64_t in_contact = 0;   ///< Frames cut for a contact.
  std::int64_t in_reversal = 0;  ///< Frames in reversals.
  std::int64_t stopped = 0;      ///< Frames in which the robot was stopped.
  std::int64_t lost = 0;         ///< Frames without telemetry, and outliers.
  std::int64_t segments = 0;
  std::int64_t reversals = 0;  ///< Removed and joined.

  ProgramTally& operator+=(const ProgramTally& other);
};

/// Appendix B of the paper, online, for one robot: removes the reported reversals from its track
/// and joins the free motion around them. The robot resumes exactly (it keeps timers, wheel speeds
/// and heading), so the statistics of the stitched track are those of free motion.
///
/// Flipped headings are corrected first (FlipFilter), also while reversing. Frames and telemetry
/// may be interleaved in any way. A frame is classified when telemetry at or after its time is
/// known, or after reorder_delay. During a reversal, frames are dropped and free time stops; the
/// motion between the last frame before it and the first one after it is computed from the held
/// wheel speeds. A new segment begins at a new program epoch, a contact, a stop, a jump that the
/// wheels cannot make, and a reversal without known times. A lost frame does not cut.
class TrackStitcher {
 public:
  explicit TrackStitcher(const StitcherConfig& config)
      : config_(config),
        flips_({.max_turn_rate = 2 * config.max_wheel_speed / config.wheel_base}) {}

  /// Takes a frame; appends the samples that are now final to `out`.
  void addFrame(const TrackPoint& point, std::vector<Sample>& out);

  /// Takes telemetry; appends the samples that are now final to `out`.
  void addTelemetry(const RobotTelemetry& telemetry, std::vector<Sample>& out);

  /// End of data: processes all waiting frames.
  void flush(std::vector<Sample>& out);

  [[nodiscard]] const StitcherCounters& counters() const { return counters_; }
  /// The pieces that ended since the last call, in time order.
  [[nodiscard]] std::vector<Piece> takePieces() { return std::exchange(pieces_, {}); }
  /// The frames that were classified since the last call, in time order; none for frames whose pose
  /// or time is invalid. Empty unless StitcherConfig::report_frames is set.
  [[nodiscard]] std::vector<FrameReport> takeReports() { return std::exchange(reports_, {}); }
  /// Zeros for an unknown key.
  [[nodiscard]] ProgramTally tally(int program) const;

 private:
  using Log = std::deque<RobotTelemetry>;

  /// The state of the robot at the time of one frame.
  struct Context {
    int program = -1;
    std::int64_t epoch = 0;
    std::int64_t reversals = 0;               ///< Finished before the frame.
    const RobotTelemetry* after = nullptr;    ///< Has the times of the last of them.
    std::int64_t tumble_count = 0;            ///< Tumbles begun before the frame.
    double run_time = 0;                      ///< At the frame, s.
    double sense_distance = 0;                ///< m.
    bool stopped = false;                     ///< By a command or by the end of the lease.
    const RobotTelemetry* nearest = nullptr;  ///< The state next to the frame in time.
  };
  enum class FrameClass { kFree, kUncovered, kStanding, kReversal, kContact, kLostReversal };
  enum class Link { kFirst, kSamePiece, kJoin, kCut, kLostReversal };

  void processPending(bool force, std::vector<Sample>& out);
  void process(TrackPoint point, std::vector<Sample>& out);
  FrameClass classify(const TrackPoint& point, Context& context) const;
  [[nodiscard]] bool nearContact(double time, Log::const_iterator next) const;
  [[nodiscard]] bool nearReversal(double time, Log::const_iterator next) const;
  [[nodiscard]] Link linkTo(const TrackPoint& point, const Context& context) const;
  [[nodiscard]] bool reachable(const TrackPoint& from, const TrackPoint& to) const;
  void report(const TrackPoint& point, FrameClass frame_class, const Context& context);
  void drop(FrameClass frame_class, const Context& context);
  void join(const TrackPoint& point, const RobotTelemetry& reversal);
  void append(TrackPoint point, const Context& context, double gap, std::vector<Sample>& out);
  void watchSense(TrackPoint& point, double sense_distance);
  void cut(PieceEnd reason);
  void closePiece(PieceEnd reason);
  void restart();
  ProgramTally& tallyOf(int program);

  StitcherConfig config_;
  FlipFilter flips_;
  StitcherCounters counters_;
  std::vector<ProgramTally> tallies_;
  std::vector<Piece> pieces_;
  std::vector<FrameReport> reports_;
  Piece piece_;  ///< The current piece; no frames: none.
  std::deque<TrackPoint> pending_;
  Log log_;
  double newest_frame_ = -1e300;
  double newest_ = -1e300;
  int backwards_ = 0;

  bool cut_ = true;                 ///< The next sample begins a new segment.
  std::optional<TrackPoint> last_;  ///< Last frame that became a sample.
  Context last_context_;
  Sample sample_;                      ///< Last sample.
  std::optional<TrackPoint> suspect_;  ///< A frame that is not reachable from the last one.
  double removed_ = 0;                 ///< Total time of the removed reversals, s.
  double offset_x_ = 0;
  double offset_y_ = 0;
};

}  // namespace lab::analysis
