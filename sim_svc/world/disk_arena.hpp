/// Hard disks in an arena: exact arcs, and what happens at contact.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "robot/dynamics/kinematics.hpp"
#include "sim_svc/world/arena.hpp"
#include "sim_svc/world/contact_solver.hpp"
#include "sim_svc/world/disk_bodies.hpp"
#include "sim_svc/world/neighbour_list.hpp"
#include "sim_svc/world/sliding_contacts.hpp"
#include "sim_svc/world/worker_team.hpp"

namespace lab::sim {

/// What robots do at contact.
enum class ContactRule {
  kSlide,  ///< They slide along each other and along walls, push and turn each other.
  kStop,   ///< Their moves stop.
};

struct DiskArenaSettings {
  Arena arena;
  double radius = 0.0375;        ///< Of every disk [m].
  double sensing_range = 0.05;   ///< Distance from the rim up to which neighbours are listed [m].
  double largest_move = 0.0041;  ///< Upper bound of a robot's free motion in a step [m].
  ContactRule contact = ContactRule::kSlide;
  double friction = 0.2;  ///< Coefficient of contacts that slide.
  SlipMobility mobility;  ///< Of contacts that slide.
};

/// How a robot really moves.
struct Velocity {
  Vec linear;       ///< [m/s]
  double turn = 0;  ///< [rad/s]
};

/// The geometry of a World: robots as disks that move along exact arcs, and kinematic disks whose
/// positions are set from outside. Disks never overlap, except that a kinematic disk may be put
/// onto a robot: the robot is then pushed out as far as possible.
///
/// With ContactRule::kSlide all robots move freely; endStep() then removes overlaps (see
/// SlidingContacts). Until then, seen() gives the positions at the start of the step, so the order
/// in which robots move does not matter. With kStop robots move one at a time, and a move stops
/// where the robot would touch a wall or another disk.
///
/// The bodies are kept apart from the robots' electronics (see World), so that those of a thousand
/// robots fit into the processor's cache.
class DiskArena {
 public:
  /// @param robots poses of the robots, which must not overlap
  DiskArena(const DiskArenaSettings& settings, const std::vector<dynamics::Pose>& robots);

  /// Number of robots, without kinematic disks.
  [[nodiscard]] std::size_t robots() const { return robots_; }

  /// Begins a step: contacts are counted by step.
  void beginStep();

  /// Sets the velocity that robot i has until the next call.
  void setMotion(std::size_t i, Motion motion);
  [[nodiscard]] bool isMoving(std::size_t i) const {
    return bodies_.speed[i] != 0 || bodies_.turn[i] != 0;
  }

  /// Moves robot i along its arc for the time dt [s].
  void moveFor(std::size_t i, double dt) {
    if (!isMoving(i)) return;
    if (slides()) {
      bodies_.move(i, dt);
    } else {
      moveUntilContact(i, dt);
    }
  }

  /// Moves the robots from `begin` to before `end`, robot i for the time dt[i] [s]. With kSlide
  /// only.
  void moveEach(std::size_t begin, std::size_t end, const double* dt) {
    bodies_.moveEach(begin, end, dt);
  }

  /// Moves robot i forward [m], at most by the largest move, and then rotates it [rad].
  void displace(std::size_t i, double forward, double rotation);

  /// Ends the moves of robot i in this step.
  void endMoves(std::size_t i) {
    if (!slides()) relistIfMoved(i);
  }

  /// Renews the neighbour lists if disk i has moved too far for them. With kStop to be called after
  /// each move.
  void relistIfMoved(std::size_t i);

  /// Ends the step, which lasted dt [s], after the moves of all robots.
  void endStep(double dt, WorkerTeam& team);

  /// Adds a hidden kinematic disk. @return its number, from 0
  std::size_t addKinematicDisk();
  /// See World::moveKinematicDisk().
  void moveKinematicDisk(std::size_t disk, Vec centre);
  void hideKinematicDisk(std::size_t disk);

  [[nodiscard]] const Arena& arena() const { return settings_.arena; }
  [[nodiscard]] Vec centre(std::size_t i) const { return bodies_.centre[i]; }
  /// Where other robots sense disk i.
  [[nodiscard]] Vec seen(std::size_t i) const { return slides() ? from_[i] : bodies_.centre[i]; }
  /// Unit vector.
  [[nodiscard]] Vec heading(std::size_t i) const { return bodies_.heading(i); }
  [[nodiscard]] dynamics::Pose pose(std::size_t i) const {
    return {bodies_.centre[i].x, bodies_.centre[i].y, bodies_.theta[i]};
  }
  /// The velocity of robot i, with what contacts did to it in the last step.
  [[nodiscard]] Velocity velocity(std::size_t i) const;
  [[nodiscard]] bool touchesRobot(std::size_t i) const {
    return contacts_[i].robot.last_step == steps_;
  }
  [[nodiscard]] bool touchesWall(std::size_t i) const {
    return contacts_[i].wall.last_step == steps_;
  }
  /// Contacts of robot i begun since the start.
  [[nodiscard]] std::int64_t robotContacts(std::size_t i) const { return contacts_[i].robot.begun; }
  [[nodiscard]] std::int64_t wallContacts(std::size_t i) const { return contacts_[i].wall.begun; }
  /// Contacts between two disks begun since the start.
  [[nodiscard]] std::int64_t collisions() const { return collisions_; }

  /// At least all disks within the sensing range of disk i.
  [[nodiscard]] std::span<const std::uint32_t> neighbours(std::size_t i) const {
    return neighbours_.of(i);
  }

  /// Of ContactRule::kSlide.
  [[nodiscard]] const SlidingContacts& sliding() const { return sliding_; }

 private:
  struct Contact {
    std::int64_t last_step = -2;
    std::int64_t begun = 0;
  };
  struct Contacts {
    Contact robot;
    Contact wall;
    Velocity slip;  ///< By contacts, in the last step in which there was one.
  };

  [[nodiscard]] bool slides() const { return settings_.contact == ContactRule::kSlide; }
  void moveUntilContact(std::size_t i, double dt);
  [[nodiscard]] Vec stopAtContact(std::size_t i, Vec move);
  bool touch(Contact& contact) const;
  void applyContacts(double dt);
  [[nodiscard]] MovedDisks moved() const;
  void pushRobotsOut(std::size_t kinematic_body);
  void pushOut(std::size_t i, std::size_t kinematic_body);
  void pushOutSliding(std::size_t kinematic_body);
  [[nodiscard]] double deepestOverlap(std::size_t kinematic_body) const;
  void listNeighbours();

  DiskArenaSettings settings_;
  double contact_distance_;
  double skin_;  ///< Margin of the neighbour lists [m].
  std::int64_t steps_ = 0;
  std::int64_t collisions_ = 0;
  std::size_t robots_ = 0;
  std::size_t visible_kinematic_ = 0;
  NeighbourList neighbours_;
  SlidingContacts sliding_;
  // Robots first, then kinematic disks.
  DiskBodies bodies_;
  std::vector<Vec> from_;       ///< Centres at the start of the step; with kSlide only.
  std::vector<Vec> listed_at_;  ///< Centres when the neighbours were listed.
  std::vector<Contacts> contacts_;
};

}  // namespace lab::sim
