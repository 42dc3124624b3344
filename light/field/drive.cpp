#include "light/field/drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robot/dynamics/rng.hpp"
#include "robot/language/number_text.hpp"

namespace lab::light {

namespace {

using Problem = std::optional<std::string>;

constexpr double kTurn = 2 * std::numbers::pi;

// The telegraph signal is divided into blocks of ten periods. Over a block it changes 20 times on
// average, so that its values at both ends are independent to exp(-40): the values at the ends are
// independent random bits, and the block is a path conditioned on its two ends. The cost is
// therefore the same for any time.
constexpr double kBlockPeriods = 10;
constexpr double kChangesPerPeriod = 2;

/// Random bit at the start of a block.
bool brightAt(std::uint64_t seed, std::int64_t block) {
  if (block == 0) return true;
  std::uint64_t state = seed;
  state = dynamics::splitMix64(state) ^ static_cast<std::uint64_t>(block);
  return (dynamics::splitMix64(state) >> 63U) != 0;
}

/// Rejection sampling: paths from the block's start are drawn until one ends with the next block's
/// start value. Every second one does.
bool telegraph(std::uint64_t seed, double periods) {
  const double block = std::floor(periods / kBlockPeriods);
  const double wanted = periods - block * kBlockPeriods;
  const auto number = static_cast<std::int64_t>(block);
  const bool first = brightAt(seed, number);
  const bool last = brightAt(seed, number + 1);
  std::uint64_t state = ~seed;
  state = dynamics::splitMix64(state) ^ static_cast<std::uint64_t>(number);
  for (;;) {
    bool bright = first;
    bool at_wanted = first;
    double now = 0;
    for (;;) {
      const double uniform =
          (static_cast<double>(dynamics::splitMix64(state) >> 12U) + 0.5) * 0x1.0p-52;
      now -= std::log(uniform) / kChangesPerPeriod;
      if (now >= kBlockPeriods) break;
      bright = !bright;
      if (now <= wanted) at_wanted = bright;
    }
    if (bright == last) return at_wanted;
  }
}

constexpr int kDriveDigits = 6;

/// Empty if low <= value <= high; NaN is outside every range.
Problem outside(const char* field, double value, double low, double high, const char* unit = "") {
  if (value >= low && value <= high) return {};
  const int digits = language::digitsBeside({low, high}, value, kDriveDigits);
  const auto text = [&](double number) { return language::numberText(number, digits); };
  const std::string allowed = low < high ? text(low) + " to " + text(high) : "0";
  return std::string(field) + " = " + text(value) + unit + ", allowed: " + allowed + unit;
}

Problem outsideChoices(const char* field, int value, int most) {
  if (value >= 0 && value <= most) return {};
  return std::string(field) + " = " + std::to_string(value) + ", allowed: 0 to " +
         std::to_string(most);
}

bool hasPlace(LayerKind kind) { return kind != LayerKind::kUniform && kind != LayerKind::kFade; }

Problem motionProblem(const Drive& drive, LayerKind kind) {
  const double speed = hasPlace(kind) ? kLargestSpeed : 0;
  const double spin = hasPlace(kind) ? kLargestRate : 0;
  const bool has_phase = kind == LayerKind::kWave || kind == LayerKind::kNoise;
  const double phase_rate = has_phase ? kLargestRate : 0;
  Problem problem = outside("vx", drive.vx, -speed, speed, " m/s");
  if (!problem) problem = outside("vy", drive.vy, -speed, speed, " m/s");
  if (!problem) problem = outside("spin", drive.spin, -spin, spin, " rad/s");
  if (!problem) problem = outside("phase_rate", drive.phase_rate, -phase_rate, phase_rate);
  return problem;
}

Problem waveformProblem(const Drive& drive) {
  Problem problem = outsideChoices("waveform", static_cast<int>(drive.waveform),
                                   static_cast<int>(Waveform::kTelegraph));
  if (!problem) problem = outside("period", drive.period, kShortestPeriod, kLongestTime, " s");
  if (!problem) problem = outside("low", drive.low, 0, 1);
  if (!problem) problem = outside("start", drive.start, 0, 1);
  return problem;
}

Problem sequenceProblem(const Drive& drive, LayerKind kind) {
  if (!drive.images.empty() && kind != LayerKind::kImage) {
    return "images = " + std::to_string(drive.images.size()) +
           " images, allowed: none where the layer is no image";
  }
  if (drive.images.size() > kMostImages) {
    return "images = " + std::to_string(drive.images.size()) + " images, allowed: at most " +
           std::to_string(kMostImages);
  }
  return outside("image_rate", drive.image_rate, 1 / kLongestTime, kLargestRate, " 1/s");
}

Problem followProblem(const Drive& drive, LayerKind kind) {
  Problem problem =
      outsideChoices("follow", static_cast<int>(drive.follow), static_cast<int>(Follow::kTrail));
  if (!problem && drive.follow != Follow::kNothing && !hasPlace(kind)) {
    problem = "follow = " + std::to_string(static_cast<int>(drive.follow)) +
              ", allowed: 0 where the layer has no place";
  }
  if (!problem && drive.follow == Follow::kTrail && kind != LayerKind::kDisk) {
    problem = "follow = 2, allowed: 0 or 1 where the layer is no disk";
  }
  if (!problem && drive.robots.size() > kMostFollowed) {
    problem = "robots = " + std::to_string(drive.robots.size()) + " robots, allowed: at most " +
              std::to_string(kMostFollowed);
  }
  for (const std::int32_t id : drive.robots) {
    if (!problem) problem = outside("robots", id, 1, kLargestRobot);
  }
  if (!problem) problem = outside("stale", drive.stale, 0.001, kLongestTime, " s");
  if (!problem) {
    problem = outsideChoices("when_lost", static_cast<int>(drive.when_lost),
                             static_cast<int>(WhenLost::kSafe));
  }
  if (!problem) problem = outside("rate", drive.rate, 0, kLargestRate, " 1/s");
  if (!problem) problem = outside("decay", drive.decay, 0, kLargestRate, " 1/s");
  if (!problem) problem = outside("diffusion", drive.diffusion, 0, kLargestDiffusion, " m^2/s");
  return problem;
}

Problem gateProblem(const Drive& drive) {
  Problem problem =
      outsideChoices("gate", static_cast<int>(drive.gate), static_cast<int>(Gate::kOutside));
  if (!problem) problem = outside("gate_robot", drive.gate_robot, 0, kLargestRobot);
  if (!problem && drive.gate == Gate::kProgram && drive.gate_program.empty()) {
    problem = "gate_program = \"\", allowed: the name of a program";
  }
  if (!problem) problem = outside("gate_x", drive.gate_x, -kLargestPlace, kLargestPlace, " m");
  if (!problem) problem = outside("gate_y", drive.gate_y, -kLargestPlace, kLargestPlace, " m");
  const bool circle = drive.gate == Gate::kInside || drive.gate == Gate::kOutside;
  if (!problem) {
    problem =
        outside("gate_radius", drive.gate_radius, circle ? kSmallestSize : 0, kLargestPlace, " m");
  }
  return problem;
}

const std::string& imageAt(const Drive& drive, double time) {
  const double last = static_cast<double>(drive.images.size()) - 1;
  const double passed = std::floor(std::max(0.0, time * drive.image_rate));
  const double index = drive.image_loop ? std::fmod(passed, last + 1) : std::min(passed, last);
  return drive.images[static_cast<std::size_t>(index)];
}

}  // namespace

double modulation(const Drive& drive, double time) {
  const double periods = drive.start + time / drive.period;
  switch (drive.waveform) {
    case Waveform::kSteady:
      break;
    case Waveform::kSine:
      return 0.5 + 0.5 * std::cos(kTurn * (periods - std::floor(periods)));
    case Waveform::kSquare:
      return periods - std::floor(periods) < 0.5 ? 1 : 0;
    case Waveform::kTelegraph:
      return telegraph(drive.seed, periods) ? 1 : 0;
  }
  return 1;
}

Layer driven(const DrivenLayer& layer, double time) {
  Layer shown = layer.layer;
  const Drive& drive = layer.drive;
  shown.x += drive.vx * time;
  shown.y += drive.vy * time;
  // Full turns are removed, so that validate() accepts the angle.
  if (drive.spin != 0) shown.angle = std::remainder(shown.angle + drive.spin * time, kTurn);
  shown.phase += drive.phase_rate * time;
  shown.intensity = drive.low + modulation(drive, time) * (shown.intensity - drive.low);
  if (!drive.images.empty()) {
    const std::string& image = imageAt(drive, time);
    if (image != shown.image) shown.pixels = nullptr;
    shown.image = image;
  }
  return shown;
}

std::optional<std::string> validate(const Drive& drive, LayerKind kind) {
  if (kind == LayerKind::kFade && !isStill(drive)) {
    return "kind = " + std::to_string(static_cast<int>(kind)) + ", allowed: one that paints";
  }
  Problem problem = motionProblem(drive, kind);
  if (!problem) problem = waveformProblem(drive);
  if (!problem) problem = sequenceProblem(drive, kind);
  if (!problem) problem = followProblem(drive, kind);
  if (!problem) problem = gateProblem(drive);
  return problem;
}

}  // namespace lab::light
