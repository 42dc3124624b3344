#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>

#include "analyzer/laws.hpp"
#include "analyzer/tracks/track_stitcher.hpp"

namespace lab::analysis {

/// A recording of one robot, for tests. Hold times are not multiples of the frame period, so the
/// observation phase sweeps as with real clocks.
struct WalkerRecording {
  ProgramLaw law;
  double duration = 600;  ///< s.
  double fps = 49.7;
  double telemetry_rate = 50;  ///< 1/s.
  double sigma = 0;            ///< Tracker noise per axis, m.
  double sigma_theta = 0;      ///< rad.
  double missing = 0;          ///< Share of lost frames.
  double missing_length = 1;   ///< Mean number of consecutive lost frames.
  double cut_every = 0;        ///< Mean time between cuts (as by contacts), s; 0: none.
  bool walls = false;          ///< 0.9 m x 1.2 m with reversals; otherwise an infinite plane.
  std::uint64_t seed = 1;
};

/// An independent implementation of the programs: exact arcs, draws held exactly, and walls from
/// which it reverses 40 cm (or to the opposite wall) at 10 cm/s and then resumes exactly.
class Walker {
 public:
  explicit Walker(const WalkerRecording& recording)
      : recording_(recording), parameters_(recording.law), random_(recording.seed) {}

  std::function<void(const TrackPoint&)> on_frame;
  std::function<void(const RobotTelemetry&)> on_telemetry;

  void run() {
    x_ = recording_.walls ? uniform(0.3, 0.9) : 0;
    y_ = recording_.walls ? uniform(0.3, 0.6) : 0;
    theta_ = uniform(-std::numbers::pi, std::numbers::pi);
    begin();
    double next_frame = uniform(0, 1 / recording_.fps);
    double next_telemetry = uniform(0, 1 / recording_.telemetry_rate);
    double next_look = 0;
    while (time_ < recording_.duration) {
      const double event = reversing_ ? time_ + reversal_left_ : time_ + hold_left_;
      const double stop = std::min({event, next_frame, next_telemetry, next_look});
      advance(stop - time_);
      time_ = stop;
      if (stop == event) {
        reversing_ ? endReversal() : draw();
      } else if (stop == next_frame) {
        frame();
        next_frame += 1 / recording_.fps;
      } else if (stop == next_telemetry) {
        report();
        next_telemetry += 1 / recording_.telemetry_rate;
      } else {
        look();
        next_look = recording_.walls ? time_ + 0.01 : recording_.duration + 1;
      }
    }
  }

 private:
  /// Of the program.
  struct Parameters {
    explicit Parameters(const ProgramLaw& law)
        : runs(law->name() == "rtp"),
          wheels(law->name() == "bp" || law->name() == "noisy_abp"),
          v(law->parameter("v")),
          va(law->name() == "bp" ? 0 : law->parameter("va")),
          V(law->parameter("V")),
          epsilon(law->parameter("epsilon")),
          eta(law->parameter("eta")),
          gamma(law->parameter("gamma")),
          tau_t(law->parameter("tau_t")),
          wheel_base(law->wheelBase()) {}

    bool runs, wheels;
    double v, va, V, epsilon, eta, gamma, tau_t, wheel_base;
  };

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  /// Begins in the stationary state: at a random time within a hold, a run or a tumble.
  void begin() {
    const Parameters& p = parameters_;
    if (p.runs) {
      tumbling_ = uniform(0, 1) > p.gamma * p.tau_t / (1 + p.gamma * p.tau_t);
      draw();
      tumble_count_ = 0;
      hold_left_ = tumbling_ ? uniform(0, p.tau_t) : hold_left_;
    } else {
      draw();
      hold_left_ = uniform(0, p.epsilon);
    }
  }

  void draw() {
    const Parameters& p = parameters_;
    if (p.runs) {
      tumbling_ = !tumbling_;
      speed_ = tumbling_ ? 0 : p.v;
      turning_ = tumbling_ ? uniform(-std::numbers::pi, std::numbers::pi) / p.tau_t : 0;
      hold_left_ = tumbling_ ? p.tau_t : std::exponential_distribution<double>(p.gamma)(random_);
      tumble_count_ += tumbling_ ? 1 : 0;
      return;
    }
    hold_left_ = p.epsilon;
    if (!p.wheels) {
      speed_ = p.v;
      turning_ = uniform(-p.eta, p.eta);
    } else {
      const double left = uniform(p.va - p.V, p.va + p.V);
      const double right = uniform(p.va - p.V, p.va + p.V);
      speed_ = 0.5 * (left + right);
      turning_ = (right - left) / p.wheel_base;
    }
  }

  void advance(double dt) {
    if (reversing_) {
      x_ += reversal_speed_ * std::cos(theta_) * dt;
      y_ += reversal_speed_ * std::sin(theta_) * dt;
      reversal_left_ -= dt;
      return;
    }
    const double half = 0.5 * turning_ * dt;
    const double chord = speed_ * dt * (std::abs(half) < 1e-6 ? 1 : std::sin(half) / half);
    x_ += chord * std::cos(theta_ + half);
    y_ += chord * std::sin(theta_ + half);
    theta_ += 2 * half;
    hold_left_ -= dt;
    free_ += dt;
    run_time_ += speed_ != 0 ? dt : 0;
  }

  [[nodiscard]] bool facesWall(double speed) const {
    const double vx = speed * std::cos(theta_);
    const double vy = speed * std::sin(theta_);
    return (x_ < kMargin && vx < 0) || (x_ > 1.2 - kMargin && vx > 0) || (y_ < kMargin && vy < 0) ||
           (y_ > 0.9 - kMargin && vy > 0);
  }

  void look() {
    if (!recording_.walls) {
      return;
    }
    if (reversing_) {
      if (facesWall(reversal_speed_)) {
        endReversal();
      }
    } else if (facesWall(speed_) && free_ > resumed_ + 0.1) {
      reversing_ = true;
      ++reversal_count_;
      reversal_start_ = time_;
      reversal_speed_ = speed_ > 0 ? -0.1 : 0.1;
      reversal_left_ = 4;
    }
  }

  void endReversal() {
    reversing_ = false;
    reversal_end_ = time_;
    resumed_ = free_;
  }

  void frame() {
    std::normal_distribution<double> normal;
    TrackPoint point;
    point.time = time_;
    point.frame = ++frames_;
    point.x = x_ + recording_.sigma * normal(random_);
    point.y = y_ + recording_.sigma * normal(random_);
    point.theta =
        std::remainder(theta_ + recording_.sigma_theta * normal(random_), 2 * std::numbers::pi);
    point.sigma = recording_.sigma;
    point.sigma_theta = recording_.sigma_theta;
    on_frame(point);
  }

  void report() {
    RobotTelemetry t;
    t.time = time_;
    t.program = 0;
    t.program_epoch = 1;
    t.reversal_count = reversal_count_;
    t.reversal_start = reversal_start_;
    t.reversal_end = reversal_end_;
    t.reversing = reversing_;
    t.v_l = speed_ - 0.5 * turning_ * parameters_.wheel_base;
    t.v_r = speed_ + 0.5 * turning_ * parameters_.wheel_base;
    t.tumble_count = tumble_count_;
    t.run_time = run_time_;
    on_telemetry(t);
  }

  static constexpr double kMargin = 0.0875;  // m: radius of the robot plus 5 cm

  WalkerRecording recording_;
  Parameters parameters_;
  std::mt19937_64 random_;
  double time_ = 0;
  double x_ = 0;
  double y_ = 0;
  double theta_ = 0;
  double speed_ = 0;
  double turning_ = 0;
  double hold_left_ = 0;
  bool tumbling_ = false;
  double free_ = 0;
  double resumed_ = -1;
  double run_time_ = 0;
  bool reversing_ = false;
  double reversal_speed_ = 0;
  double reversal_left_ = 0;
  double reversal_start_ = 0;
  double reversal_end_ = 0;
  std::int64_t reversal_count_ = 0;
  std::int64_t tumble_count_ = 0;
  std::int64_t frames_ = 0;
};

}  // namespace lab::analysis
