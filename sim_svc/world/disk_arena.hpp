/// Hard disks in an arena: exact arcs that stop at contact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "robot/dynamics/kinematics.hpp"
#include "sim_svc/world/arena.hpp"
#include "sim_svc/world/neighbour_list.hpp"

namespace lab::sim {

struct DiskArenaSettings {
  Arena arena;
  double radius = 0.0375;        ///< Of every disk [m].
  double sensing_range = 0.05;   ///< Distance from the rim up to which neighbours are listed [m].
  double largest_move = 0.0041;  ///< Upper bound of a move between two relistIfMoved() calls [m].
};

/// How a robot moves.
struct Motion {
  double speed = 0;  ///< Forward [m/s].
  double turn = 0;   ///< Turning rate [rad/s].
};

/// The geometry of a World: robots as disks that move one at a time along exact arcs, and kinematic
/// disks whose positions are set from outside. A move stops where the robot would touch a wall or
/// another disk, so disks never overlap, except that a kinematic disk may be put onto a robot: the
/// robot is then pushed out as far as possible.
///
/// A robot's body is kept apart from its electronics (see World), so that the bodies of a thousand
/// robots fit into the processor's cache.
class DiskArena {
 public:
  /// @param robots poses of the robots, which must not overlap
  DiskArena(const DiskArenaSettings& settings, const std::vector<dynamics::Pose>& robots);

  /// Number of robots, without kinematic disks.
  [[nodiscard]] std::size_t robots() const { return robots_; }

  /// Begins a step: contacts are counted by step, and robots are pushed out of kinematic disks.
  void beginStep();

  /// Sets the velocity that robot i has until the next call.
  void setMotion(std::size_t i, Motion motion);
  [[nodiscard]] bool isMoving(std::size_t i) const {
    return bodies_[i].motion.speed != 0 || bodies_[i].motion.turn != 0;
  }

  /// Moves robot i along its arc for the time dt [s].
  void moveFor(std::size_t i, double dt);

  /// Moves robot i forward [m], at most by the largest move, and then rotates it [rad].
  void displace(std::size_t i, double forward, double rotation);

  /// Renews the neighbour lists if disk i has moved too far for them. To be called after each move.
  void relistIfMoved(std::size_t i);

  /// Adds a hidden kinematic disk. @return its number, from 0
  std::size_t addKinematicDisk();
  /// See World::moveKinematicDisk().
  void moveKinematicDisk(std::size_t disk, Vec centre);
  void hideKinematicDisk(std::size_t disk);

  [[nodiscard]] const Arena& arena() const { return settings_.arena; }
  [[nodiscard]] Vec centre(std::size_t i) const { return centres_[i]; }
  /// Unit vector.
  [[nodiscard]] Vec heading(std::size_t i) const { return bodies_[i].heading; }
  [[nodiscard]] dynamics::Pose pose(std::size_t i) const {
    return {centres_[i].x, centres_[i].y, bodies_[i].theta};
  }
  /// Real motion: speed 0 while a contact holds the robot.
  [[nodiscard]] Motion motion(std::size_t i) const;
  [[nodiscard]] bool touchesRobot(std::size_t i) const {
    return bodies_[i].robot_contact.last_step == steps_;
  }
  [[nodiscard]] bool touchesWall(std::size_t i) const {
    return bodies_[i].wall_contact.last_step == steps_;
  }
  /// Contacts of robot i begun since the start.
  [[nodiscard]] std::int64_t robotContacts(std::size_t i) const {
    return bodies_[i].robot_contact.begun;
  }
  [[nodiscard]] std::int64_t wallContacts(std::size_t i) const {
    return bodies_[i].wall_contact.begun;
  }
  /// Contacts between two disks begun since the start.
  [[nodiscard]] std::int64_t collisions() const { return collisions_; }

  /// At least all disks within the sensing range of disk i.
  [[nodiscard]] std::span<const std::uint32_t> neighbours(std::size_t i) const {
    return neighbours_.of(i);
  }

 private:
  struct Contact {
    std::int64_t last_step = -2;
    std::int64_t begun = 0;
  };

  struct Body {
    double theta = 0;
    Vec heading{1, 0};
    Motion motion;  ///< As driven, without regard to contacts.
    Vec listed_at;  ///< Position when the neighbours were listed.
    Contact robot_contact;
    Contact wall_contact;
  };

  [[nodiscard]] Vec stopAtContact(std::size_t i, Vec move);
  bool touch(Contact& contact) const;
  void pushRobotsOut(std::size_t kinematic_body);
  void pushOut(std::size_t i, std::size_t kinematic_body);
  void listNeighbours();

  DiskArenaSettings settings_;
  double contact_distance_;
  double skin_;  ///< Margin of the neighbour lists [m].
  std::int64_t steps_ = 0;
  std::int64_t collisions_ = 0;
  std::size_t robots_ = 0;
  std::size_t visible_kinematic_ = 0;
  NeighbourList neighbours_;
  // Robots first, then kinematic disks.
  std::vector<Vec> centres_;
  std::vector<Body> bodies_;
};

}  // namespace lab::sim
