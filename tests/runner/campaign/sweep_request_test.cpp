#include "runner/campaign/sweep_request.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "runner/campaign/campaign_plan.hpp"
#include "runner/command_line/exit_code.hpp"
#include "tests/support/experiment_samples.hpp"

namespace lab::runner::campaign::sweep_request_test {
namespace {

const std::string kSwept =
    std::string(kSmall) + "[sweep]\nover = [\"programs.abp.eta_rad_s = 1:3:3\"]\n";

SweepOptions sampleOptions() {
  SweepOptions options;
  options.input = "small.toml";
  options.over = {"programs.abp.eta_rad_s=1,2"};
  return options;
}

std::string problemOf(const SweepOptions& options, const std::string& text = std::string(kSmall)) {
  try {
    static_cast<void>(requestOf(options, text));
  } catch (const UserError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SweepRequest, RefusesTwoSeeds) {
  SweepOptions options = sampleOptions();
  options.seed = 2;
  options.set = {"seed=3"};
  EXPECT_EQ(problemOf(options), "--seed 2 and --set seed=3: two values for one key; keep one");
  options.set = {"seed = 2", "duration_s=5"};
  EXPECT_EQ(problemOf(options), "accepted");
  options.seed.reset();
  options.set = {"seed=3"};
  EXPECT_EQ(requestOf(options, std::string(kSmall)).seed, 3U);
}

TEST(SweepRequest, RefusesAnOptionAndAnotherSettingOfTheTable) {
  const auto problem = [](const auto& change, const std::string& setting) {
    SweepOptions options = sampleOptions();
    change(options);
    options.set = {setting};
    return problemOf(options);
  };
  const auto seeds = [](SweepOptions& options) { options.seeds = 2; };
  EXPECT_EQ(problem(seeds, "sweep.seeds=3"),
            "--seeds 2 and --set sweep.seeds=3: two values for one key; keep one");
  EXPECT_EQ(problem(seeds, "sweep.seeds=2"), "accepted");
  EXPECT_EQ(problem([](SweepOptions& options) { options.random = 4; }, "sweep.random=5"),
            "--random 4 and --set sweep.random=5: two values for one key; keep one");
  EXPECT_EQ(
      problem([](SweepOptions& options) { options.sampling = "sobol"; }, "sweep.sampling=latin"),
      "--sampling sobol and --set sweep.sampling=latin: two values for one key; keep one");
  for (const char* same : {"sweep.sampling=\"sobol\"", "sweep.sampling = 'sobol'"}) {
    EXPECT_EQ(problem([](SweepOptions& options) { options.sampling = "sobol"; }, same), "accepted");
  }
  EXPECT_EQ(problem([](SweepOptions& options) { options.zip = false; }, "sweep.zip=true"),
            "--no-zip and --set sweep.zip=true: two values for one key; keep one");
  EXPECT_EQ(problem([](SweepOptions&) {}, "sweep.over=[]"),
            "--over programs.abp.eta_rad_s=1,2 and --set sweep.over=[]: two values for one key; "
            "keep one");
}

TEST(SweepRequest, OverReplacesWhatTheFileSaysOfItsAxesButNotSettings) {
  SweepOptions options = sampleOptions();
  options.over.push_back("programs.abp.epsilon_s=0.1,0.2");
  const std::string zipped = kSwept + "zip = true\n";
  EXPECT_FALSE(requestOf(options, zipped).zip);
  options.set = {"sweep.zip=true"};
  EXPECT_TRUE(requestOf(options, kSwept).zip);
  options.set = {"sweep.random=3"};
  EXPECT_EQ(requestOf(options, kSwept).random, 3);
}

TEST(SweepRequest, RefusesASettingOfASweptKey) {
  const auto problem = [](const SweepOptions& options, const std::string& text) -> std::string {
    try {
      static_cast<void>(planCampaign(requestOf(options, text), text));
    } catch (const UserError& error) {
      return error.what();
    }
    return "accepted";
  };
  SweepOptions options = sampleOptions();
  options.set = {"programs.abp.eta_rad_s = 3"};
  EXPECT_EQ(problem(options, std::string(kSmall)),
            "--set programs.abp.eta_rad_s = 3: the key is swept (--over "
            "programs.abp.eta_rad_s=...), expected one of them");
  options.over = {"programs.abp.eta_rad_s=3"};
  options.set = {"programs.abp.eta_rad_s=3"};
  const std::string one_value =
      "--set programs.abp.eta_rad_s=3: the key is swept (--over programs.abp.eta_rad_s=...), "
      "expected one of them";
  EXPECT_EQ(problem(options, std::string(kSmall)), one_value);
  options.over.clear();
  EXPECT_EQ(problem(options, kSwept), one_value);
  options.set = {"programs.abp.epsilon_s=0.2"};
  EXPECT_EQ(problem(options, kSwept), "accepted");
}

}  // namespace
}  // namespace lab::runner::campaign::sweep_request_test
