/// Contacts of robots that slide and push.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sim_svc/world/arena.hpp"
#include "sim_svc/world/contact_solver.hpp"
#include "sim_svc/world/disk_bodies.hpp"
#include "sim_svc/world/neighbour_list.hpp"
#include "sim_svc/world/worker_team.hpp"

namespace lab::sim {

struct SlidingSettings {
  Arena arena;
  double radius = 0.0375;        ///< Of every disk [m].
  double largest_move = 0.0041;  ///< Of a disk in its free motion of one step [m].
  double friction = 0.2;         ///< Coefficient between rims, and between rim and wall.
  SlipMobility mobility;
};

/// The disks of a step: robots first, then kinematic disks, which no force moves.
struct MovedDisks {
  std::size_t robots = 0;
  std::span<const Vec> from;  ///< Centres at the start of the step.
  const DiskBodies* bodies;   ///< After the free motion.
  const NeighbourList* neighbours;

  /// The centre of a disk after the free motion.
  [[nodiscard]] Vec to(std::size_t disk) const { return bodies->centre[disk]; }
};

/// What contacts do to one robot in one step.
struct ContactShift {
  std::uint32_t robot = 0;
  Vec shift;            ///< [m]
  double rotation = 0;  ///< [rad]
};

/// A robot that pressed against a disk or a wall in a step.
struct Touch {
  static constexpr std::uint32_t kWall = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t robot = 0;
  std::uint32_t other = kWall;  ///< A disk, or kWall.
  bool begun = false;           ///< They did not press in the step before.
};

/// Finds the disks that overlap after the free motion of a step, and the shifts that remove the
/// overlaps. Disks that press against each other, directly or through others, form an island,
/// which is solved by itself (ContactSolver). Without overlaps nothing is shifted.
class SlidingContacts {
 public:
  /// Overlaps up to this are left as they are [m]. It is more than what the solver leaves, so that
  /// disks at rest stay exactly at rest.
  static constexpr double kSlack = 5e-7;

  /// The neighbour list must contain pairs up to this gap, in units of the largest move.
  static constexpr double kFarthestGap = 7;

  explicit SlidingContacts(const SlidingSettings& settings);

  /// Resolves the contacts of a step.
  /// @param dt duration of the step [s]
  /// @param team whose threads solve islands
  void resolve(const MovedDisks& disks, double dt, WorkerTeam& team);

  /// Pushes robots at rest out of kinematic disks, by at most the largest move.
  void pushOut(const MovedDisks& disks);

  /// Results of the last call. Each robot occurs at most once.
  [[nodiscard]] std::span<const ContactShift> shifts() const { return shifts_; }
  [[nodiscard]] std::span<const Touch> touches() const { return touches_; }

  /// Islands so far, and those of them for which the solver did not reach its tolerance. Such an
  /// island moves only as far as nothing overlaps.
  [[nodiscard]] std::int64_t islands() const { return all_islands_; }
  [[nodiscard]] std::int64_t unsolvedIslands() const { return unsolved_islands_; }
  /// Sweeps of the solver over islands so far.
  [[nodiscard]] std::int64_t sweeps() const { return sweeps_; }

 private:
  struct ClosePair {
    std::uint32_t first = 0;
    std::uint32_t second = 0;  ///< As in Pair.
  };
  /// A robot that is close to another disk or to a wall after the free motion.
  struct Pair {
    std::uint32_t first = 0;
    std::uint32_t second = 0;  ///< A disk, or a wall: kFirstWall and the next three.
    double gap = 0;            ///< [m]
    bool selected = false;     ///< Takes part in the solution.
    double normal_push = 0;    ///< As in DiskContact.
    double tangent_push = 0;   ///< As in DiskContact.
    bool pressed = false;      ///< In the step before.
  };
  struct Island {
    std::size_t first_contact = 0;
    std::size_t contacts = 0;
    std::size_t first_disk = 0;
    std::size_t disks = 0;
    int sweeps = 0;  ///< 0: nothing overlaps.
  };

  void run(const MovedDisks& disks, bool at_rest, WorkerTeam& team);
  void findPairs(const MovedDisks& disks, double reach);
  void listClosePairs(const MovedDisks& disks);
  void searchPairs(const MovedDisks& disks, double pair_gap, double wall_gap);
  void addWalls(std::uint32_t robot, Vec centre, double reach);
  void takePushes(std::span<const Pair> pairs, double factor, bool select);
  void formIslands(const MovedDisks& disks, bool at_rest);
  void addContact(const Pair& pair, const Island& island, const MovedDisks& disks, bool at_rest);
  std::uint32_t slotOf(std::uint32_t robot, const MovedDisks& disks);
  void solveIslands(const MovedDisks& disks, WorkerTeam& team);
  void solve(const MovedDisks& disks, Island& island, ContactSolver& solver);
  void limit(const MovedDisks& disks, const Island& island);
  bool selectOverlapping(const MovedDisks& disks);
  void report();

  [[nodiscard]] double gapOf(const Pair& pair, Vec first, Vec second) const;
  [[nodiscard]] double wallGap(std::uint32_t wall, Vec centre) const;
  std::uint32_t rootOf(std::uint32_t robot);
  [[nodiscard]] double squaredFarthestShift() const;
  [[nodiscard]] Vec shifted(const MovedDisks& disks, std::uint32_t disk) const;

  SlidingSettings settings_;
  std::vector<ContactSolver> solvers_;  ///< Per thread.
  double most_push_;                    ///< Of a kinematic disk [m].

  /// Pairs that may come into contact before a disk has moved by close_move_ since close_at_.
  std::vector<ClosePair> close_;
  std::vector<Vec> close_at_;  ///< Per disk.
  double close_move_;          ///< [m]

  std::vector<Pair> pairs_;     ///< In the order of first, then second.
  std::vector<Pair> previous_;  ///< Those of the last step that pressed, in the same order.
  double previous_dt_ = 0;      ///< Of the last step [s].
  double reach_ = 0;            ///< Largest gap of pairs_ [m].

  std::vector<std::uint32_t> parent_;  ///< Per robot: the islands as a disjoint-set forest.
  std::vector<std::uint32_t> slot_;    ///< Per robot: its index in island_disks_, or kNone.
  std::vector<Island> islands_;
  std::vector<std::size_t>
      runs_;  ///< Islands that one thread solves: the first, and the last's end.
  std::vector<std::uint32_t> island_of_;    ///< Per selected pair.
  std::vector<std::uint32_t> pair_index_;   ///< Per contact: its pair.
  std::vector<std::uint32_t> robot_index_;  ///< Per disk of an island: the robot.
  std::vector<DiskContact> contacts_;       ///< Island by island.
  std::vector<ContactDisk> disks_;          ///< Island by island.

  std::vector<ContactShift> shifts_;
  std::vector<Touch> touches_;
  std::int64_t all_islands_ = 0;
  std::int64_t unsolved_islands_ = 0;
  std::int64_t sweeps_ = 0;
};

}  // namespace lab::sim
