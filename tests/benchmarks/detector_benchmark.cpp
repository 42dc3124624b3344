// Detection in full pictures and of followed caps, compared with reading the same pictures once
// from memory. The pictures are in a ring of 64, so that none is in the processor's caches when it
// is used.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"
#include "tracker_svc/detector.hpp"

namespace {

using lab::detector::Detection;
using lab::detector::Detector;
using lab::detector::Expected;
using lab::optics::GreyView;

constexpr int kRing = 64;
constexpr int kScenes = 4;

struct Film {
  int width = 0;
  int height = 0;
  lab::sim::PainterSettings settings;
  std::vector<std::vector<lab::sim::PaintedRobot>> robots;  // by scene
  std::vector<std::uint8_t> pixels;                         // the ring

  Film(int the_width, int the_height, int count) : width(the_width), height(the_height) {
    settings.camera = lab::optics::simulatedCamera(width, height, 1.20, 0.90);
    lab::sim::CameraPainter painter(settings);
    lab::light::Field field;
    field.layers = {{.kind = lab::light::LayerKind::kUniform, .intensity = 1}};
    painter.setLight(field);
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> x(0.04, 1.16);
    std::uniform_real_distribution<double> y(0.04, 0.86);
    std::uniform_real_distribution<double> theta(-std::numbers::pi, std::numbers::pi);
    const std::size_t size = bytes();
    pixels.resize(size * kRing);
    for (int scene = 0; scene < kScenes; ++scene) {
      std::vector<lab::sim::PaintedRobot> placed;
      while (static_cast<int>(placed.size()) < count) {
        const lab::sim::PaintedRobot robot{x(random), y(random), theta(random), 0, 0, 0};
        bool free = true;
        for (const auto& other : placed) {
          free = free && std::hypot(robot.x - other.x, robot.y - other.y) > 0.0755;
        }
        if (free) placed.push_back(robot);
      }
      painter.paint(placed, scene, {pixels.data() + size * static_cast<std::size_t>(scene), size});
      robots.push_back(placed);
    }
    for (std::size_t i = kScenes; i < kRing; ++i) {
      std::memcpy(pixels.data() + i * size, pixels.data() + i % kScenes * size, size);
    }
  }

  [[nodiscard]] std::size_t bytes() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] GreyView frame(std::int64_t number) const {
    return {pixels.data() + static_cast<std::size_t>(number % kRing) * bytes(), width, height,
            width};
  }
  [[nodiscard]] Detector detector() const {
    return {lab::optics::CameraModel(settings.camera), settings.cap, settings.imaging};
  }
};

const Film& film(int height, int robots) {
  static std::unique_ptr<Film> kept;
  static int kept_height = 0;
  static int kept_robots = 0;
  if (kept == nullptr || kept_height != height || kept_robots != robots) {
    kept = std::make_unique<Film>(height * 16 / 9, height, robots);
    kept_height = height;
    kept_robots = robots;
  }
  return *kept;
}

// Vectorised, so that memory bandwidth is the limit.
__attribute__((target_clones("avx2", "default"))) std::uint64_t sumOf(const std::uint8_t* bytes,
                                                                      std::size_t count) {
  using Four = std::uint64_t __attribute__((vector_size(32)));
  Four sum{};
  for (std::size_t i = 0; i + sizeof sum <= count; i += sizeof sum) {
    Four some;
    std::memcpy(&some, bytes + i, sizeof some);
    sum += some;
  }
  return sum[0] + sum[1] + sum[2] + sum[3];
}

void readOnce(benchmark::State& state) {
  const Film& pictures = film(static_cast<int>(state.range(0)), 50);
  std::int64_t number = 0;
  for (auto _ : state) {
    const GreyView frame = pictures.frame(number++);
    benchmark::DoNotOptimize(sumOf(frame.data, pictures.bytes()));
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(pictures.bytes()));
}
BENCHMARK(readOnce)->Arg(720)->Arg(1080)->Unit(benchmark::kMicrosecond);

void search(benchmark::State& state) {
  const Film& pictures = film(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  Detector detector = pictures.detector();
  std::int64_t number = 0;
  std::size_t found = 0;
  for (auto _ : state) found += detector.search(pictures.frame(number++)).size();
  state.counters["found"] = static_cast<double>(found) / static_cast<double>(number);
}
BENCHMARK(search)
    ->ArgsProduct({{720, 1080}, {1, 20, 50}})
    ->ArgNames({"rows", "robots"})
    ->Unit(benchmark::kMicrosecond);

void follow(benchmark::State& state) {
  const Film& pictures = film(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  Detector detector = pictures.detector();
  std::vector<std::vector<Expected>> expected(kScenes);
  for (std::size_t scene = 0; scene < kScenes; ++scene) {
    for (const auto& robot : pictures.robots[scene]) {  // moved as in 1/30 s
      expected[scene].push_back({robot.x + 0.003, robot.y - 0.002, robot.theta + 0.05, 0.01, 0.5});
    }
  }
  std::int64_t number = 0;
  std::size_t found = 0;
  for (auto _ : state) {
    const auto& wanted = expected[static_cast<std::size_t>(number % kScenes)];
    for (const Detection& one : detector.follow(pictures.frame(number), wanted)) {
      found += one.quality > 0 ? 1 : 0;
    }
    ++number;
  }
  state.counters["found"] = static_cast<double>(found) / static_cast<double>(number);
}
BENCHMARK(follow)
    ->ArgsProduct({{720, 1080}, {20, 50}})
    ->ArgNames({"rows", "robots"})
    ->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
