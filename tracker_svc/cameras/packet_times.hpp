/// Times of the frames of a movie, from the packets that ffprobe lists.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lab::cameras {

/// 3.8 days at 60 frames a second. python/active_lab/films.py has the same limit.
inline constexpr std::size_t kMostPackets = 20'000'000;

/// Takes one packet after the other. It keeps one number of each.
class PacketTimes {
 public:
  /// The entries of ffprobe and their form, for the options -show_entries and -of.
  static constexpr const char* kEntries = "packet=pts_time,dts_time,flags";
  static constexpr const char* kForm = "compact=p=0";

  /// @param most number of packets that are taken
  explicit PacketTimes(std::size_t most) : most_(most) {}

  /// Takes the presentation time of a packet; the decoding time if it has none (AVI).
  /// @param line "pts_time=0.040000|dts_time=N/A|flags=K_"; one without times is no packet
  /// @return false if there are more packets than allowed
  [[nodiscard]] bool add(std::string_view line);

  /// Number of packets that are decoded but not displayed.
  [[nodiscard]] std::int64_t neverShown() const { return never_shown_; }

  /// [us] of each displayed frame since the first, in order. Empties this object.
  [[nodiscard]] std::vector<std::int64_t> take();

  /// What is wrong with the times that take() gave; empty: nothing. As in the table of a film, no
  /// time is after the year 2100, and no frame is more than 11 days after the one before it.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::size_t most_;
  std::vector<std::int64_t> utimes_;
  std::int64_t never_shown_ = 0;
  double earliest_ = 0;  ///< [s]
  double latest_ = 0;    ///< [s]
  std::string problem_;
};

}  // namespace lab::cameras
