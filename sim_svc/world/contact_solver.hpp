/// Forces between touching disks whose motion is overdamped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sim_svc/world/arena.hpp"

namespace lab::sim {

/// How easily contact forces move a robot against its wheels. Speeds are proportional to forces
/// (overdamped); along the wheels the ratio is 1, because only ratios of mobilities matter.
struct SlipMobility {
  double across = 1;  ///< Across the wheels; above 0.
  double turn = 1;    ///< Speed of the rim by a force along the rim; 0 or more.
};

/// One disk of an island, with the displacement that its contacts give it.
struct ContactDisk {
  Vec heading{1, 0};  ///< Unit vector.
  Vec shift;          ///< [m]
  double roll = 0;    ///< Rotation times radius [m].
};

/// One contact over one step: of two disks, or of a disk with something that no force moves.
///
/// Pushes are forces times the duration of the step and the mobility along the wheels, which gives
/// a length: a robot that is pushed along its wheels by 1 mm moves by 1 mm.
struct DiskContact {
  static constexpr std::uint32_t kFixed = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t first = 0;
  std::uint32_t second = kFixed;  ///< Index of a disk, or kFixed.
  Vec normal;                     ///< Unit vector towards the first disk.
  double gap = 0;    ///< Between the rims after the free motion; negative: they overlap [m].
  double slide = 0;  ///< Of the first rim over the second in the free motion, on the tangent [m].
  double most_push = std::numeric_limits<double>::infinity();  ///< Limit of normal_push [m].

  double normal_push = 0;   ///< 0 or more [m]. Its initial value is a guess.
  double tangent_push = 0;  ///< Along the tangent, which is the normal turned by +90 degrees [m].
};

/// The displacements and pushes with which, at the end of the step,
///
/// - no gap is negative, a push acts only where the gap is 0, and pushes do not pull;
/// - friction is Coulomb's: |tangent_push| <= friction * normal_push, with equality against the
///   slide where the rims slide.
///
/// The gaps are linear in the displacements. Rims of disks are convex, so the true gaps are at
/// least as large. The contacts are solved in turn, each exactly, until no solution of a contact
/// changes its displacements any more (nonlinear Gauss-Seidel: Jean, Comput. Methods Appl. Mech.
/// Eng. 177, 1999).
///
/// Where many disks are wedged together, friction does not determine the pushes, and the iteration
/// may not settle. After kCoulombSweeps the largest tangential pushes are therefore kept. What is
/// left is a convex problem, which converges.
class ContactSolver {
 public:
  /// The iteration ends when no contact changes the displacements by more than this [m] ...
  static constexpr double kTolerance = 1e-7;
  /// ... and no disks overlap by more than this [m].
  static constexpr double kMostOverlap = 4e-7;
  static constexpr int kCoulombSweeps = 100;
  static constexpr int kMostSweeps = 3000;

  /// @param friction coefficient of all contacts
  ContactSolver(const SlipMobility& mobility, double friction)
      : mobility_(mobility), friction_(friction) {}

  /// Solves one island. The shifts and rolls of `disks` are 0 before.
  /// @return the number of sweeps; kMostSweeps if the tolerance was not reached
  int solve(std::span<ContactDisk> disks, std::span<DiskContact> contacts);

 private:
  /// What does not change during the iteration: the displacements of both disks by pushes of 1 (of
  /// the second one against it), and the matrix (nn, nt; nt, tt) of displacements of the rims
  /// against each other.
  struct Row {
    Vec first_normal;
    Vec first_tangent;
    Vec second_normal;
    Vec second_tangent;
    double nn = 0;
    double nt = 0;
    double tt = 0;
  };

  [[nodiscard]] Row rowOf(const DiskContact& contact, std::span<const ContactDisk> disks) const;
  void apply(const Row& row, const DiskContact& contact, double normal, double tangent,
             std::span<ContactDisk> disks) const;
  void accelerate(std::span<ContactDisk> disks, std::span<DiskContact> contacts);
  double sweepIsotropic(std::span<ContactDisk> disks, std::span<DiskContact> contacts) const;
  double sweepRows(std::span<ContactDisk> disks, std::span<DiskContact> contacts) const;

  SlipMobility mobility_;
  double friction_;
  std::vector<Row> rows_;  ///< Per contact.
  std::vector<double> now_, before_, extrapolated_;
  double momentum_ = 1;
  std::vector<double> most_tangent_;  ///< Per contact; empty while Coulomb's law holds exactly.
};

}  // namespace lab::sim
