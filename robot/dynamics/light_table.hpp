#pragma once

#include <stdint.h>

namespace lab {
namespace dynamics {

/// Number of programs, and largest number of light bands, in a robot.
constexpr uint8_t kSlots = 4;
/// The slot of a robot that runs no program.
constexpr uint8_t kNoSlot = 255;
/// One more than the largest light reading of the robot's 10-bit converter.
constexpr uint16_t kLightCounts = 1024;

/// Readings low <= r < high (ADC counts, high at most 1024) select the program in `slot`.
/// Half-open, so that adjacent bands share an edge without overlapping.
struct LightBand {
  uint16_t low = 0;
  uint16_t high = 0;
  uint8_t slot = 0;
};

/// Which of the two light sensors the bands are compared with.
enum LightReading : uint8_t { kMeanLight = 0, kFrontLight = 1, kBackLight = 2 };

struct LightSettings {
  LightBand bands[kSlots];
  uint8_t count = 0;
  uint16_t hysteresis = 0;  ///< The current band is widened by this at both edges [counts].
  LightReading reading = kMeanLight;
};

inline bool operator==(const LightBand& a, const LightBand& b) {
  return a.low == b.low && a.high == b.high && a.slot == b.slot;
}

inline bool operator==(const LightSettings& a, const LightSettings& b) {
  for (uint8_t i = 0; i < kSlots; ++i) {
    if (!(a.bands[i] == b.bands[i])) {
      return false;
    }
  }
  return a.count == b.count && a.hysteresis == b.hysteresis && a.reading == b.reading;
}

/// True if there are at most four bands, each is non-empty and inside 0..1024, no two overlap, and
/// each names one of the four slots.
inline bool isValid(const LightSettings& settings) {
  if (settings.count > kSlots || settings.reading > kBackLight ||
      settings.hysteresis >= kLightCounts) {
    return false;
  }
  for (uint8_t i = 0; i < settings.count; ++i) {
    const LightBand& band = settings.bands[i];
    if (band.low >= band.high || band.high > kLightCounts || band.slot >= kSlots) {
      return false;
    }
    for (uint8_t j = 0; j < i; ++j) {
      if (band.low < settings.bands[j].high && settings.bands[j].low < band.high) {
        return false;
      }
    }
  }
  return true;
}

/// Selects a program slot from the light, with hysteresis. The current band is kept while the
/// reading is inside the band widened by the hysteresis. Otherwise the band that contains the
/// reading becomes the current one; without such a band no slot is selected and the robot stands.
class LightTable {
 public:
  /// Sets the settings and forgets the current band.
  void configure(const LightSettings& settings) {
    settings_ = settings;
    current_ = kNoSlot;
  }

  /// Updates the current band from the readings of both sensors [counts]. Returns the selected slot
  /// or kNoSlot.
  uint8_t update(uint16_t front, uint16_t back) {
    const uint16_t counts = reading(front, back);
    if (current_ >= settings_.count || !contains(current_, counts, settings_.hysteresis)) {
      current_ = find(counts);
    }
    return slot();
  }

  /// The slot selected by the last update, or kNoSlot.
  uint8_t slot() const {
    return current_ < settings_.count ? settings_.bands[current_].slot : kNoSlot;
  }

  /// The reading that is compared with the bands; a mean is rounded half up.
  uint16_t reading(uint16_t front, uint16_t back) const {
    switch (settings_.reading) {
      case kFrontLight:
        return front;
      case kBackLight:
        return back;
      case kMeanLight:
        break;
    }
    return static_cast<uint16_t>((front + back + 1U) / 2U);
  }

 private:
  bool contains(uint8_t band, uint16_t counts, uint16_t margin) const {
    return counts + margin >= settings_.bands[band].low &&
           counts < settings_.bands[band].high + margin;
  }

  uint8_t find(uint16_t counts) const {
    for (uint8_t i = 0; i < settings_.count; ++i) {
      if (contains(i, counts, 0)) {
        return i;
      }
    }
    return kNoSlot;
  }

  LightSettings settings_;
  uint8_t current_ = kNoSlot;
};

}  // namespace dynamics
}  // namespace lab
