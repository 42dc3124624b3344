#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/reference_table.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace {

struct Output {
  std::string text;  ///< stdout and stderr
  int code = -1;
};

/// Runs the program in a shell, in a folder.
Output lab(const std::string& arguments, const std::filesystem::path& folder = ".") {
  Output output;
  const std::string command =
      "cd '" + folder.string() + "' && " LAB_PROGRAM " " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return output;
  char buffer[4096];
  for (std::size_t n = 0; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
    output.text.append(buffer, n);
  }
  const int status = pclose(pipe);
  output.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return output;
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) all.push_back(line);
  return all;
}

std::vector<double> numbers(const std::string& line) {
  std::vector<double> all;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) all.push_back(std::stod(field));
  return all;
}

double tolerance(double expected) { return std::max(1e-10 * std::abs(expected), 1e-12); }

TEST(LabTheory, PrintsTheHighPrecisionTable) {
  // One call for each set of parameters and each phase.
  std::map<std::string, std::vector<std::vector<std::string>>> sets;
  for (const auto& row : lab::analysis::readTable("unit_tests.csv")) {
    const std::string keys = row[0] == "ABP" ? "abp v_cm_s=" + row[1] + " eta_rad_s=" + row[3]
                             : std::stod(row[1]) == 0
                                 ? "bp V_cm_s=" + row[3]
                                 : "noisy_abp va_cm_s=" + row[1] + " V_cm_s=" + row[3];
    sets[keys + " epsilon_s=" + row[2] + " diameter_cm=" + row[4]].push_back(row);
  }
  ASSERT_GE(sets.size(), 8U);
  for (const auto& [keys, rows] : sets) {
    std::string list;
    for (const auto& row : rows) list += (list.empty() ? "" : ",") + row[5];
    const double epsilon = std::stod(rows.front()[2]);
    const Output random = lab("theory " + keys + " --lags " + list);
    const Output draw = lab("theory " + keys + " --phase-s 0 --lags " + list);
    const Output middle =
        lab("theory " + keys + " --phase-s " + std::to_string(epsilon / 2) + " --lags " + list);
    ASSERT_EQ(random.code, 0) << random.text;
    const auto table = lines(random.text);
    ASSERT_EQ(table.size(), rows.size() + 1);
    EXPECT_EQ(table.front(), "tau_s,msd_cm2,amsd_rad2,cv_cm2_s2,msd_paper_cm2");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto dut = numbers(table[i + 1]);
      ASSERT_EQ(dut.size(), 5U);
      const auto expect = [&](double value, const std::string& text) {
        EXPECT_NEAR(value, std::stod(text), tolerance(std::stod(text)))
            << keys << " " << rows[i][5];
      };
      EXPECT_EQ(dut[0], std::stod(rows[i][5]));
      expect(dut[1], rows[i][6]);
      expect(dut[2], rows[i][7]);
      expect(dut[3], rows[i][8]);
      expect(numbers(lines(draw.text).at(i + 1)).at(1), rows[i][9]);
      expect(numbers(lines(middle.text).at(i + 1)).at(1), rows[i][10]);
    }
  }
}

TEST(LabTheory, PrintsRunAndTumbleAtItsDefaultLags) {
  const Output output = lab("theory rtp v_cm_s=5 gamma_per_s=3 tau_t_s=0.5");
  ASSERT_EQ(output.code, 0) << output.text;
  const auto table = lines(output.text);
  ASSERT_EQ(table.size(), 102U);
  EXPECT_EQ(numbers(table[1]).at(0), 0.01);
  EXPECT_EQ(numbers(table.back()).at(0), 1000);
  for (std::size_t i = 1; i < table.size(); ++i) {
    const auto row = numbers(table[i]);
    EXPECT_NEAR(row.at(1) / row.at(4), 1, 1e-13);  // eq. 6 is exact
  }
}

TEST(LabTheory, TakesMissingParametersFromTheShippedProgram) {
  const Output all = lab("theory abp v_cm_s=5 epsilon_s=0.5 eta_rad_s=3 --lags 0.3,7");
  const Output one = lab("theory abp epsilon_s=0.5 --lags 0.3,7");
  ASSERT_EQ(lines(all.text).size(), 3U) << all.text;
  EXPECT_EQ(one.text, all.text);
}

TEST(LabTheory, PrintsTheFormulasOfAProgramFile) {
  const lab::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "my \"own\" motion.toml";
  lab::support::writeFile(file, R"toml(
law = {msd = "2*v*v/gamma*(tau - (1 - exp(-gamma*tau))/gamma)"}
parameters = {v = "5 cm/s", gamma = "0.5 1/s"}
[phases.run]
forward = "v"
hold = "exponential(1/gamma)"
next = "turn"
[phases.turn]
turn = "uniform(-pi, pi) / 0.1 s"
hold = "0.1 s"
next = "run"
)toml");
  for (const auto& [set, v] :
       std::vector<std::pair<std::string, double>>{{"", 5}, {" v_cm_s=2", 2}}) {
    for (const std::string& command :
         {"theory '" + file.string() + "'", std::string("theory 'my \"own\" motion.toml'")}) {
      const Output output = lab(command + set + " --lags 1,30", folder.path());
      ASSERT_EQ(output.code, 0) << output.text;
      const auto table = lines(output.text);
      ASSERT_EQ(table.size(), 3U) << output.text;
      for (std::size_t i = 1; i < table.size(); ++i) {
        const auto row = numbers(table[i]);
        EXPECT_NEAR(row.at(1) / (4 * v * v * (row.at(0) - 2 * (1 - std::exp(-row.at(0) / 2)))), 1,
                    1e-12)
            << output.text;
      }
    }
  }
}

TEST(LabTheory, SaysWhatIsWrongInAProgramFile) {
  const lab::TemporaryFolder folder;
  lab::support::writeFile(folder.path() / "wrong.toml",
                          "law = \"abp\"\n[phases.run]\nforward = \"5 s\"\nhold = \"1 s\"\n");
  const Output wrong = lab("theory wrong.toml", folder.path());
  EXPECT_EQ(wrong.code, 2);
  EXPECT_EQ(lines(wrong.text).size(), 1U) << wrong.text;
  EXPECT_NE(wrong.text.find("wrong.toml:3"), std::string::npos) << wrong.text;
  const Output none = lab("theory none.toml", folder.path());
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.text.find("found \"none.toml\" (no such file)"), std::string::npos) << none.text;
}

TEST(LabTheory, ReportsWrongArgumentsInOneLine) {
  const auto refuses = [](const std::string& arguments, const std::string& text) {
    const Output output = lab("theory " + arguments);
    EXPECT_EQ(output.code, 2) << output.text;
    EXPECT_EQ(lines(output.text).size(), 1U) << output.text;
    EXPECT_NE(output.text.find(text), std::string::npos) << output.text;
  };
  refuses("brown V_cm_s=3", "model: found \"brown\", allowed a file");
  refuses("levy",
          "found program levy, allowed programs with a law in closed form (abp, noisy_abp, "
          "bp, rtp) or with formulas of their own. Reports compare it with simulated films.");
  refuses("phototaxis", "The program reads light");
  refuses("abp epsilon_s=-1", "phases.run.hold: holds for -1 s, expected 1 ms to 3600 s");
  refuses("abp epsilon_cm=1", "epsilon_cm: found a number in cm, allowed for epsilon: epsilon_s");
  refuses("abp v_cm_s=fast", "v_cm_s: found \"fast\", allowed a number in cm/s");
  refuses(
      "abp v_cm_s=3 epsilon_s=0.25 eta_rad_s=1 V_cm_s=3",
      "V_cm_s: found an unknown key, allowed with model = \"abp\": description, parameters; or a "
      "parameter with its unit: v_cm_s, epsilon_s, eta_rad_s");
  refuses("abp v_cm_s=3 epsilon_s=0.25 eta_rad_s=1 eta=1",
          "eta: found a number without unit, allowed for eta: eta_rad_s");
  refuses("bp V_cm_s=3 epsilon_s=0.2 --lags 1,x", "--lags: found \"x\"");
  refuses("bp V_cm_s=3 epsilon_s=0.2 --lags 1,-2", "--lags: found -2, allowed above 0");
  refuses("bp V_cm_s=3 epsilon_s=0.2 --phase-s 0.3", "found 0.3, allowed 0 to epsilon_s = 0.2");
  refuses("bp V_cm_s=3 epsilon_s=0.2 --phase-s nan", "found nan, allowed 0 to epsilon_s = 0.2");
  refuses("rtp v_cm_s=5 gamma_per_s=3 tau_t_s=0.5 --kurtosis", "--kurtosis");
}

TEST(LabTheory, WarnsIfTheWheelsAreTooSlow) {
  const Output output =
      lab("theory rtp v_cm_s=5 gamma_per_s=3 tau_t_s=0.5 --turning-deg 0,360 --lags 1");
  EXPECT_EQ(output.code, 0);
  EXPECT_NE(output.text.find("note: this needs wheels of 47.1 cm/s"), std::string::npos)
      << output.text;
}

TEST(LabTheory, AddsNoiseAndExposureOfTheCamera) {
  const std::string keys = "theory bp V_cm_s=7 epsilon_s=0.2 --lags 1";
  const auto plain = numbers(lines(lab(keys).text).at(1));
  const auto noisy = numbers(lines(lab(keys + " --noise-cm 0.1 --noise-deg 2").text).at(1));
  EXPECT_NEAR(noisy[1] - plain[1], 0.04, 1e-13);
  EXPECT_NEAR(noisy[2] - plain[2], 2 * std::pow(2 * M_PI / 180, 2), 1e-13);
  const auto blurred = numbers(lines(lab(keys + " --exposure-ms 50").text).at(1));
  EXPECT_LT(blurred[1], plain[1]);
  const auto kurtosis = lines(lab(keys + " --kurtosis").text);
  EXPECT_EQ(kurtosis.front(), "tau_s,msd_cm2,amsd_rad2,cv_cm2_s2,msd_paper_cm2,kurtosis");
  EXPECT_NEAR(numbers(kurtosis.at(1)).at(5), 2.84, 0.02);
}

}  // namespace
