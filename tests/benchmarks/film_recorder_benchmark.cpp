// The recorder of films: processor time and bytes of a frame, by codec. Arguments: codec (0 ffv1,
// 1 ffvhuff, 2 h264), rows of the picture. Pictures of 20 robots with the noise of the simulated
// camera. Counters: frames a second, cpu_ms and kB of a frame, and the share of a core at 60 frames
// a second.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tracker_svc/cameras/film_recorder.hpp"

namespace {

using namespace lab;

constexpr int kFrames = 120;
constexpr std::int64_t kPeriod_us = 16'667;

std::vector<optics::GreyImage> paintedFrames(int width, int height) {
  sim::PainterSettings settings;
  settings.camera = optics::simulatedCamera(width, height, 1.2, 0.9);
  sim::CameraPainter painter(settings);
  light::Field field;
  field.layers.push_back({.intensity = 0.8});
  painter.setLight(field);
  std::vector<optics::GreyImage> frames;
  for (int k = 0; k < 8; ++k) {
    std::vector<sim::PaintedRobot> robots;
    for (int i = 0; i < 20; ++i) {
      robots.push_back({0.1 + 0.11 * (i % 10) + 1e-3 * k, 0.25 + 0.4 * (i / 10), 0.7 * i});
    }
    painter.paint(robots, k, frames.emplace_back(width, height).pixels);
  }
  return frames;
}

void recordFilm(benchmark::State& state) {
  const int height = static_cast<int>(state.range(1));
  const int width = height * 16 / 9;
  const std::vector<optics::GreyImage> frames = paintedFrames(width, height);
  cameras::FilmRecording recording;
  recording.film.codec = static_cast<FilmCodec>(state.range(0));
  recording.format.width = width;
  recording.format.height = height;
  recording.format.fps = 60;
  recording.may_wait = true;
  double cpu = 0;
  double bytes = 0;
  double recorded = 0;
  for (auto _ : state) {
    const TemporaryFolder folder;
    recording.folder = folder.path();
    {
      cameras::FilmRecorder recorder(recording);
      for (int i = 0; i < kFrames; ++i) {
        const std::int64_t utime = 1 + i * kPeriod_us;
        recorder.add({.number = i, .camera_utime = utime}, utime,
                     frames[static_cast<std::size_t>(i) % frames.size()].view());
      }
    }
    const FilmFacts facts = readFilmFacts(folder.path() / film_files::kFacts);
    if (facts.frames != kFrames) state.SkipWithError(facts.problem.c_str());
    cpu += facts.cpu;
    bytes += static_cast<double>(facts.bytes);
    recorded += static_cast<double>(facts.frames);
  }
  state.counters["frames"] = benchmark::Counter(recorded, benchmark::Counter::kIsRate);
  state.counters["cpu_ms"] = 1e3 * cpu / recorded;
  state.counters["kB"] = 1e-3 * bytes / recorded;
  state.counters["cores_at_60_Hz"] = 60 * cpu / recorded;
}

}  // namespace

BENCHMARK(recordFilm)
    ->ArgsProduct({{0, 1, 2}, {720, 1080}})
    ->ArgNames({"codec", "rows"})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_MAIN();
