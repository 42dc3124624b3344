#include "sim_svc/camera_painter_noise.hpp"

#include <algorithm>
#include <cmath>

#include "common/random.hpp"
#include "sim_svc/camera_painter_cells.hpp"

namespace lab::sim {

PixelNoise pixelNoise(const optics::Imaging& imaging, double gain) {
  return {imaging.read_noise * imaging.read_noise * 0.5 * (1 + gain * gain),
          imaging.shot_gain * gain};
}

namespace painter {
namespace {

constexpr std::size_t kTable = 1U << 16U;
constexpr int kPiece = 256;  // [px] read in one go

struct Law {
  float floor;
  float slope;
  float black;
};

LAB_PAINTER_CLONES
void finishPiece(const float* __restrict mean, const float* __restrict normal, Law law,
                 std::uint8_t* __restrict out, int count) {
  for (int i = 0; i < count; ++i) {
    const float signal = mean[i] - law.black;
    const float variance = law.floor + law.slope * (signal > 0.0F ? signal : 0.0F);
    float grey = mean[i] + __builtin_sqrtf(variance) * normal[i] + 0.5F;
    grey = grey > 0.0F ? grey : 0.0F;
    grey = grey < 255.0F ? grey : 255.0F;
    out[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>(grey));
  }
}

}  // namespace

Grain::Grain(std::uint64_t seed)
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
    // Coarse steps, so that the last digit of a logarithm does not reach a picture.
    const double normal = (normals[i % kTable] - mean) / deviation;
    table_[i] = static_cast<float>(std::round(normal * 4096) / 4096);
  }
}

void Grain::finish(std::span<const float> mean, int width, const PixelNoise& noise, double black,
                   std::int64_t frame, std::span<std::uint8_t> out) const {
  const Law law{static_cast<float>(noise.floor), static_cast<float>(noise.slope),
                static_cast<float>(black)};
  Random places(seed_, static_cast<std::uint64_t>(frame) + 1);
  const auto columns = static_cast<std::size_t>(width);
  for (std::size_t row = 0; row < mean.size(); row += columns) {
    for (std::size_t x = 0; x < columns; x += kPiece) {
      const std::size_t count = std::min<std::size_t>(kPiece, columns - x);
      finishPiece(mean.data() + row + x, table_.data() + (places.next() % kTable), law,
                  out.data() + row + x, static_cast<int>(count));
    }
  }
}

}  // namespace painter
}  // namespace lab::sim
