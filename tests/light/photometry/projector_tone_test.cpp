#include "light/photometry/projector_tone.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::optics {
namespace {

const ProjectorTone kAssumed(1.9, {0.02, 0, -0.05, 0, -0.06}, 1.2, 0.9);
const ProjectorTone kActual(2.2, {0, 0, -0.125, 0, -0.125}, 1.2, 0.9);

TEST(ToneTable, EqualsThePower) {
  for (const ProjectorTones& tones :
       {ProjectorTones{ProjectorTone(), kActual}, ProjectorTones{kAssumed, ProjectorTone()},
        ProjectorTones{kAssumed, kActual}, ProjectorTones{kActual, kActual}}) {
    const ToneTable table(tones);
    for (const Place place : {Place{0, 0}, Place{0.6, 0.45}, Place{1.1, 0.2}}) {
      for (double intensity = 0; intensity <= 1.0; intensity += 0.00037) {
        const double exact = tones.light(intensity, place, {place.x + 0.001, place.y});
        ASSERT_NEAR(table.light(intensity, place, {place.x + 0.001, place.y}), exact, 1e-6)
            << intensity;
      }
    }
  }
}

TEST(ProjectorTones, AKnownProjectorGivesTheWantedLight) {
  const ProjectorTones tones{kActual, kActual};
  for (const double intensity : {0.1, 0.5, 1.0}) {
    // In units of the white where it is weakest.
    EXPECT_NEAR(tones.light(intensity, {0.3, 0.3}, {0.3, 0.3}) / kActual.weakest(), intensity,
                1e-12);
  }
}

}  // namespace
}  // namespace lab::optics
