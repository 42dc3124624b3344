#pragma once

#include <cstdint>
#include <optional>

#include "analyzer/laws.hpp"

namespace lab::analysis {

struct TrackPoint;

/// Limits of the change of headings.
struct FlipConfig {
  double max_turn_rate = 7.2;  ///< rad/s: both wheels at full speed, one of them backward.
};

/// Corrects the headings of one robot whose tracker sometimes confuses head and tail, for one frame
/// or for longer.
///
/// A heading that jumps by pi, within the noise and the possible turn between the frames, is
/// flipped; so are all following ones until the heading jumps back. One frame and a long stretch
/// are the same case. No guess is involved: wheels cannot turn a robot by pi between frames that
/// are less than about 0.16 s apart (max_turn_rate dt + slack < pi/2). Between more distant frames,
/// a jump that the wheels could have made is accepted as motion.
///
/// Headings are then continuous, which is sufficient for the rotation. Only the motion shows which
/// end is the head, and only for programs that drive forward: see addMotion().
class FlipFilter {
 public:
  explicit FlipFilter(const FlipConfig& config) : config_(config) {}

  /// Takes the frames in time order, including those of reversals, and corrects flipped headings.
  /// Returns whether it changed this one. Other headings keep their bits.
  bool correct(TrackPoint& point);

  /// Takes the free displacement between two frames along the corrected heading (m, negative:
  /// backward) and the distance that decides which end is the head (see senseDistance()). Returns
  /// true if the motion shows that the headings so far are those of the tail. From then on
  /// correct() flips them, and a new chain of headings begins.
  bool addMotion(double forward, double sense_distance);

  /// Number of jumps by pi: two for one flipped frame or stretch.
  [[nodiscard]] std::int64_t jumps() const { return jumps_; }

  /// Number of the chain of headings. Headings of different chains may differ by an undetected pi.
  [[nodiscard]] int chain() const { return chain_; }

 private:
  struct Reference {
    double time = 0;
    double theta = 0;  ///< rad, corrected
    double sigma = 0;
  };
  enum class Relation { kSame, kFlipped, kNone };

  [[nodiscard]] double reach(const Reference& from, const Reference& to) const;
  [[nodiscard]] Relation relate(const Reference& from, const Reference& to) const;
  void accept(const Reference& reference);

  FlipConfig config_;
  bool turned_ = false;             ///< The tracked headings are those of the tail.
  std::optional<Reference> last_;   ///< The last heading that fitted.
  std::optional<Reference> older_;  ///< The one before it, since the last may be an outlier.
  std::optional<Reference> suspect_;
  double forward_drive_ = 0;  ///< m driven forward, limited to the deciding distance.
  std::int64_t jumps_ = 0;
  int chain_ = 0;
};

/// The net forward displacement, m, that a robot whose head and tail are confused reaches with
/// probability 1e-9. Its sign is that of the programmed speed. 0: the program drives forward and
/// backward alike, or is unknown.
///
/// For a mean speed va and noise with the variance rate B = epsilon V^2 / 6, the log likelihood
/// ratio of head and tail is 2 va S / B after a net displacement S.
[[nodiscard]] double senseDistance(const ProgramLaw& law);

}  // namespace lab::analysis
