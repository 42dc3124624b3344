#include "analyzer/bootstrap/simulated_recording.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

namespace lab::analysis {
namespace {

constexpr double kPi = std::numbers::pi;

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
  FreeWalk(std::unique_ptr<Motion> motion, double usual_step, Random& random)
      : motion_(std::move(motion)), random_(random), usual_step_(usual_step) {
    theta_ = random_.uniform(-kPi, kPi);
    cos_ = std::cos(theta_);
    sin_ = std::sin(theta_);
    drive(motion_->first(random_));
  }

  void advance(double dt) {
    while (dt > left_) {
      take(stepOf(speed_, turning_, left_));
      dt -= left_;
      drive(motion_->next(random_));
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
  void drive(const Arc& arc) {
    cached_ = false;
    speed_ = arc.speed;
    turning_ = arc.turning;
    left_ = arc.duration;
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

  std::unique_ptr<Motion> motion_;
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
  bool cached_ = false;
  Step usual_;
};

}  // namespace

void simulateRecording(const RecordingPlan& plan, std::uint64_t seed, RecordingPoses& poses) {
  std::unique_ptr<Motion> motion = plan.law->motion();
  if (motion == nullptr || (!plan.law->isSimulated() && !ExactLaw(plan.law).exists())) {
    throw std::invalid_argument(
        "simulateRecording: the program has no law; give one with a law and positive times");
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
  FreeWalk walk(std::move(motion), plan.period - apart, random);
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
