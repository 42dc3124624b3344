#include "sim_svc/camera/camera_painter_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/math/random.hpp"
#include "sim_svc/camera/camera_painter_cells.hpp"

namespace lab::sim {

PixelNoise pixelNoise(const optics::Imaging& imaging, double gain) {
  return {imaging.read_noise * imaging.read_noise * 0.5 * (1 + gain * gain),
          imaging.shot_gain * gain};
}

namespace painter {
namespace {

constexpr std::size_t kTable = 1U << 16U;
constexpr int kPiece = 256;      // [px] read from consecutive entries of the table
constexpr int kFullScale = 255;  // [DN]
constexpr int kFine = 64;        // [1/DN] resolution of light before the response; below the noise

struct Law {
  float floor;
  float slope;
  float black;
};

// Adds noise to the light; the result is in units of 1 / fine DN.
template <typename Step>
[[gnu::always_inline]] inline void finishPiece(const float* __restrict mean,
                                               const float* __restrict normal, Law law, float fine,
                                               Step* __restrict out, int count) {
  const float most = fine * static_cast<float>(kFullScale);
  for (int i = 0; i < count; ++i) {
    const float signal = mean[i] - law.black;
    const float variance = law.floor + law.slope * (signal > 0.0F ? signal : 0.0F);
    float light = fine * (mean[i] + __builtin_sqrtf(variance) * normal[i]) + 0.5F;
    light = light > 0.0F ? light : 0.0F;
    light = light < most ? light : most;
    out[i] = static_cast<Step>(static_cast<std::int32_t>(light));
  }
}

LAB_TARGET_CLONES
void finishBytes(const float* __restrict mean, const float* __restrict normal, Law law,
                 std::uint8_t* __restrict out, int count) {
  finishPiece(mean, normal, law, 1.0F, out, count);
}

LAB_TARGET_CLONES
void finishFinely(const float* __restrict mean, const float* __restrict normal, Law law,
                  std::uint16_t* __restrict out, int count) {
  finishPiece(mean, normal, law, static_cast<float>(kFine), out, count);
}

}  // namespace

SensorNoise::SensorNoise(std::uint64_t seed, const optics::CameraResponse& response)
    : seed_(deriveSeed(seed, 0, "pixel noise")), table_(kTable + kPiece) {
  Random random(seed_);
  double sum = 0;
  double squares = 0;
  std::vector<double> normals(kTable);
  for (double& normal : normals) {
    normal = random.normal();
    sum += normal;
    squares += normal * normal;
  }
  const double mean = sum / kTable;
  const double deviation = std::sqrt(squares / kTable - mean * mean);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    // Rounded, so that differences of std::log between libraries do not change a picture.
    const double normal = (normals[i % kTable] - mean) / deviation;
    table_[i] = static_cast<float>(std::round(normal * 4096) / 4096);
  }
  if (response.isLinear()) return;
  for (int light = 0; light <= kFullScale * kFine; ++light) {
    const double grey = response.grey(static_cast<double>(light) / kFine);
    steps_.push_back(static_cast<std::uint8_t>(std::lround(grey)));
  }
}

void SensorNoise::finish(std::span<const float> mean, int width, const PixelNoise& noise,
                         double black, std::int64_t frame, std::span<std::uint8_t> out) const {
  const Law law{static_cast<float>(noise.floor), static_cast<float>(noise.slope),
                static_cast<float>(black)};
  Random places(seed_, static_cast<std::uint64_t>(frame) + 1);
  const auto columns = static_cast<std::size_t>(width);
  std::array<std::uint16_t, kPiece> fine;
  for (std::size_t row = 0; row < mean.size(); row += columns) {
    for (std::size_t x = 0; x < columns; x += kPiece) {
      const std::size_t count = std::min<std::size_t>(kPiece, columns - x);
      const float* light = mean.data() + row + x;
      const float* normal = table_.data() + (places.next() % kTable);
      std::uint8_t* bytes = out.data() + row + x;
      if (steps_.empty()) {
        finishBytes(light, normal, law, bytes, static_cast<int>(count));
        continue;
      }
      finishFinely(light, normal, law, fine.data(), static_cast<int>(count));
      for (std::size_t i = 0; i < count; ++i) bytes[i] = steps_[fine[i]];
    }
  }
}

}  // namespace painter
}  // namespace lab::sim
