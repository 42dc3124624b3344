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
  bool valid = true;       ///< False: the tracker itself does not trust the pose.
};

/// What one robot says about itself at one time. Every message carries the whole state, so that a
/// lost message costs nothing that the next one does not say again.
struct RobotTelemetry {
  double time = 0;                  ///< When sampled, in the time of the frames, s.
  int program = -1;                 ///< The caller's key of the program, -1: standing.
  std::int64_t program_epoch = 0;   ///< Counts starts of programs, each with a fresh draw.
  double program_start = 0;         ///< When this epoch began, s.
  std::int64_t reversal_count = 0;  ///< Reversals begun.
  double reversal_start = 0;        ///< Of the last reversal, s.
  double reversal_end = 0;          ///< Of the last reversal, s; ignored while reversing.
  /// How far the last reversal went, m, where a camera has measured it (ReversalFinder); nan: the
  /// free motion around it is bridged at the held wheel speeds.
  double reversal_dx = units::kNan;
  double reversal_dy = units::kNan;
  bool reversing = false;
  double v_l = 0;                 ///< The program's held wheel speeds, also while
  double v_r = 0;                 ///< reversing, m/s.
  bool contact = false;           ///< Touches another robot.
  bool stopped = false;           ///< Stopped from outside.
  std::int64_t tumble_count = 0;  ///< Tumbles begun (RTP).
  double run_time = 0;            ///< Time spent in runs, reversals excluded (RTP), s.
  double sense_distance = 0;      ///< Shows head from tail, see senseDistance(), m.
};

/// One point of the free motion. Free time and the stitched coordinates mean something only
/// relative to other samples of the same segment.
struct Sample {
  double time = 0;       ///< Camera time, s.
  double free_time = 0;  ///< Camera time without the reversals, s.
  std::int64_t frame = 0;
  double x = 0;             ///< Stitched, m.
  double y = 0;             ///< Stitched, m.
  double theta = 0;         ///< Unwrapped, rad; nan: headings are not known.
  int segment = 0;          ///< No window may cross a change of segment.
  int angular_segment = 0;  ///< No angular window may cross a change of this one.
  int piece = 0;     ///< Changes also where a reversal was removed: frames are aligned in it.
  int program = -1;  ///< The caller's key.
  std::int64_t tumble_count = 0;
  double run_time = 0;  ///< s.
};

/// What the robots can do and how long to wait for their telemetry.
struct StitcherConfig {
  double reorder_delay = 0.5;     ///< A frame waits at most so long for telemetry, s.
  double contact_guard = 0.1;     ///< Cut so much before and after a contact, s.
  double reversal_guard = 0.0;    ///< Distrust frames so close to a reversal, s.
  double max_join_gap = 0.3;      ///< Free time that the held wheel speeds may bridge, s.
  double max_angular_gap = 0.3;   ///< Without frames for longer, the heading is ambiguous, s.
  double max_wheel_speed = 0.27;  ///< m/s.
  double wheel_base = 0.075;      ///< m.
  bool headings = true;           ///< False: theta of the frames means nothing.
  bool join = true;               ///< False: reversals are removed, and cut.
};

/// Why a piece of free motion ended.
enum class PieceEnd : std::uint8_t {
  kJoined,         ///< A reversal was removed and the motion after it joined.
  kNotJoined,      ///< A reversal was removed and cuts, as StitcherConfig::join asks.
  kLostReversal,   ///< A reversal whose times, or the frames around it, are not known.
  kProgramSwitch,  ///< Another program, or a fresh start of the same.
  kContact,        ///< Touches another robot.
  kStop,           ///< Standing, or stopped from outside.
  kJump,           ///< Two frames or more agree with each other and not with the track.
  kClockSetBack,   ///< The camera's time stamps went back for good.
  kClockStep,      ///< The clock of a file of poses jumped.
  kEnd,            ///< End of data.
};

/// A stretch of free motion without a gap in its meaning. SI units.
struct Piece {
  int program = -1;  ///< As in the samples.
  int segment = 0;
  int piece = 0;
  double begin = 0;  ///< Camera time of its first frame, s.
  double end = 0;    ///< Of its last frame, s.
  std::int64_t frames = 0;
  PieceEnd reason = PieceEnd::kEnd;
  /// Of the reversal that ended it, where it was joined; else nan.
  double reversal_start = units::kNan;  ///< s.
  double reversal_end = units::kNan;    ///< s.
  double dx = units::kNan;              ///< Taken out of the track, m.
  double dy = units::kNan;              ///< m.
  /// What the heading turned between the frames around it, rad. It stays in the track: the robot
  /// keeps its heading while it reverses, and free motion up to the frames turned it.
  double rotation = units::kNan;
};

/// What happened to the frames, over all programs.
struct StitcherCounters {
  std::int64_t frames = 0;        ///< Received.
  std::int64_t samples = 0;       ///< Passed on.
  std::int64_t invalid = 0;       ///< Not finite, or marked invalid.
  std::int64_t out_of_order = 0;  ///< Time stamp repeated or gone back.
  std::int64_t uncovered = 0;     ///< No telemetry says what the robot did then.
  std::int64_t standing = 0;      ///< No program, or stopped.
  std::int64_t in_reversal = 0;
  std::int64_t in_contact = 0;
  std::int64_t outliers = 0;        ///< Not reachable with the wheels.
  std::int64_t bad_telemetry = 0;   ///< Repeated, too late or not finite.
  std::int64_t jumps = 0;           ///< Cuts at an unmarked jump.
  std::int64_t lost_reversals = 0;  ///< Cuts at reversals whose times were lost.
  std::int64_t reversals = 0;       ///< Removed and joined.
  std::int64_t flips = 0;           ///< Headings turned round: the tail was taken for the head.
  std::int64_t flip_jumps = 0;      ///< Jumps of the heading by pi that were mended.
  std::int64_t sense_turns = 0;     ///< Times that the motion showed the head to be the tail.
};

/// Of one program.
struct ProgramTally {
  std::int64_t samples = 0;
  std::int64_t in_contact = 0;  ///< Frames cut for a contact.
  std::int64_t lost = 0;        ///< Frames without telemetry, and outliers.
  std::int64_t segments = 0;
  std::int64_t reversals = 0;  ///< Removed and joined.
};

/// The paper's Appendix B for one robot, online: removes the marked reversals from its track and
/// joins the free motion around them. The robot resumes exactly (timers, wheel speeds and heading
/// are kept), so the stitched track is statistically the free one.
///
/// Headings that a tracker turned round are turned back first (FlipFilter), also while reversing.
/// Frames and telemetry come in any interleaving. A frame is judged once telemetry at or after its
/// time is known, or after reorder_delay. Inside a reversal frames are dropped; free time stops;
/// the motion between the last frame before and the first one after is driven at the held wheel
/// speeds. A new program epoch, a contact, a stop, a jump that the wheels cannot make, and a
/// reversal without its times cut: a new segment begins. A lost frame does not.
class TrackStitcher {
 public:
  explicit TrackStitcher(const StitcherConfig& config)
      : config_(config),
        flips_({.max_turn_rate = 2 * config.max_wheel_speed / config.wheel_base}) {}

  /// Takes a frame; appends to `out` the samples that can now be judged.
  void addFrame(const TrackPoint& point, std::vector<Sample>& out);

  /// Takes telemetry; appends to `out` the samples that can now be judged.
  void addTelemetry(const RobotTelemetry& telemetry, std::vector<Sample>& out);

  /// End of data: judges all that waits by what is known.
  void flush(std::vector<Sample>& out);

  [[nodiscard]] const StitcherCounters& counters() const { return counters_; }
  /// The pieces that have ended since the last call, in time order.
  [[nodiscard]] std::vector<Piece> takePieces() { return std::exchange(pieces_, {}); }
  /// Zeros for a key that never appeared.
  [[nodiscard]] ProgramTally tally(int program) const;

 private:
  using Log = std::deque<RobotTelemetry>;

  /// The state of the robot at the time of one frame.
  struct Context {
    int program = -1;
    std::int64_t epoch = 0;
    std::int64_t reversals = 0;             ///< Finished before the frame.
    const RobotTelemetry* after = nullptr;  ///< Says when the last of them was.
    std::int64_t tumble_count = 0;          ///< Begun before the frame.
    double run_time = 0;                    ///< At the frame, s.
    double sense_distance = 0;              ///< m.
  };
  enum class FrameClass { kFree, kUncovered, kStanding, kReversal, kContact, kLostReversal };
  enum class Link { kFirst, kSamePiece, kJoin, kCut, kLostReversal };

  void processPending(bool force, std::vector<Sample>& out);
  void process(TrackPoint point, std::vector<Sample>& out);
  FrameClass judge(const TrackPoint& point, Context& context) const;
  [[nodiscard]] bool nearContact(double time, Log::const_iterator next) const;
  [[nodiscard]] bool nearReversal(double time, Log::const_iterator next) const;
  [[nodiscard]] Link linkTo(const TrackPoint& point, const Context& context) const;
  [[nodiscard]] bool reachable(const TrackPoint& from, const TrackPoint& to) const;
  void drop(FrameClass fate, int program);
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
  Piece piece_;  ///< The one that grows; without frames: none.
  std::deque<TrackPoint> pending_;
  Log log_;
  double newest_frame_ = -1e300;
  double newest_ = -1e300;
  int backwards_ = 0;

  bool cut_ = true;                 ///< The next sample begins a segment.
  std::optional<TrackPoint> last_;  ///< Last frame that became a sample.
  Context last_context_;
  Sample sample_;                      ///< Last sample.
  std::optional<TrackPoint> suspect_;  ///< A frame that the last one cannot reach.
  double removed_ = 0;                 ///< Time of the removed reversals.
  double offset_x_ = 0;
  double offset_y_ = 0;
};

}  // namespace lab::analysis
