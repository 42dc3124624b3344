/// Finds the disks that are close to each other or to walls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sim_svc/world/arena.hpp"
#include "sim_svc/world/disk_bodies.hpp"
#include "sim_svc/world/neighbour_list.hpp"

namespace lab::sim {

/// The disks of a step: robots first, then kinematic disks, which no force moves.
struct MovedDisks {
  std::size_t robots = 0;
  std::span<const Vec> from;  ///< Centres at the start of the step.
  const DiskBodies* bodies;   ///< After the free motion.
  const NeighbourList* neighbours;

  /// The centre of a disk after the free motion.
  [[nodiscard]] Vec to(std::size_t disk) const { return bodies->centre[disk]; }
};

/// The walls as partners of a robot: left, right, bottom and top.
inline constexpr std::uint32_t kFirstWall = std::numeric_limits<std::uint32_t>::max() - 4;

[[nodiscard]] inline bool isWall(std::uint32_t partner) { return partner >= kFirstWall; }

/// Unit vector into the arena.
[[nodiscard]] Vec wallNormal(std::uint32_t wall);

/// Distance of a point from a wall [m].
[[nodiscard]] double wallDistance(const Arena& arena, std::uint32_t wall, Vec point);

/// A robot that is close to another disk or to a wall after the free motion.
struct ContactPair {
  std::uint32_t first = 0;
  std::uint32_t second = 0;  ///< A disk, or a wall.
  double gap = 0;            ///< [m]
  bool selected = false;     ///< Takes part in the solution.
  double normal_push = 0;    ///< As in DiskContact.
  double tangent_push = 0;   ///< As in DiskContact.
  bool pressed = false;      ///< In the step before.
};

/// Pairs with a small gap. The order is that of first, then second.
class ContactPairs {
 public:
  /// Pairs are searched for up to this gap, in units of the largest move. The neighbour list must
  /// contain them.
  static constexpr double kFarthestGap = 7;

  /// @param radius of every disk [m]
  /// @param largest_move of a disk in its free motion of one step [m]
  ContactPairs(const Arena& arena, double radius, double largest_move);

  /// The pairs with a gap below the largest move. Those that may get there soon are remembered, so
  /// that most calls look at few pairs.
  void findNear(const MovedDisks& disks, std::vector<ContactPair>& pairs);

  /// The pairs with a gap below kFarthestGap.
  void findFar(const MovedDisks& disks, std::vector<ContactPair>& pairs) const;

  /// The gap of a pair for these centres [m].
  [[nodiscard]] double gapOf(const ContactPair& pair, Vec first, Vec second) const;

 private:
  struct ClosePair {
    std::uint32_t first = 0;
    std::uint32_t second = 0;
  };

  void listClose(const MovedDisks& disks, std::vector<ContactPair>& scratch);
  void search(const MovedDisks& disks, double pair_gap, double wall_gap,
              std::vector<ContactPair>& pairs) const;
  void addWalls(std::uint32_t robot, Vec centre, double reach,
                std::vector<ContactPair>& pairs) const;

  Arena arena_;
  double radius_;
  double largest_move_;
  double close_move_;  ///< The close pairs hold until a disk has moved by this [m].
  std::vector<ClosePair> close_;
  std::vector<Vec> close_at_;  ///< Per disk, when the close pairs were listed.
};

}  // namespace lab::sim
