#include "sim_svc/world/contact_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "common/math/random.hpp"

namespace lab::sim::contact_solver_test {
namespace {

double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y; }

Vec unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

TEST(ContactSolver, LeavesDisksThatDoNotOverlapWhereTheyAre) {
  std::vector<ContactDisk> disks(2);
  std::vector<DiskContact> contacts(1);
  contacts[0] = {.first = 0, .second = 1, .normal = {1, 0}, .gap = 1e-9, .slide = 1e-3};
  ContactSolver dut({}, 0.5);

  EXPECT_EQ(dut.solve(disks, contacts), 1);

  EXPECT_EQ(disks[0].shift.x, 0);
  EXPECT_EQ(disks[1].roll, 0);
  EXPECT_EQ(contacts[0].normal_push, 0);
}

TEST(ContactSolver, PushesADiskOutOfAWallInTheDirectionOfItsMobility) {
  // The shift is M n d / (n M n), with M = across + (1 - across) h h.
  const double depth = 1e-3;
  const double across = 0.2;
  for (const double angle : {0.0, 0.4, 1.2, 2.9}) {
    std::vector<ContactDisk> disks(1);
    disks[0].heading = unit(angle);
    std::vector<DiskContact> contacts(1);
    contacts[0] = {.first = 0, .normal = {0, 1}, .gap = -depth};
    ContactSolver dut({across, 1}, 0);

    dut.solve(disks, contacts);

    const Vec moved = {(1 - across) * std::cos(angle) * std::sin(angle),
                       across + (1 - across) * std::sin(angle) * std::sin(angle)};
    EXPECT_NEAR(disks[0].shift.x, depth * moved.x / moved.y, 1e-15);
    EXPECT_NEAR(disks[0].shift.y, depth, 1e-15);
    EXPECT_EQ(disks[0].roll, 0);
  }
}

TEST(ContactSolver, SharesAnOverlapByTheMobilitiesOfBothDisks) {
  // The first disk is pushed along its wheels (1), the second one across them (0.25).
  std::vector<ContactDisk> disks(2);
  disks[0].heading = {1, 0};
  disks[1].heading = {0, 1};
  std::vector<DiskContact> contacts(1);
  contacts[0] = {.first = 0, .second = 1, .normal = {-1, 0}, .gap = -1e-3};
  ContactSolver dut({0.25, 1}, 0);

  dut.solve(disks, contacts);

  EXPECT_NEAR(disks[0].shift.x, -0.8e-3, 1e-15);
  EXPECT_NEAR(disks[1].shift.x, 0.2e-3, 1e-15);
}

TEST(ContactSolver, RollsWithinTheFrictionAndSlidesBeyondIt) {
  // On a wall, with the normal (0, 1) the tangent is (-1, 0). The rim slides by s in the free
  // motion. Rolling takes a push of s / (1 + turn).
  const double depth = 1e-3;
  const double turn = 0.5;
  for (const double friction : {0.1, 0.6}) {
    for (const double slide : {4e-4, -4e-4}) {
      std::vector<ContactDisk> disks(1);
      std::vector<DiskContact> contacts(1);
      contacts[0] = {.first = 0, .normal = {0, 1}, .gap = -depth, .slide = slide};
      ContactSolver dut({1, turn}, friction);

      dut.solve(disks, contacts);

      const double rolling = std::fabs(slide) / (1 + turn);
      const double push = std::copysign(std::min(rolling, friction * depth), -slide);
      EXPECT_NEAR(contacts[0].tangent_push, push, 1e-15);
      EXPECT_NEAR(disks[0].shift.x, -push, 1e-15);
      EXPECT_NEAR(disks[0].roll, -turn * push, 1e-15);
      const double slid = slide - disks[0].shift.x - disks[0].roll;
      EXPECT_EQ(std::fabs(slid) < 1e-15, friction == 0.6) << slid;
    }
  }
}

TEST(ContactSolver, PushesARowOfDisksTogether) {
  // The first of n disks overlaps the second one by d: the row moves by d / n.
  constexpr std::uint32_t kDisks = 10;
  std::vector<ContactDisk> disks(kDisks);
  std::vector<DiskContact> contacts;
  for (std::uint32_t i = 0; i + 1 < kDisks; ++i) {
    contacts.push_back({.first = i, .second = i + 1, .normal = {-1, 0}});
  }
  contacts[0].gap = -1e-3;
  ContactSolver dut({}, 0.3);

  const int sweeps = dut.solve(disks, contacts);

  EXPECT_LT(sweeps, ContactSolver::kMostSweeps);
  EXPECT_NEAR(disks[0].shift.x, -0.9e-3, 5e-6);
  for (std::uint32_t i = 1; i < kDisks; ++i) EXPECT_NEAR(disks[i].shift.x, 0.1e-3, 5e-6) << i;
}

TEST(ContactSolver, LimitsThePushOfAContact) {
  // Pressed between a wall and something that pushes with a limited force: the wall holds.
  std::vector<ContactDisk> disks(1);
  std::vector<DiskContact> contacts(2);
  contacts[0] = {.first = 0, .normal = {0, 1}, .gap = 0};
  contacts[1] = {.first = 0, .normal = {0, -1}, .gap = -1e-3, .most_push = 0.05};
  ContactSolver dut({}, 0.2);

  const int sweeps = dut.solve(disks, contacts);

  EXPECT_LT(sweeps, ContactSolver::kMostSweeps);
  EXPECT_EQ(contacts[1].normal_push, 0.05);
  EXPECT_NEAR(disks[0].shift.y, 0, 1e-6);
}

/// Disks on a hexagonal lattice with small random overlaps, in a corner of two walls.
struct Heap {
  std::vector<ContactDisk> disks;
  std::vector<DiskContact> contacts;
};

Heap heapOf(std::uint32_t columns, std::uint32_t rows, Random& random) {
  Heap heap;
  std::vector<Vec> centres;
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      centres.push_back({column + 0.5 * (row % 2), row * std::numbers::sqrt3 / 2});
      heap.disks.push_back({unit(7 * random.uniform()), {}, 0});
    }
  }
  const auto some = [&random] { return 1e-3 * (random.uniform() - 0.5); };
  for (std::uint32_t i = 0; i < centres.size(); ++i) {
    for (std::uint32_t j = 0; j < i; ++j) {
      const Vec apart = {centres[i].x - centres[j].x, centres[i].y - centres[j].y};
      const double distance = std::hypot(apart.x, apart.y);
      if (distance > 1.1) continue;
      heap.contacts.push_back({.first = i,
                               .second = j,
                               .normal = {apart.x / distance, apart.y / distance},
                               .gap = some(),
                               .slide = some()});
    }
    if (centres[i].y == 0) {
      heap.contacts.push_back({.first = i, .normal = {0, 1}, .gap = some(), .slide = some()});
    }
    if (centres[i].x == 0) {
      heap.contacts.push_back({.first = i, .normal = {1, 0}, .gap = some(), .slide = some()});
    }
  }
  return heap;
}

TEST(ContactSolver, SolvesHeapsWithoutOverlapPullOrTooMuchFriction) {
  Random random(3);
  for (const double friction : {0.0, 0.2, 0.8}) {
    for (const SlipMobility mobility : {SlipMobility{1, 1}, SlipMobility{0.1, 0.5}}) {
      for (int heap = 0; heap < 20; ++heap) {
        auto [disks, contacts] = heapOf(6, 5, random);
        ContactSolver dut(mobility, friction);

        const int sweeps = dut.solve(disks, contacts);

        ASSERT_LT(sweeps, ContactSolver::kMostSweeps) << friction << " " << mobility.across;
        for (const DiskContact& contact : contacts) {
          Vec shift = disks[contact.first].shift;
          double roll = disks[contact.first].roll;
          if (contact.second != DiskContact::kFixed) {
            shift.x -= disks[contact.second].shift.x;
            shift.y -= disks[contact.second].shift.y;
            roll += disks[contact.second].roll;
          }
          const double gap = contact.gap + dot(contact.normal, shift);
          const double slide =
              contact.slide + dot({-contact.normal.y, contact.normal.x}, shift) - roll;
          ASSERT_GE(gap, -ContactSolver::kMostOverlap);
          ASSERT_GE(contact.normal_push, 0);
          // Pushes end where the gap opens, up to what neighbours moved after this contact.
          if (contact.normal_push > 0) {
            ASSERT_LT(gap, 5 * ContactSolver::kTolerance);
          }
          if (sweeps >= ContactSolver::kCoulombSweeps) continue;
          const double most = friction * contact.normal_push;
          ASSERT_LE(std::fabs(contact.tangent_push), most * (1 + 1e-9));
          // Friction acts against the slide, and fully where the rims slide.
          if (std::fabs(slide) < 5 * ContactSolver::kTolerance) continue;
          ASSERT_LE(contact.tangent_push * slide, 0);
          ASSERT_GE(std::fabs(contact.tangent_push), most * (1 - 1e-9));
        }
      }
    }
  }
}

}  // namespace
}  // namespace lab::sim::contact_solver_test
