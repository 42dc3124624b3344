/// The caps found so far in one picture.
#pragma once

#include <vector>

#include "tracker_svc/circle_search/circle_search.hpp"
#include "tracker_svc/detection.hpp"
#include "tracker_svc/detector/detector_setup.hpp"

namespace lab::detector {

class KnownCaps {
 public:
  explicit KnownCaps(const DetectorSetup& setup) : setup_(setup) {}

  void clear() { caps_.clear(); }
  void add(const Detection& cap) { caps_.push_back(cap); }
  [[nodiscard]] const std::vector<Detection>& caps() const { return caps_; }
  [[nodiscard]] std::size_t size() const { return caps_.size(); }

  /// Whether a cap with this pose would intersect a known one.
  [[nodiscard]] bool overlaps(const Detection& pose) const;
  /// Whether a known cap excludes the circle of another cap here.
  [[nodiscard]] bool leavesNoRoomAt(optics::Place circle) const;
  /// Whether caps are known and no light edge was fitted on any of them.
  [[nodiscard]] bool isLightEven() const;
  /// Excludes the area of a cap from the search.
  void cover(CircleSearch& search, const Detection& cap) const;

 private:
  /// [m] around an axis in which no circle of another cap can have its centre.
  [[nodiscard]] double clearance() const;

  const DetectorSetup& setup_;
  std::vector<Detection> caps_;
};

}  // namespace lab::detector
