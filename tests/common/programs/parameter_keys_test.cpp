#include "common/programs/parameter_keys.hpp"

#include <gtest/gtest.h>

#include <string>

namespace lab::parameter_keys_test {
namespace {

std::string unitText(const std::string& suffix) {
  const auto unit = unitOfSuffix(suffix);
  return unit ? unit->text + " " + language::unitText(unit->dimension) : "none";
}

TEST(ParameterKeys, NameUnits) {
  EXPECT_EQ(unitText("cm_s"), "cm/s cm/s");
  EXPECT_EQ(unitText("m_s"), "m/s cm/s");
  EXPECT_EQ(unitText("rad_s"), "rad/s 1/s");
  EXPECT_EQ(unitText("deg"), "deg 1");
  EXPECT_EQ(unitText("per_s"), "1/s 1/s");
  EXPECT_EQ(unitText("hz"), "1/s 1/s");
  EXPECT_EQ(unitText("per_cm"), "1/cm 1/cm");
  EXPECT_EQ(unitText("cm2_s"), "cm*cm/s cm^2/s");
  EXPECT_EQ(unitText("cm_s2"), "cm/s/s cm/s^2");
  EXPECT_EQ(unitText("cm_per_s"), "cm/s cm/s");
  EXPECT_EQ(unitText("percent"), "percent 1");
  EXPECT_EQ(unitText(""), " 1");
  for (const char* none : {"km_h", "per", "_", "s_", "cm__s", "2", "cm4"}) {
    EXPECT_EQ(unitText(none), "none") << none;
  }
}

TEST(ParameterKeys, ListWhatAParameterMayBe) {
  EXPECT_EQ(keysOfParameter("v", language::kSpeed, false), "v_cm_s, v_m_s or v_mm_s");
  EXPECT_EQ(keysOfParameter("eta", language::kRate, true), "eta_rad_s or eta_deg_s");
  EXPECT_EQ(keysOfParameter("gamma", language::kRate, false),
            "gamma_per_s, gamma_hz or gamma_per_min");
  EXPECT_EQ(keysOfParameter("n", language::kPure, false), "n or n_percent");
  EXPECT_EQ(keysOfParameter("odd", {3, -2, 1}, false), "parameters = {odd = \"...\"}");
}

// Every suffix that a message names is accepted, and has the dimension.
TEST(ParameterKeys, AcceptWhatTheyList) {
  using language::Dimension;
  for (const Dimension& dimension :
       {language::kSpeed, language::kLength, language::kTime, language::kRate, language::kPure,
        language::kVoltage, Dimension{2, -1, 0}, Dimension{2, 0, 0}, Dimension{-1, 0, 0},
        Dimension{1, -2, 0}}) {
    for (const bool angle : {false, true}) {
      std::string keys = keysOfParameter("a", dimension, angle);
      if (keys.starts_with("parameters")) continue;
      for (std::size_t at = keys.find(" or "); at != std::string::npos; at = keys.find(" or ")) {
        keys.replace(at, 4, ", ");
      }
      keys += ", ";
      for (std::size_t at = 0; at < keys.size();) {
        const std::size_t end = keys.find(", ", at);
        const std::string key = keys.substr(at, end - at);
        const auto unit = unitOfSuffix(key.size() > 2 ? key.substr(2) : "");
        ASSERT_TRUE(unit) << key;
        EXPECT_EQ(unit->dimension, dimension) << key;
        at = end + 2;
      }
    }
  }
}

}  // namespace
}  // namespace lab::parameter_keys_test
