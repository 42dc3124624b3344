#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

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
  bool reversing = false;
  double v_l = 0;                 ///< The program's held wheel speeds, also while
  double v_r = 0;                 ///< reversing, m/s.
  bool contact = false;           ///< Touches another robot.
  bool stopped = false;           ///< Stopped from outside.
  std::int64_t tumble_count = 0;  ///< Tumbles begun (RTP).
  double run_time = 0;            ///< Time spent in runs, reversals excluded (RTP), s.
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
/// Frames and telemetry come in any interleaving. A frame is judged once telemetry at or after its
/// time is known, or after reorder_delay. Inside a reversal frames are dropped; free time stops;
/// the motion between the last frame before and the first one after is driven at the held wheel
/// speeds. A new program epoch, a contact, a stop, a jump that the wheels cannot make, and a
/// reversal without its times cut: a new segment begins. A lost frame does not.
class TrackStitcher {
 public:
  explicit TrackStitcher(const StitcherConfig& config) : config_(config) {}

  /// Takes a frame; appends to `out` the samples that can now be judged.
  void addFrame(const TrackPoint& point, std::vector<Sample>& out);

  /// Takes telemetry; appends to `out` the samples that can now be judged.
  void addTelemetry(const RobotTelemetry& telemetry, std::vector<Sample>& out);

  /// End of data: judges all that waits by what is known.
  void flush(std::vector<Sample>& out);

  [[nodiscard]] const StitcherCounters& counters() const { return counters_; }
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
  };
  enum class Fate { kFree, kUncovered, kStanding, kReversal, kContact, kLostReversal };
  enum class Link { kFirst, kSamePiece, kJoin, kCut, kLostReversal };

  void processPending(bool force, std::vector<Sample>& out);
  void process(const TrackPoint& point, std::vector<Sample>& out);
  Fate judge(const TrackPoint& point, Context& context) const;
  [[nodiscard]] bool nearContact(double time, Log::const_iterator next) const;
  [[nodiscard]] bool nearReversal(double time, Log::const_iterator next) const;
  [[nodiscard]] Link linkTo(const TrackPoint& point, const Context& context) const;
  [[nodiscard]] bool reachable(const TrackPoint& from, const TrackPoint& to) const;
  void drop(Fate fate, int program);
  void join(const TrackPoint& point, const RobotTelemetry& reversal);
  void append(const TrackPoint& point, const Context& context, double gap,
              std::vector<Sample>& out);
  void restart();
  ProgramTally& tallyOf(int program);

  StitcherConfig config_;
  StitcherCounters counters_;
  std::vector<ProgramTally> tallies_;
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
