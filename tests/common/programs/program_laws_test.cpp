// Shipped programs, executed by the robot's machine, against their exact mean squared displacement.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "common/programs/program_file.hpp"
#include "robot/dynamics/machine.hpp"

namespace lab::program_laws_test {
namespace {

using Complex = std::complex<double>;

constexpr double kWheelBase = 7.5;  // cm
constexpr int kRobots = 20000;

language::CompiledProgram shipped(const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(LAB_MOTION_PROGRAMS) / (name + ".toml");
  std::ifstream stream(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return readProgram(text, file.string(), name).compiled;
}

/// The displacement in one hold at constant wheel speeds, in the frame of its beginning [cm].
Complex arc(double speed, double rate, double time) {
  const double angle = rate * time;
  if (std::abs(angle) < 1e-9) return speed * time;
  return speed * (std::polar(1.0, angle) - 1.0) / Complex(0, rate);
}

/// Squared displacements after each of `holds` holds: mean and standard error over many robots.
struct Msd {
  std::vector<double> mean;
  std::vector<double> error;
};

Msd simulatedMsd(const language::CompiledProgram& program, std::size_t holds) {
  std::vector<double> sum(holds);
  std::vector<double> squares(holds);
  const dynamics::MachineInputs inputs;
  for (int robot = 0; robot < kRobots; ++robot) {
    dynamics::Rng rng(static_cast<std::uint64_t>(robot));
    dynamics::Machine machine;
    machine.start(program.code.data(), static_cast<std::uint8_t>(program.code.size()), inputs, rng);
    Complex position = 0;
    double heading = 0;
    for (std::size_t i = 0; i < holds; ++i) {
      const dynamics::PhaseResult hold = machine.next(inputs, rng);
      const double time = hold.duration_ms * 1e-3;
      const double speed = (hold.left_um_s + hold.right_um_s) / 2.0 * 1e-4;
      const double rate = (hold.right_um_s - hold.left_um_s) * 1e-4 / kWheelBase;
      position += std::polar(1.0, heading) * arc(speed, rate, time);
      heading += rate * time;
      sum[i] += std::norm(position);
      squares[i] += std::norm(position) * std::norm(position);
    }
    EXPECT_EQ(machine.saturationCount(), 0U);
  }
  Msd msd;
  for (std::size_t i = 0; i < holds; ++i) {
    const double mean = sum[i] / kRobots;
    msd.mean.push_back(mean);
    msd.error.push_back(std::sqrt((squares[i] / kRobots - mean * mean) / kRobots));
  }
  return msd;
}

/// The exact law of independent holds of equal duration. With the displacement d of a hold in its
/// own frame and its turn phi, <|r_n|^2> = n <|d|^2> + 2 Re(<d* e^(i phi)> <d> S), where S is the
/// sum of (n - 1 - m) <e^(i phi)>^m over m = 0 .. n - 2. `correlation` is that of the sign of the
/// speed between neighbouring holds, which is independent of the turns.
struct HoldAverages {
  Complex displacement;  ///< <d>
  Complex turned;        ///< <d* e^(i phi)>
  Complex rotation;      ///< <e^(i phi)>
  double square = 0;     ///< <|d|^2>
};

/// Averages over a uniform rate in [low, high], by Simpson's rule.
HoldAverages averages(double speed, double low, double high, double time) {
  constexpr int kIntervals = 2000;
  HoldAverages result;
  for (int i = 0; i <= kIntervals; ++i) {
    const double rate = low + (high - low) * i / kIntervals;
    const double weight = (i == 0 || i == kIntervals ? 1.0
                           : i % 2 == 1              ? 4.0
                                                     : 2.0) /
                          3 / kIntervals;
    const Complex d = arc(speed, rate, time);
    const Complex rotation = std::polar(1.0, rate * time);
    result.displacement += weight * d;
    result.turned += weight * std::conj(d) * rotation;
    result.rotation += weight * rotation;
    result.square += weight * std::norm(d);
  }
  return result;
}

double exactMsd(const HoldAverages& hold, int n, double correlation) {
  Complex sum = 0;
  Complex power = correlation;
  for (int m = 0; m <= n - 2; ++m) {
    sum += static_cast<double>(n - 1 - m) * power;
    power *= hold.rotation * correlation;
  }
  return n * hold.square + 2 * (hold.turned * hold.displacement * sum).real();
}

double largestZ(const Msd& msd, const std::function<double(int)>& law) {
  double largest = 0;
  for (std::size_t i = 0; i < msd.mean.size(); ++i) {
    const double exact = law(static_cast<int>(i) + 1);
    // Without spread, as the first hold of an ABP of constant speed, only rounding remains.
    const double error = std::max(msd.error[i], 1e-4 * exact);
    largest = std::max(largest, std::abs(msd.mean[i] - exact) / error);
  }
  return largest;
}

TEST(ProgramLaws, ActiveBrownianParticle) {
  const HoldAverages hold = averages(5, -3, 3, 0.5);
  EXPECT_LT(
      largestZ(simulatedMsd(shipped("abp"), 100), [&](int n) { return exactMsd(hold, n, 1); }), 4);
}

TEST(ProgramLaws, ChiralActiveBrownianParticle) {
  const HoldAverages hold = averages(5, 0.8 - 1.5, 0.8 + 1.5, 0.2);
  EXPECT_LT(largestZ(simulatedMsd(shipped("chiral_abp"), 100),
                     [&](int n) { return exactMsd(hold, n, 1); }),
            4);
  // The test can tell a turning rate that is 5 % wrong.
  const HoldAverages wrong = averages(5, 0.84 - 1.5, 0.84 + 1.5, 0.2);
  EXPECT_GT(largestZ(simulatedMsd(shipped("chiral_abp"), 100),
                     [&](int n) { return exactMsd(wrong, n, 1); }),
            4);
}

TEST(ProgramLaws, RunReverse) {
  const HoldAverages hold = averages(5, -0.4, 0.4, 0.1);
  const double correlation = 1 - 2 * 0.5 * 0.1;  // gamma epsilon is the chance of a reversal
  EXPECT_LT(largestZ(simulatedMsd(shipped("run_reverse"), 200),
                     [&](int n) { return exactMsd(hold, n, correlation); }),
            4);
}

TEST(ProgramLaws, BrownianParticle) {
  // Forward speed and rate are functions of two independent uniform wheel speeds.
  constexpr int kSteps = 400;
  HoldAverages hold;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double left = -7 + 14 * (i + 0.5) / kSteps;
      const double right = -7 + 14 * (j + 0.5) / kSteps;
      const double rate = (right - left) / kWheelBase;
      const Complex d = arc((left + right) / 2, rate, 0.2);
      const Complex rotation = std::polar(1.0, rate * 0.2);
      hold.displacement += d;
      hold.turned += std::conj(d) * rotation;
      hold.rotation += rotation;
      hold.square += std::norm(d);
    }
  }
  const double all = kSteps * kSteps;
  hold.displacement /= all;
  hold.turned /= all;
  hold.rotation /= all;
  hold.square /= all;
  EXPECT_LT(largestZ(simulatedMsd(shipped("bp"), 100), [&](int n) { return exactMsd(hold, n, 1); }),
            4);
}

TEST(ProgramLaws, RunAndTumbleParticleLosesItsDirection) {
  // A tumble to any direction: <|r|^2> after n runs is n <l^2>, and l is exponential.
  const Msd msd = simulatedMsd(shipped("rtp"), 80);
  double largest = 0;
  for (std::size_t i = 0; i < msd.mean.size(); ++i) {
    const double runs = static_cast<double>(i / 2 + 1);
    const double exact = runs * 2 * (5 / 3.0) * (5 / 3.0);
    largest = std::max(largest, std::abs(msd.mean[i] - exact) / msd.error[i]);
  }
  EXPECT_LT(largest, 4);
}

}  // namespace
}  // namespace lab::program_laws_test
