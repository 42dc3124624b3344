/// Interface to robots whose programs run outside the world.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sim_svc/world.hpp"

namespace lab::sim {

/// A group of external robots of a world, with their programs and their ends of the serial lines.
/// Robot k of a driver is the world's robot body(k).
class BodyDriver {
 public:
  BodyDriver() = default;
  BodyDriver(const BodyDriver&) = delete;
  BodyDriver& operator=(const BodyDriver&) = delete;
  virtual ~BodyDriver() = default;

  [[nodiscard]] virtual std::size_t size() const = 0;
  [[nodiscard]] virtual std::size_t body(std::size_t k) const = 0;

  /// Bytes that the host sends to robot k at the world's present time. They reach the robot at the
  /// line's speed.
  virtual void receive(std::size_t k, std::span<const std::uint8_t> bytes) = 0;

  /// Runs the programs from the world's time to until_us (world time). They sense the present world
  /// and set its motors at exact times before until_us; the world itself is not advanced.
  virtual void advance(World& world, std::int64_t until_us) = 0;

  /// The bytes that robot k has sent to the host in the last advance().
  [[nodiscard]] virtual std::span<const std::uint8_t> sent(std::size_t k) const = 0;

  /// The hash of the program that robot k runs, 0 if it stands, or kUnknown.
  [[nodiscard]] virtual std::int64_t program(std::size_t k) const = 0;
  static constexpr std::int64_t kUnknown = -1;
};

}  // namespace lab::sim
