#include "projector_ctl/painter/calibrated_tone.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace lab::projector {
namespace {

TEST(CalibratedTone, EqualsTheToneAtThePositionOfEveryPixel) {
  const optics::ProjectorModel model(1.2, 0.9, 160, 120);
  const optics::ProjectorTone tone(2.2, {0.05, 0, -0.2, 0.02, -0.1}, 1.2, 0.9);
  const CalibratedTone dut(tone, model);
  int worst = 0;
  for (int level = 0; level <= 1000; ++level) {
    const double intensity = level / 1000.0;
    for (const auto& [x, y] : {std::pair{0, 0}, {159, 119}, {80, 60}, {3, 100}}) {
      std::uint8_t found = 0;
      dut.apply(&intensity, x, y, 1, &found);
      const auto place = model.placeOf({static_cast<double>(x), static_cast<double>(y)});
      const int wanted = static_cast<int>(std::lround(255 * tone.value(intensity, *place)));
      worst = std::max(worst, std::abs(found - wanted));
    }
  }
  EXPECT_LE(worst, 1);
}

TEST(CalibratedTone, AppliesToPartsOfARow) {
  const optics::ProjectorModel model(1.2, 0.9, 16, 12);
  const CalibratedTone dut({1, {0, 0, -0.3, 0, 0}, 1.2, 0.9}, model);
  const std::vector<double> row(16, 1.0);
  std::vector<std::uint8_t> out(16);
  dut.apply(row.data(), 0, 5, row.size(), out.data());
  EXPECT_EQ(out.front(), 242) << "0.951 of white, at this distance from the wall";
  EXPECT_EQ(out.front(), out.back());
  EXPECT_LT(out[8], out.front());
}

}  // namespace
}  // namespace lab::projector
