// One-hour recordings of shipped programs, executed by the robot's core, against an independent
// simulation of the same motion in double precision: the MSD at all lags.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "common/programs/program_library.hpp"
#include "common/programs/shipped_programs.hpp"
#include "robot/dynamics/robot_core.hpp"

namespace lab::program_films_test {
namespace {

using Complex = std::complex<double>;
using Rng64 = std::mt19937_64;

constexpr double kPi = std::numbers::pi;
constexpr double kWheelBase = 7.5;  // cm
constexpr int kFilms = 100;
constexpr double kHour = 3600;      // s
constexpr double kSampling = 0.25;  // s
constexpr double kSpeed = 5;        // cm/s
constexpr std::array<int, 12> kLags{1, 2, 4, 8, 16, 24, 32, 48, 80, 120, 200, 400};

/// Positions of a robot at equal intervals, from motion that is given hold by hold.
class Film {
 public:
  [[nodiscard]] bool full() const { return time_ >= kHour; }

  /// Constant forward speed [cm/s] and turning rate [rad/s] for a time [s].
  void drive(double forward, double rate, double duration) {
    const double end = std::min(time_ + duration, kHour);
    double next = static_cast<double>(places_.size()) * kSampling;
    while (next <= end) {
      places_.push_back(place_ + arc(forward, rate, next - time_));
      next = static_cast<double>(places_.size()) * kSampling;
    }
    place_ += arc(forward, rate, duration);
    heading_ += rate * duration;
    time_ += duration;
  }

  [[nodiscard]] double heading() const { return heading_; }
  [[nodiscard]] double time() const { return time_; }

  /// Averaged over all windows [cm^2].
  [[nodiscard]] double msd(int lag) const {
    double sum = 0;
    const auto step = static_cast<std::size_t>(lag);
    for (std::size_t i = 0; i + step < places_.size(); ++i) {
      sum += std::norm(places_[i + step] - places_[i]);
    }
    return sum / static_cast<double>(places_.size() - step);
  }

 private:
  [[nodiscard]] Complex arc(double forward, double rate, double time) const {
    const double angle = rate * time;
    const Complex own = std::abs(angle) < 1e-9
                            ? Complex(forward * time)
                            : forward * (std::polar(1.0, angle) - 1.0) / Complex(0, rate);
    return std::polar(1.0, heading_) * own;
  }

  std::vector<Complex> places_;
  Complex place_ = 0;
  double heading_ = 0;
  double time_ = 0;
};

Film filmOf(const Program& program, std::uint64_t seed) {
  ProgramLibrary library;
  library.add(program.hash, program.code);
  dynamics::CoreSettings settings;
  settings.light.count = 1;
  settings.light.bands[0] = {0, 1024, 0};
  settings.programs[0] = program.hash;
  dynamics::RobotCore core(library);
  core.seed(seed);
  core.configure(0, settings);
  core.renewLease(0, dynamics::RobotCore::kNoEventMs);
  core.sense(0, {});
  Film film;
  std::uint32_t now = 0;
  while (!film.full()) {
    const dynamics::WheelSpeedsUmS wheels = core.wheels();
    const std::uint32_t next = core.nextEventMs(now);
    film.drive((wheels.left + wheels.right) / 2e4,
               (wheels.right - wheels.left) / (kWheelBase * 1e4), (next - now) * 1e-3);
    now = next;
    core.advanceTo(now);
  }
  EXPECT_EQ(core.record().saturation_count, 0U);
  return film;
}

struct Curve {
  std::array<double, kLags.size()> mean{};
  std::array<double, kLags.size()> error{};
};

Curve curveOf(const std::function<Film(std::uint64_t seed)>& make) {
  Curve curve;
  std::array<double, kLags.size()> squares{};
  for (int i = 0; i < kFilms; ++i) {
    const Film film = make(static_cast<std::uint64_t>(i) + 1);
    for (std::size_t k = 0; k < kLags.size(); ++k) {
      const double msd = film.msd(kLags[k]);
      curve.mean[k] += msd / kFilms;
      squares[k] += msd * msd / kFilms;
    }
  }
  for (std::size_t k = 0; k < kLags.size(); ++k) {
    curve.error[k] = std::sqrt((squares[k] - curve.mean[k] * curve.mean[k]) / (kFilms - 1)) + 1e-6;
  }
  return curve;
}

double largestZ(const Curve& a, const Curve& b) {
  double largest = 0;
  for (std::size_t k = 0; k < kLags.size(); ++k) {
    largest =
        std::max(largest, std::abs(a.mean[k] - b.mean[k]) / std::hypot(a.error[k], b.error[k]));
  }
  return largest;
}

/// Compares the program with `make`, and shows that the comparison can tell `wrong` from it.
void compare(const Program& program, const std::function<Film(std::uint64_t seed)>& make,
             const std::function<Film(std::uint64_t seed)>& wrong) {
  const Curve dut = curveOf([&](std::uint64_t seed) { return filmOf(program, seed); });
  EXPECT_LT(largestZ(dut, curveOf(make)), 4);
  EXPECT_GT(largestZ(dut, curveOf(wrong)), 4);
}

double uniform(Rng64& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

/// Robots count whole milliseconds.
double wholeMs(double seconds) { return std::round(seconds * 1e3) * 1e-3; }

Film levy(std::uint64_t seed, double exponent) {
  Rng64 rng(seed + 1000);
  Film film;
  while (!film.full()) {
    const double pareto = 0.2 * std::pow(1 - uniform(rng, 0, 1), -1 / exponent);
    film.drive(kSpeed, 0, wholeMs(std::min(pareto, 600.0)));
    film.drive(0, uniform(rng, -kPi, kPi) / 0.5, 0.5);
  }
  return film;
}

TEST(ProgramFilms, LevyRunsFollowAnIndependentSimulation) {
  compare(
      shippedProgram("levy"), [](std::uint64_t seed) { return levy(seed, 1.5); },
      [](std::uint64_t seed) { return levy(seed, 1.58); });
}

Film resetting(std::uint64_t seed, double rate) {
  Rng64 rng(seed + 2000);
  Film film;
  while (!film.full()) {
    film.drive(kSpeed, uniform(rng, -2, 2), 0.2);
    if (uniform(rng, 0, 1) >= rate * 0.2) continue;
    film.drive(0, -std::remainder(film.heading(), 2 * kPi) / 0.5, 0.5);
  }
  return film;
}

TEST(ProgramFilms, ResettingOfTheDirectionFollowsAnIndependentSimulation) {
  compare(
      shippedProgram("resetting"), [](std::uint64_t seed) { return resetting(seed, 0.2); },
      [](std::uint64_t seed) { return resetting(seed, 0.21); });
}

Film runReverse(std::uint64_t seed, double gamma) {
  Rng64 rng(seed + 3000);
  Film film;
  double sign = 1;
  while (!film.full()) {
    if (uniform(rng, 0, 1) < gamma * 0.1) sign = -sign;
    film.drive(sign * kSpeed, uniform(rng, -0.4, 0.4), 0.1);
  }
  return film;
}

TEST(ProgramFilms, RunsWithReversalsFollowAnIndependentSimulation) {
  compare(
      shippedProgram("run_reverse"), [](std::uint64_t seed) { return runReverse(seed, 0.5); },
      [](std::uint64_t seed) { return runReverse(seed, 0.525); });
}

Film chiral(std::uint64_t seed, double omega) {
  Rng64 rng(seed + 4000);
  Film film;
  while (!film.full()) film.drive(kSpeed, omega + uniform(rng, -1.5, 1.5), 0.2);
  return film;
}

TEST(ProgramFilms, ChiralParticlesFollowAnIndependentSimulation) {
  compare(
      shippedProgram("chiral_abp"), [](std::uint64_t seed) { return chiral(seed, 0.8); },
      [](std::uint64_t seed) { return chiral(seed, 0.84); });
}

Film runReverseFlick(std::uint64_t seed, double gamma) {
  Rng64 rng(seed + 5000);
  Film film;
  const auto run = [&] { return wholeMs(std::exponential_distribution<double>(gamma)(rng)); };
  while (!film.full()) {
    film.drive(kSpeed, 0, run());
    film.drive(-kSpeed, 0, run());
    film.drive(0, (uniform(rng, 0, 1) < 0.5 ? 1 : -1) * kPi / 2 / 0.3, 0.3);
  }
  return film;
}

TEST(ProgramFilms, RunsWithReversalsAndFlicksFollowAnIndependentSimulation) {
  compare(
      shippedProgram("run_reverse_flick"),
      [](std::uint64_t seed) { return runReverseFlick(seed, 0.5); },
      [](std::uint64_t seed) { return runReverseFlick(seed, 0.525); });
}

Film ornsteinUhlenbeck(std::uint64_t seed, double tau) {
  Rng64 rng(seed + 6000);
  Film film;
  std::normal_distribution<double> normal;
  const double kept = 1 - 0.1 / tau;
  const double kick = std::sqrt(1 - kept * kept);
  double speed = 0;
  double rate = 0;
  while (!film.full()) {
    speed = speed * kept + 3 * kick * normal(rng);
    rate = rate * kept + 0.8 * kick * normal(rng);
    film.drive(speed, rate, 0.1);
  }
  return film;
}

// The speeds are below the shipped ones, so that no draw of 100 hours needs faster wheels.
TEST(ProgramFilms, OrnsteinUhlenbeckSpeedsFollowAnIndependentSimulation) {
  compare(
      shippedProgram("aoup", {{"v_rms", "3 cm/s"}, {"turn_rms", "0.8 rad/s"}}),
      [](std::uint64_t seed) { return ornsteinUhlenbeck(seed, 1); },
      [](std::uint64_t seed) { return ornsteinUhlenbeck(seed, 1.05); });
}

Film memory(std::uint64_t seed, double tau) {
  Rng64 rng(seed + 7000);
  Film film;
  double rate = 0;
  while (!film.full()) {
    rate = std::clamp(rate + 0.1 / tau * (uniform(rng, -10, 10) - rate), -4.0, 4.0);
    film.drive(kSpeed, rate, 0.1);
  }
  return film;
}

TEST(ProgramFilms, ParticlesWithMemoryFollowAnIndependentSimulation) {
  compare(
      shippedProgram("memory"), [](std::uint64_t seed) { return memory(seed, 2); },
      [](std::uint64_t seed) { return memory(seed, 2.1); });
}

}  // namespace
}  // namespace lab::program_films_test
