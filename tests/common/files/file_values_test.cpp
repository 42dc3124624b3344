#include "common/files/file_values.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "common/math/random.hpp"

namespace lab::keys {
namespace {

double readBack(const std::string& text, const FileUnit& unit) {
  return toSi(std::stod(text), unit);
}

TEST(FileValues, HaveTheUnitOfTheKeysSuffix) {
  EXPECT_EQ(unitOf("v_cm_s").text, "cm/s");
  EXPECT_EQ(unitOf("x_cm").text, "cm");
  EXPECT_EQ(unitOf("speed_noise_cm_sqrt_s").text, "cm/sqrt(s)");
  EXPECT_EQ(unitOf("eta_rad_s").text, "rad/s");
  EXPECT_EQ(unitOf("gamma_per_s").text, "1/s");
  EXPECT_EQ(unitOf("delay_ms").text, "ms");
  EXPECT_EQ(unitOf("duration_s").text, "s");
  EXPECT_EQ(unitOf("intensity").text, "");
}

TEST(FileValues, ConvertToTheNearestSiNumber) {
  EXPECT_EQ(toSi(7.5, unitOf("x_cm")), 0.075);
  EXPECT_EQ(toSi(7, unitOf("v_cm_s")), 0.07);
  EXPECT_EQ(toSi(20, unitOf("delay_ms")), 0.02);
  EXPECT_EQ(toSi(0.5, unitOf("clock_error_percent")), 0.005);
  EXPECT_EQ(toSi(180, unitOf("theta_deg")), std::numbers::pi);
}

TEST(FileValues, AreAsShortAsPossible) {
  EXPECT_EQ(fileText(0.03, unitOf("v_cm_s")), "3");
  EXPECT_EQ(fileText(0.07, unitOf("v_cm_s")), "7");
  EXPECT_EQ(fileText(1.1625, unitOf("x_cm")), "116.25");
  EXPECT_EQ(fileText(std::numbers::pi / 2, unitOf("theta_deg")), "90");
  EXPECT_EQ(fileText(100000, unitOf("duration_s")), "100000");
  EXPECT_EQ(fileText(0.0001, unitOf("intensity")), "0.0001");
  EXPECT_EQ(fileText(-0.0, unitOf("x_cm")), "0");
}

TEST(FileValues, OfAllWholeNumbersAndTenthsAreWrittenAsRead) {
  for (const char* key : {"x_cm", "theta_deg", "delay_ms", "noise_percent", "duration_s"}) {
    const FileUnit& unit = unitOf(key);
    for (int tenths = -3600; tenths <= 36000; ++tenths) {
      const double written = tenths / 10.0;
      EXPECT_EQ(fileText(toSi(written, unit), unit), numberText(written)) << key;
    }
  }
}

TEST(FileValues, AreReadBackExactlyIfTheFileCanExpressThem) {
  Random random(1);
  for (const char* key : {"x_cm", "theta_deg", "delay_ms", "noise_percent", "duration_s"}) {
    const FileUnit& unit = unitOf(key);
    for (int i = 0; i < 20'000; ++i) {
      const double si = toSi(std::exp(20 * random.uniform() - 10), unit);
      EXPECT_EQ(readBack(fileText(si, unit), unit), si) << key;
    }
  }
}

TEST(FileValues, ThatTheFileCannotExpressAreReadBackAsANeighbour) {
  Random random(2);
  const FileUnit& unit = unitOf("theta_deg");
  for (int i = 0; i < 20'000; ++i) {
    const double si = 6.3 * random.uniform();
    const std::string text = fileText(si, unit);
    const double back = readBack(text, unit);
    EXPECT_NEAR(back, si, 4e-16 * si);
    EXPECT_EQ(fileText(back, unit), text);
  }
}

TEST(TomlString, EscapesLineEndsAndQuotes) {
  EXPECT_EQ(tomlString("a \"b\"\\\n\t\x7f \xc3\xbc"),
            "\"a \\\"b\\\"\\\\\\n\\u0009\\u007F \xc3\xbc\"");
}

}  // namespace
}  // namespace lab::keys
