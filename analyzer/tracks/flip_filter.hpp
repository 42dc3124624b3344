#pragma once

#include <cstdint>
#include <optional>

#include "analyzer/laws.hpp"

namespace lab::analysis {

struct TrackPoint;

/// How fast headings can change.
struct FlipConfig {
  double max_turn_rate = 7.2;  ///< rad/s: both wheels at full speed, one of them backward.
};

/// Mends the headings of one robot whose tracker takes its tail for its head now and then, for one
/// frame or for long.
///
/// A heading that jumps by pi, within noise and within what wheels can turn in the time between the
/// frames, is turned round; so is all that follows until it jumps back. One frame and a long
/// stretch are the same case, and no frame is guessed: rotation by pi between two frames is beyond
/// every wheel as long as they are less than about 0.16 s apart (max_turn_rate dt + slack < pi/2).
/// Farther apart a jump that the wheels could have made is believed.
///
/// That makes headings continuous, which is all that rotation needs. Which of both ends is the head
/// only motion tells, and only for programs that drive forward: see drive().
class FlipFilter {
 public:
  explicit FlipFilter(const FlipConfig& config) : config_(config) {}

  /// Takes the frames in time order, also those of reversals, and turns round the headings that are
  /// flipped. Returns whether it turned this one. A heading that was not flipped keeps its bits.
  bool mend(TrackPoint& point);

  /// Takes what the robot drove freely between two frames along its mended heading (m, negative:
  /// backward) and the distance that shows which end is the head (see senseDistance()). Returns
  /// true once the motion says that the headings so far are the tail's: from now on mend() turns
  /// them round, and nothing links headings before to those after.
  bool drive(double forward, double sense_distance);

  /// Times that headings jumped by pi: two for one flipped frame or stretch.
  [[nodiscard]] std::int64_t jumps() const { return jumps_; }

  /// Counts what links nothing: headings of different chains may differ by pi unnoticed.
  [[nodiscard]] int chain() const { return chain_; }

 private:
  struct Reference {
    double time = 0;
    double theta = 0;  ///< mended
    double sigma = 0;
  };
  enum class Relation { kSame, kFlipped, kNone };

  [[nodiscard]] double reach(const Reference& from, const Reference& to) const;
  [[nodiscard]] Relation relate(const Reference& from, const Reference& to) const;
  void accept(const Reference& reference);

  FlipConfig config_;
  bool turned_ = false;             ///< Headings as tracked are the tail's.
  std::optional<Reference> last_;   ///< The last heading that fitted,
  std::optional<Reference> older_;  ///< the one before: the last may be an outlier by itself.
  std::optional<Reference> suspect_;
  double forward_drive_ = 0;  ///< m driven forward since the sense was in doubt.
  std::int64_t jumps_ = 0;
  int chain_ = 0;
};

/// The net forward drive after which chance has driven the other way with probability 1e-9, m. Its
/// sign is that of forward. 0: the program drives to both sides alike (BP), or nothing is known of
/// it.
///
/// For a mean speed va under noise of the drive with the variance rate B = epsilon V^2 / 6 the log
/// likelihood ratio of head and tail is 2 va S / B after a net drive S.
[[nodiscard]] double senseDistance(const ProgramLaw& law);

}  // namespace lab::analysis
