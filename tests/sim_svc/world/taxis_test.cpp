// The drift of tactic programs in a gradient of light, against an independent simulation of the
// same motion in double precision and, where there is one, against the limit of short holds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/support/world_fixture.hpp"

namespace lab::sim::taxis_test {
namespace {

using Complex = std::complex<double>;
using Rng64 = std::mt19937_64;

constexpr double kPi = std::numbers::pi;
constexpr double kRamp = 600;     // [cm], from dark to bright: five times the arena of the lab
constexpr double kOffset = 3;     // [cm] of the light sensors from the axle
constexpr double kCounts = 1023;  // of a sensor in full light
constexpr double kScan = 0.02;    // [s]
constexpr double kSpeed = 5;      // [cm/s]
constexpr Complex kStart(150, 300);
constexpr int kFilms = 400;

/// Light that grows along a direction.
class Ramp : public LightSampler {
 public:
  explicit Ramp(double direction) : x_(std::cos(direction)), y_(std::sin(direction)) {}
  [[nodiscard]] double at(double x, double y) const override {
    return 0.25 + ((x * 100 - kStart.real()) * x_ + (y * 100 - kStart.imag()) * y_) / kRamp;
  }

 private:
  double x_;
  double y_;
};

/// Displacements of films [cm]: real along the gradient, imaginary to its left.
using Films = std::vector<Complex>;

double uniform(Rng64& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

/// Films of one robot each, so that robots do not meet.
Films filmsOf(const Program& program, double seconds, double direction = 0) {
  Films films;
  const Ramp light(direction);
  const dynamics::CoreSettings settings = always(program);
  for (int i = 0; i < kFilms; ++i) {
    WorldSettings hardware = idealHardware();
    hardware.arena = {8, 6};
    hardware.seed = static_cast<std::uint64_t>(i) + 1;
    Rng64 rng(hardware.seed);
    const double x = kStart.real() / 100;
    const double y = kStart.imag() / 100;
    World world(hardware, robotAt(x, y, uniform(rng, -kPi, kPi)));
    world.setLight(&light);
    startAll(world, settings);
    world.advanceTo(static_cast<std::int64_t>(seconds * kSecond));
    const Complex moved(world.pose(0).x - x, world.pose(0).y - y);
    films.push_back(100.0 * moved * std::polar(1.0, -direction));
  }
  return films;
}

struct Estimate {
  double mean = 0;
  double error = 0;
};

Estimate estimate(const Films& films, double (*part)(const Complex&)) {
  double sum = 0;
  double squares = 0;
  for (const Complex& film : films) {
    sum += part(film);
    squares += part(film) * part(film);
  }
  const auto n = static_cast<double>(films.size());
  const double mean = sum / n;
  return {mean, std::sqrt((squares / n - mean * mean) / (n - 1))};
}

Estimate along(const Films& films) {
  return estimate(films, [](const Complex& film) { return film.real(); });
}

Estimate across(const Films& films) {
  return estimate(films, [](const Complex& film) { return film.imag(); });
}

double zOf(const Estimate& a, const Estimate& b) {
  return std::abs(a.mean - b.mean) / std::hypot(a.error, b.error);
}

/// A robot in the gradient, hold by hold.
class Rover {
 public:
  explicit Rover(Rng64& rng) : heading_(uniform(rng, -kPi, kPi)) { look(); }

  void drive(double forward, double rate, double duration) {
    // Robots scan when a hold ends, and evaluate the next phase with the scan before that one.
    advance(forward, rate, duration - kScan);
    look();
    advance(forward, rate, kScan);
    time_ += duration;
  }

  [[nodiscard]] double front() const { return front_; }
  [[nodiscard]] double back() const { return back_; }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] Complex displacement() const { return place_ - kStart; }

 private:
  static double reading(const Complex& place) {
    return std::round(kCounts * std::clamp(place.real() / kRamp, 0.0, 1.0)) / kCounts;
  }

  void look() {
    const Complex offset = std::polar(kOffset, heading_);
    front_ = reading(place_ + offset);
    back_ = reading(place_ - offset);
  }

  void advance(double forward, double rate, double time) {
    const double angle = rate * time;
    const double half = angle / 2;
    const double chord = std::abs(half) < 1e-9 ? 1 : std::sin(half) / half;
    place_ += std::polar(forward * time * chord, heading_ + half);
    heading_ += angle;
  }

  Complex place_ = kStart;
  double heading_;
  double front_ = 0;
  double back_ = 0;
  double time_ = 0;
};

Films simulated(std::uint64_t seed, double seconds,
                const std::function<void(Rover&, Rng64&, double)>& film) {
  Films films;
  for (int i = 0; i < kFilms; ++i) {
    Rng64 rng(seed + static_cast<std::uint64_t>(i));
    Rover rover(rng);
    film(rover, rng, seconds);
    films.push_back(rover.displacement());
  }
  return films;
}

void phototaxis(Rover& rover, Rng64& rng, double gain, double seconds) {
  while (rover.time() < seconds - 1e-9) {
    const double eta = 3 * std::clamp(1 - gain * (rover.front() - rover.back()), 0.1, 1.9);
    rover.drive(kSpeed, uniform(rng, -eta, eta), 0.2);
  }
}

// The ramp has a fifth of the gradient of the shipped experiment, and the gain is five times the
// shipped one: the same motion, over a longer way.
TEST(Phototaxis, DriftsToTheLightAsAnIndependentSimulation) {
  constexpr double kTime = 60;
  const Films dut = filmsOf(shippedProgram("phototaxis", {{"gain", "80"}}), kTime);
  const auto films = [](double gain) {
    return simulated(1000, kTime, [gain](Rover& rover, Rng64& rng, double seconds) {
      phototaxis(rover, rng, gain, seconds);
    });
  };
  EXPECT_LT(zOf(along(dut), along(films(80))), 4);
  EXPECT_GT(zOf(along(dut), along(films(65))), 4) << "the test must be able to fail";
  EXPECT_GT(along(dut).mean, 0.6 * kSpeed * kTime);
  EXPECT_LT(std::abs(across(dut).mean), 4 * across(dut).error);
  RecordProperty("drift_cm_s", std::to_string(along(dut).mean / kTime));
}

TEST(Phototaxis, DriftsToTheLightWhereverItIs) {
  const Films dut = filmsOf(shippedProgram("phototaxis", {{"gain", "80"}}), 30, 2.2);
  EXPECT_GT(along(dut).mean, 20 * along(dut).error);
  EXPECT_LT(std::abs(across(dut).mean), 4 * across(dut).error);
}

// For short holds the heading diffuses with D_r(theta) proportional to (1 - g cos(theta))^2, where
// g = gain (front - back) when heading for the light. Its density is proportional to 1 / D_r, and
// the mean of cos(theta) is g.
TEST(Phototaxis, HasTheDriftOfShortHolds) {
  constexpr double kTime = 120;
  constexpr double kSlow = 2;  // [cm/s]
  const double g = 50 * 2 * kOffset / kRamp;
  // 1 - g cos stays within the bounds of the program, and the noise of a hold is below 0.45 rad.
  const Films dut = filmsOf(
      shippedProgram("phototaxis", {{"v", "2 cm/s"}, {"gain", "50"}, {"epsilon", "0.1 s"}}), kTime);
  const Estimate drift = along(dut);
  // The way until the heading has its stationary density takes part of the first seconds.
  EXPECT_NEAR(drift.mean / (g * kSlow * kTime), 1, 0.12) << drift.error;
}

void runAndTumble(Rover& rover, Rng64& rng, double gain, double seconds) {
  double memory = 0;
  while (rover.time() < seconds - 1e-9) {
    const double light = (rover.front() + rover.back()) / 2;
    const double change = light - memory;
    memory += 0.2 * change;
    const bool tumbles = uniform(rng, 0, 1) < std::clamp(0.1 * (1 - gain * change), 0.0, 1.0);
    rover.drive(kSpeed, 0, 0.1);
    if (tumbles) rover.drive(0, uniform(rng, -kPi, kPi) / 0.5, 0.5);
  }
}

TEST(RunAndTumbleTaxis, DriftsToTheLightAsAnIndependentSimulation) {
  constexpr double kTime = 60;
  const Films dut = filmsOf(shippedProgram("run_and_tumble_taxis", {{"gain", "100"}}), kTime);
  const auto films = [](double gain) {
    return simulated(3000, kTime, [gain](Rover& rover, Rng64& rng, double seconds) {
      runAndTumble(rover, rng, gain, seconds);
    });
  };
  EXPECT_LT(zOf(along(dut), along(films(100))), 4);
  EXPECT_GT(zOf(along(dut), along(films(40))), 4) << "the test must be able to fail";
  EXPECT_GT(along(dut).mean, 8 * along(dut).error);
  EXPECT_LT(std::abs(across(dut).mean), 4 * across(dut).error);
  RecordProperty("drift_cm_s", std::to_string(along(dut).mean / kTime));
}

}  // namespace
}  // namespace lab::sim::taxis_test
