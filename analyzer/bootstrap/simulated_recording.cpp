#include "analyzer/bootstrap/simulated_recording.hpp"

#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace lab::analysis {
namespace {

constexpr double kPi = std::numbers::pi;

/// 128 layers of equal area under exp(-x^2/2).
struct Ziggurat {
  static constexpr double kTail = 3.442619855899;
  std::array<double, 129> edge{};    ///< Right edges, widest (the base's virtual one) first.
  std::array<double, 129> height{};  ///< exp(-x^2/2) at them.

  Ziggurat() {
    constexpr double kArea = 9.91256303526217e-3;
    const auto density = [](double x) { return std::exp(-0.5 * x * x); };
    edge[0] = kArea / density(kTail);
    edge[1] = kTail;
    for (std::size_t i = 2; i < 128; ++i) {
      edge[i] = std::sqrt(-2 * std::log(kArea / edge[i - 1] + density(edge[i - 1])));
    }
    edge[128] = 0;
    for (std::size_t i = 0; i < 129; ++i) height[i] = density(edge[i]);
  }
};

const Ziggurat kZiggurat;

/// Sine and cosine of half a turn. The series for small angles is twice as fast as the library.
struct Turn {
  double sin = 0;
  double cos = 1;
};

Turn turnBy(double a) {
  const double a2 = a * a;
  if (a2 > 0.16) return {std::sin(a), std::cos(a)};
  return {a * (1 - a2 / 6 * (1 - a2 / 20 * (1 - a2 / 42 * (1 - a2 / 72 * (1 - a2 / 110))))),
          1 - a2 / 2 * (1 - a2 / 12 * (1 - a2 / 30 * (1 - a2 / 56 * (1 - a2 / 90))))};
}

/// A step along an arc, by half of the rotation and the chord.
struct Step {
  Turn half;
  double chord = 0;
  double angle = 0;
};

Step stepOf(double speed, double turning, double dt) {
  const double a = 0.5 * turning * dt;
  Step step{turnBy(a), speed * dt, 2 * a};
  if (std::abs(a) > 1e-9) step.chord *= step.half.sin / a;
  return step;
}

/// A robot on an infinite plane, in the stationary state from the start.
class FreeWalk {
 public:
  FreeWalk(const ProgramLaw& law, double usual_step, Random& random)
      : law_(law), random_(random), usual_step_(usual_step) {
    theta_ = random_.uniform(-kPi, kPi);
    cos_ = std::cos(theta_);
    sin_ = std::sin(theta_);
    if (law.kind == ProgramKind::kRtp) {
      // draw() toggles between run and tumble. The rest of a run is distributed like a run; that of
      // a tumble is not.
      running_ = random_.uniform() * (1 + law.gamma * law.tau_t) < law.gamma * law.tau_t;
      draw();
      if (!running_) left_ = random_.uniform(0, law.tau_t);
    } else {
      draw();
      left_ = random_.uniform(0, law.epsilon);
    }
  }

  void advance(double dt) {
    while (dt > left_) {
      take(stepOf(speed_, turning_, left_));
      dt -= left_;
      draw();
    }
    left_ -= dt;
    if (dt == usual_step_) {
      if (!cached_) {
        usual_ = stepOf(speed_, turning_, dt);
        cached_ = true;
      }
      take(usual_);
    } else {
      take(stepOf(speed_, turning_, dt));
    }
  }

  [[nodiscard]] double x() const { return x_; }
  [[nodiscard]] double y() const { return y_; }
  [[nodiscard]] double theta() const { return theta_; }

 private:
  void draw() {
    cached_ = false;
    switch (law_.kind) {
      case ProgramKind::kAbp:
        left_ = law_.epsilon;
        speed_ = law_.v;
        turning_ = random_.uniform(-law_.eta, law_.eta);
        return;
      case ProgramKind::kNoisyAbp:
      case ProgramKind::kBp: {
        const double va = law_.kind == ProgramKind::kBp ? 0 : law_.va;
        const double left = random_.uniform(va - law_.V, va + law_.V);
        const double right = random_.uniform(va - law_.V, va + law_.V);
        left_ = law_.epsilon;
        speed_ = 0.5 * (left + right);
        turning_ = (right - left) / law_.wheel_base;
        return;
      }
      default:
        running_ = !running_;
        speed_ = running_ ? law_.v : 0;
        turning_ = running_ ? 0 : random_.uniform(-kPi, kPi) / law_.tau_t;
        left_ = running_ ? random_.exponential(law_.gamma) : law_.tau_t;
    }
  }

  void take(const Step& step) {
    const double middle_cos = cos_ * step.half.cos - sin_ * step.half.sin;
    const double middle_sin = sin_ * step.half.cos + cos_ * step.half.sin;
    x_ += step.chord * middle_cos;
    y_ += step.chord * middle_sin;
    theta_ += step.angle;
    cos_ = middle_cos * step.half.cos - middle_sin * step.half.sin;
    sin_ = middle_sin * step.half.cos + middle_cos * step.half.sin;
  }

  const ProgramLaw& law_;
  Random& random_;
  double usual_step_;
  double x_ = 0;
  double y_ = 0;
  double theta_ = 0;
  double cos_ = 1;
  double sin_ = 0;
  double speed_ = 0;
  double turning_ = 0;
  double left_ = 0;
  bool running_ = false;
  bool cached_ = false;
  Step usual_;
};

}  // namespace

Random::Random(std::uint64_t seed) {
  for (std::uint64_t& word : state_) {
    seed += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = seed;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    word = z ^ (z >> 31);
  }
}

std::uint64_t Random::next() {
  const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t shifted = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::exponential(double rate) { return -std::log1p(-uniform()) / rate; }

double Random::normal() {
  for (;;) {
    const std::uint64_t bits = next();
    const std::size_t layer = bits & 127;
    const double u = static_cast<double>(static_cast<std::int64_t>(bits) >> 10) * 0x1.0p-53;
    const double x = u * kZiggurat.edge[layer];
    if (std::abs(x) < kZiggurat.edge[layer + 1]) return x;
    if (layer == 0) {  // the tail, after Marsaglia
      double beyond = 0;
      double height = 0;
      do {
        beyond = exponential(Ziggurat::kTail);
        height = exponential(1);
      } while (2 * height < beyond * beyond);
      return u < 0 ? -Ziggurat::kTail - beyond : Ziggurat::kTail + beyond;
    }
    const double low = kZiggurat.height[layer];
    const double high = kZiggurat.height[layer + 1];
    if (low + uniform() * (high - low) < std::exp(-0.5 * x * x)) return x;
  }
}

void simulateRecording(const RecordingPlan& plan, std::uint64_t seed, RecordingPoses& poses) {
  if (!ExactLaw(plan.law).exists()) {
    throw std::invalid_argument(
        "simulateRecording: the program has no law; give an ABP, a noisy ABP, a "
        "BP or an RTP with positive times");
  }
  if (!(plan.duration > 0) || !(plan.period > 0) || plan.exposure < 0 ||
      plan.exposure > plan.period) {
    throw std::invalid_argument(
        "simulateRecording: duration and period must be positive, the exposure "
        "between 0 and the period");
  }
  const auto frames = static_cast<std::size_t>(plan.duration / plan.period) + 1;
  poses.x.resize(frames);
  poses.y.resize(frames);
  poses.theta.resize(frames);
  Random random(seed);
  const double apart = plan.exposure / std::sqrt(3.0);  // of the two points of the Gauss rule
  FreeWalk walk(plan.law, plan.period - apart, random);
  for (std::size_t i = 0; i < frames; ++i) {
    if (i > 0) walk.advance(plan.period - apart);
    poses.x[i] = walk.x();
    poses.y[i] = walk.y();
    poses.theta[i] = walk.theta();
    if (apart > 0) {
      walk.advance(apart);
      poses.x[i] = 0.5 * (poses.x[i] + walk.x());
      poses.y[i] = 0.5 * (poses.y[i] + walk.y());
      poses.theta[i] = 0.5 * (poses.theta[i] + walk.theta());
    }
    if (plan.sigma > 0) {
      poses.x[i] += plan.sigma * random.normal();
      poses.y[i] += plan.sigma * random.normal();
    }
    if (plan.sigma_theta > 0) poses.theta[i] += plan.sigma_theta * random.normal();
  }
}

}  // namespace lab::analysis
