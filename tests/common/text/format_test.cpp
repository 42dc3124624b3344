#include "common/text/format.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/math/units.hpp"

namespace lab::report {
namespace {

using units::kNan;

TEST(Format, RoundsToTheError) {
  EXPECT_EQ(valueText(0.748123, 0.0123), "0.748");
  EXPECT_EQ(valueText(12.3456, 1.7), "12.3");
  EXPECT_EQ(valueText(1234.5, 210), "1234");
  EXPECT_EQ(valueText(3.00003, 0.00049), "3.00003");
  EXPECT_EQ(valueText(0.75, 0), "0.75");
  EXPECT_EQ(valueText(kNan, 0.1), "–");
  EXPECT_EQ(valueText(0.75, kNan), "0.75");
}

TEST(Format, ShortensNumbersWithoutError) {
  EXPECT_EQ(shortText(3), "3");
  EXPECT_EQ(shortText(0.40831), "0.4083");
  EXPECT_EQ(shortText(-20.50001), "-20.5");
  EXPECT_EQ(shortText(0), "0");
  EXPECT_EQ(shortText(1.5e-6), "1.500e-06");
  EXPECT_EQ(shortText(std::numeric_limits<double>::infinity()), "–");
}

TEST(Format, FormatsDurations) {
  EXPECT_EQ(durationText(3.25), "3.2 s");
  EXPECT_EQ(durationText(60), "60 s");
  EXPECT_EQ(durationText(99.96), "1 min 40 s");
  EXPECT_EQ(durationText(3600), "1 h 0 min");
  EXPECT_EQ(durationText(-2), "-2 s");
}

TEST(Format, ConvertsUnitsToCentimetres) {
  EXPECT_EQ(displayUnit("m^2/s").text, "cm²/s");
  EXPECT_EQ(displayUnit("m^2/s").key, "cm2_s");
  EXPECT_DOUBLE_EQ(displayUnit("m^2/s").factor, 1e4);
  EXPECT_DOUBLE_EQ(displayUnit("rad^2/s").factor, 1);
  EXPECT_EQ(displayUnit("furlong").text, "furlong");
  EXPECT_EQ(displayUnit("1/(m s)").text, "1/(cm s)");
  EXPECT_DOUBLE_EQ(displayUnit("1/(m s)").factor, 0.01);
  EXPECT_EQ(displayUnit("m/s^2").text, "cm/s²");
  EXPECT_EQ(displayUnit("m/s^2").key, "cm_s2");
  EXPECT_DOUBLE_EQ(displayUnit("m^3/s").factor, 1e6);
  EXPECT_EQ(displayUnit("1/m").key, "per_cm");
}

TEST(Format, WritesQuantitiesWithTheirUnit) {
  EXPECT_EQ(quantityText(0.05, "m/s", 6), "5 cm/s");
  EXPECT_EQ(quantityText(0.40142572795869580, "rad/s", 6), "0.401426 rad/s");
  EXPECT_EQ(quantityText(2.5e-4, "m^2/s", 6), "2.5 cm²/s");
  EXPECT_EQ(quantityText(1.5, "1", 6), "1.5");
  EXPECT_EQ(quantityText(1.0 / 3, "1/s", 4), "0.3333 1/s");
}

TEST(Format, EscapesHtml) {
  EXPECT_EQ(escapeHtml("<b a=\"1\" c='2'>&\x01"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;");
  EXPECT_EQ(symbolHtml("D_r"), "<i>D</i><sub>r</sub>");
  EXPECT_EQ(symbolHtml("gamma"), "<i>γ</i>");
  EXPECT_EQ(symbolHtml("omega"), "<i>ω</i>");
  EXPECT_EQ(symbolHtml("<x>_<y>"), "<i>&lt;x&gt;</i><sub>&lt;y&gt;</sub>");
}

TEST(Format, MakesFileNames) {
  EXPECT_EQ(sanitizedFileName("noisy ABP"), "noisy_ABP");
  EXPECT_EQ(sanitizedFileName("../../etc"), "etc");
  EXPECT_EQ(sanitizedFileName("///"), "program");
}

TEST(Format, KnowsWhatASpreadsheetComputes) {
  for (const char* text : {"=1", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1"}) {
    EXPECT_TRUE(isSpreadsheetFormula(text)) << text;
  }
  for (const char* text : {"", "abp", "a=1", " =1", "'=1"})
    EXPECT_FALSE(isSpreadsheetFormula(text)) << text;
}

TEST(Format, GroupsLargeCounts) {
  EXPECT_EQ(groupedText(999), "999");
  EXPECT_EQ(groupedText(1234567), "1\u202f234\u202f567");
  EXPECT_EQ(countText(1, "robot"), "1 robot");
  EXPECT_EQ(countText(2, "robot"), "2 robots");
}

}  // namespace
}  // namespace lab::report
