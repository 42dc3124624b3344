#include "analyzer/laws/held_noise_law.hpp"

#include <memory>
#include <utility>
#include <vector>

namespace lab::analysis {

std::shared_ptr<const HeldNoise> cachedHeldNoise(const HeldNoiseKey& key) {
  constexpr std::size_t kKept = 128;  // more than the programs of an analysis
  thread_local std::vector<std::pair<HeldNoiseKey, std::shared_ptr<const HeldNoise>>> kept;
  thread_local std::size_t oldest = 0;
  for (const auto& [known, noise] : kept) {
    if (known == key) return noise;
  }
  auto noise = std::make_shared<const HeldNoise>(
      key.wheels ? HeldNoise::uniformWheels(key.speed, key.amplitude, key.wheel_base, key.hold)
                 : HeldNoise::uniformTurning(key.speed, key.amplitude, key.hold));
  if (kept.size() < kKept) {
    kept.emplace_back(key, noise);
  } else {
    kept[oldest] = {key, noise};
    oldest = (oldest + 1) % kKept;
  }
  return noise;
}

}  // namespace lab::analysis
