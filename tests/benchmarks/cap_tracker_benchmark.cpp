// Cost of identities per picture: 20 and 50 robots, all bound (the usual case), all unbound (a
// start), and after two dark seconds, when every robot may be anywhere. Baseline of the same run:
// the nearest neighbour of every cap by brute force.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "common/math/random.hpp"
#include "robot/dynamics/kinematics.hpp"
#include "tracker_svc/tracking/cap_tracker.hpp"

namespace {

using lab::detector::Detection;
using lab::tracker::CapTracker;
using lab::tracker::WheelReport;

constexpr double kFps = 30;

/// Robots on a grid that turn and drive near their places, with new speeds every 0.5 s.
class Scene {
 public:
  explicit Scene(int robots) : random_(1) {
    for (int i = 0; i < robots; ++i) {
      poses_.push_back({0.1 + 0.13 * (i % 8), 0.08 + 0.12 * (i / 8), 0.1 * i});
      ids_.push_back(i + 1);
    }
    speeds_.resize(poses_.size());
  }

  void advance() {
    detections_.clear();
    reports_.clear();
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (frame_ % 15 == 0) {
        const double way = frame_ / 15 % 2 == 0 ? 0.02 : -0.02;
        const double turn = 0.1 * random_.uniform() - 0.05;
        speeds_[i] = {0, way - turn, way + turn};
      }
      const WheelReport& speed = speeds_[i];
      poses_[i] = lab::dynamics::apply(
          lab::dynamics::makeArc(speed.left, speed.right, 0.075, 1 / kFps), poses_[i]);
      Detection detection;
      detection.x = poses_[i].x;
      detection.y = poses_[i].y;
      detection.theta = std::remainder(poses_[i].theta, 2 * std::numbers::pi);
      detection.covariance = {4e-10, 0, 0, 4e-10, 0, 2.5e-7};
      detection.quality = 1;
      detections_.push_back(detection);
      reports_.push_back({ids_[i], time(), speed.left, speed.right});
    }
    ++frame_;
  }

  [[nodiscard]] double time() const { return frame_ / kFps; }
  [[nodiscard]] const std::vector<int>& ids() const { return ids_; }
  [[nodiscard]] const std::vector<Detection>& detections() const { return detections_; }
  [[nodiscard]] const std::vector<WheelReport>& reports() const { return reports_; }

 private:
  lab::Random random_;
  int frame_ = 0;
  std::vector<lab::dynamics::Pose> poses_;
  std::vector<WheelReport> speeds_;
  std::vector<int> ids_;
  std::vector<Detection> detections_;
  std::vector<WheelReport> reports_;
};

void nearestNeighbour(benchmark::State& state) {
  Scene scene(static_cast<int>(state.range(0)));
  scene.advance();
  std::vector<Detection> before = scene.detections();
  for (auto _ : state) {
    state.PauseTiming();
    scene.advance();
    state.ResumeTiming();
    for (const Detection& one : scene.detections()) {
      double least = 1;
      for (const Detection& other : before) {
        const double dx = one.x - other.x;
        const double dy = one.y - other.y;
        least = std::min(least, dx * dx + dy * dy);
      }
      benchmark::DoNotOptimize(least);
    }
    before = scene.detections();
  }
}
BENCHMARK(nearestNeighbour)->Arg(20)->Arg(50)->Unit(benchmark::kMicrosecond);

void run(benchmark::State& state, bool bound) {
  Scene scene(static_cast<int>(state.range(0)));
  CapTracker tracker({}, scene.ids());
  scene.advance();
  tracker.update(scene.time(), scene.detections());
  for (std::size_t i = 0; bound && i < scene.ids().size(); ++i) {
    tracker.bind(scene.ids()[i], scene.detections()[i].x, scene.detections()[i].y, 0.01);
  }
  for (auto _ : state) {
    state.PauseTiming();
    scene.advance();
    state.ResumeTiming();
    if (bound) tracker.addReports(scene.reports());
    benchmark::DoNotOptimize(tracker.expect(scene.time()).data());
    benchmark::DoNotOptimize(tracker.update(scene.time(), scene.detections()).data());
  }
  state.counters["unbound"] = static_cast<double>(tracker.counts().unbound);
}

// With a report for every picture; includes expect().
void allBound(benchmark::State& state) { run(state, true); }
BENCHMARK(allBound)->Arg(20)->Arg(50)->Unit(benchmark::kMicrosecond);

// Without reports, as for `lab track`.
void withoutRobots(benchmark::State& state) { run(state, false); }
BENCHMARK(withoutRobots)->Arg(20)->Arg(50)->Unit(benchmark::kMicrosecond);

void afterTwoDarkSeconds(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    Scene scene(static_cast<int>(state.range(0)));
    CapTracker tracker({}, scene.ids());
    for (int frame = 0; frame < 90; ++frame) {
      scene.advance();
      tracker.addReports(scene.reports());
      if (frame < 30) tracker.update(scene.time(), scene.detections());
    }
    state.ResumeTiming();
    benchmark::DoNotOptimize(tracker.update(scene.time(), scene.detections()).data());
  }
}
BENCHMARK(afterTwoDarkSeconds)->Arg(20)->Arg(50)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
