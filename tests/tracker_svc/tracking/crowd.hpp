/// Simulated detections and wheel reports of robots in the simulated arena: detections with noise
/// and misses, reports with delay, loss and errors.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

#include "common/math/random.hpp"
#include "sim_svc/world.hpp"
#include "tests/support/world_fixture.hpp"
#include "tracker_svc/tracking/cap_tracker.hpp"

namespace lab::tracker {

inline constexpr double kTestPi = std::numbers::pi;

struct CrowdSettings {
  int robots = 20;
  std::uint64_t seed = 1;
  double fps = 30;
  double frame_loss = 0;      ///< share of pictures that never arrive
  double dropout = 0;         ///< share of caps missed in a picture
  double place_noise = 2e-5;  ///< [m]
  double turn_noise = 5e-4;   ///< [rad]
  double flip = 0;            ///< share of detections with reversed heading
  double report_rate = 30;    ///< [1/s]
  double report_loss = 0;
  double report_delay = 0.05;   ///< [s] least
  double report_jitter = 0.05;  ///< [s] added, uniform
  double report_error = 0.01;   ///< [s] standard error of the reports' times
  bool reports = true;
  sim::WorldSettings world;
};

class Crowd {
 public:
  Crowd(const CrowdSettings& settings, const dynamics::CoreSettings& core)
      : Crowd(settings, core, placesOf(settings)) {}

  Crowd(const CrowdSettings& settings, const dynamics::CoreSettings& core,
        const std::vector<sim::RobotSetup>& places)
      : settings_(settings),
        world_(worldOf(settings), places),
        random_(deriveSeed(settings.seed, 0, "crowd")) {
    sim::addPrograms(world_);
    for (std::size_t i = 0; i < world_.size(); ++i) {
      world_.setReversesFromRobots(i, false);
      world_.order(i, [&](auto& it, auto now_ms) {
        it.configure(now_ms, core);
        it.renewLease(now_ms, dynamics::RobotCore::kNoEventMs);
      });
      who_.push_back(i);
    }
  }

  /// Advances to the next picture, and passes the reports to the tracker.
  void advance(CapTracker& tracker) {
    ++frame_;
    time_ = static_cast<double>(frame_) / settings_.fps;
    while (next_report_ <= time_) {
      world_.advanceTo(std::llround(next_report_ * 1e6));
      report();
      next_report_ += 1 / settings_.report_rate;
    }
    world_.advanceTo(std::llround(time_ * 1e6));
    std::vector<WheelReport> arrived;
    const auto late = std::partition(mail_.begin(), mail_.end(),
                                     [&](const Mail& mail) { return mail.arrival > time_; });
    for (auto mail = late; mail != mail_.end(); ++mail) arrived.push_back(mail->report);
    mail_.erase(late, mail_.end());
    tracker.addReports(arrived);
  }

  [[nodiscard]] bool isLost() { return random_.uniform() < settings_.frame_loss; }

  /// Detections of the current picture; `noise` multiplies the noise.
  [[nodiscard]] std::vector<detector::Detection> detections(double noise = 1) {
    std::vector<detector::Detection> result;
    for (std::size_t i = 0; i < world_.size(); ++i) {
      if (hidden.contains(i) || random_.uniform() < settings_.dropout) continue;
      const dynamics::Pose pose = truth(i);
      const double place = settings_.place_noise * noise;
      const double turn = settings_.turn_noise * noise;
      detector::Detection detection;
      detection.x = pose.x + place * random_.normal();
      detection.y = pose.y + place * random_.normal();
      detection.theta = pose.theta + turn * random_.normal();
      if (random_.uniform() < settings_.flip) {
        detection.theta += kTestPi;
        ++flipped;
      }
      detection.theta = std::remainder(detection.theta, 2 * kTestPi);
      detection.covariance = {place * place, 0, 0, place * place, 0, turn * turn};
      detection.quality = 1;
      detection.used = detector::kUsedBig | detector::kUsedSmall;
      result.push_back(detection);
    }
    // Shuffled, so that the order carries no information.
    for (std::size_t i = result.size(); i > 1; --i) {
      std::swap(result[i - 1], result[random_.next() % i]);
    }
    return result;
  }

  /// The robot at the track's pose, -1 if none.
  [[nodiscard]] int robotAt(const detector::Detection& pose) const {
    for (std::size_t i = 0; i < world_.size(); ++i) {
      const dynamics::Pose at = truth(i);
      if (std::hypot(at.x - pose.x, at.y - pose.y) < 0.02) return world_.id(i);
    }
    return -1;
  }

  /// The pose of robot i. After exchange() it is in the body of another one.
  [[nodiscard]] dynamics::Pose truth(std::size_t i) const { return world_.pose(who_[i]); }

  /// Exchanges two robots: each continues with its own wheels from the other's place. Implemented
  /// by exchanging names: reports use names, and the bodies are identical.
  /// bodies stay and their names change: reports go by name, and the two have the same hardware.
  void exchange(std::size_t i, std::size_t j) { std::swap(who_[i], who_[j]); }

  void order(std::size_t i, double left, double right) {
    const Program program = sim::wheelsProgram(left, right);
    world_.addProgram(program.hash, program.code);
    world_.order(i, [&](auto& core, auto now_ms) {
      core.configure(now_ms, sim::always(program));
      core.renewLease(now_ms, dynamics::RobotCore::kNoEventMs);
    });
  }

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] std::size_t size() const { return world_.size(); }
  [[nodiscard]] std::int32_t id(std::size_t i) const { return world_.id(i); }
  [[nodiscard]] const sim::World& world() const { return world_; }
  [[nodiscard]] std::vector<std::int32_t> ids() const {
    std::vector<std::int32_t> result;
    for (std::size_t i = 0; i < world_.size(); ++i) result.push_back(world_.id(i));
    return result;
  }

  std::set<std::size_t> hidden;  ///< robots that the camera does not see
  std::set<std::size_t> silent;  ///< robots whose reports are lost
  std::int64_t flipped = 0;

 private:
  struct Mail {
    double arrival = 0;
    WheelReport report;
  };

  static std::vector<sim::RobotSetup> placesOf(const CrowdSettings& settings) {
    std::vector<sim::RobotSetup> places;
    for (int id = 1; id <= settings.robots; ++id) places.push_back({id, std::nullopt, false});
    return places;
  }

  static sim::WorldSettings worldOf(const CrowdSettings& settings) {
    sim::WorldSettings world = settings.world;
    world.seed = settings.seed;
    world.boot_spread = 0;
    return world;
  }

  void report() {
    if (!settings_.reports) return;
    for (std::size_t i = 0; i < world_.size(); ++i) {
      const double error = settings_.report_error * random_.normal();
      const double delay = settings_.report_delay + settings_.report_jitter * random_.uniform();
      if (random_.uniform() < settings_.report_loss || silent.contains(i)) continue;
      const sim::RobotState state = world_.state(who_[i]);
      WheelReport report;
      report.robot_id = world_.id(i);
      report.time = next_report_ + error;
      report.left = state.wheel_left;
      report.right = state.wheel_right;
      mail_.push_back({next_report_ + delay, report});
    }
  }

  CrowdSettings settings_;
  sim::World world_;
  Random random_;
  std::vector<std::size_t> who_;
  std::vector<Mail> mail_;
  std::int64_t frame_ = 0;
  double time_ = 0;
  double next_report_ = 0;
};

/// Compares the tracker's result with the truth.
struct Score {
  std::int64_t poses = 0;    ///< detected and published as a robot
  std::int64_t unnamed = 0;  ///< detected and published as unbound
  std::int64_t swapped = 0;  ///< published as the wrong robot
  std::int64_t flipped = 0;  ///< heading wrong by more than 90 degrees
  std::int64_t twice = 0;    ///< one id on two tracks

  void add(const Crowd& crowd, const std::vector<Track>& tracks) {
    std::set<std::int32_t> named;
    for (const Track& track : tracks) {
      if (track.robot_id >= 0 && !named.insert(track.robot_id).second) ++twice;
      if (!track.detected) continue;
      const int robot = crowd.robotAt(track.pose);
      if (track.robot_id < 0) {
        ++unnamed;
      } else {
        ++poses;
        if (robot != track.robot_id) ++swapped;
      }
      for (std::size_t i = 0; i < crowd.size(); ++i) {
        if (crowd.id(i) != robot) continue;
        const double off = std::remainder(crowd.truth(i).theta - track.pose.theta, 2 * kTestPi);
        if (std::abs(off) > kTestPi / 2) ++flipped;
      }
    }
  }
};

/// Binds every robot at its pose, as a start from known poses does.
inline void bindAll(const Crowd& crowd, CapTracker& tracker) {
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    tracker.bind(crowd.id(i), crowd.truth(i).x, crowd.truth(i).y, 0.02);
  }
}

}  // namespace lab::tracker
