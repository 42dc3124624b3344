// stop_when in the controller: the run ends by an estimate of the analyzer or by its duration.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <lab/analysis_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/math/units.hpp"
#include "common/service/node.hpp"
#include "runner/live/experiment_controller.hpp"
#include "tests/support/experiment_samples.hpp"

namespace lab::runner::controller_stop_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::int64_t kSecond_us = 1'000'000;

/// Added to the small experiment.
constexpr const char* kStopWhen = R"([[stop_when]]
estimate = "D_r"
program = "abp"
relative_error_percent = 10
)";

/// A controller and an analyzer whose relative error falls as 1 / sqrt(t).
class ExperimentControllerStop : public testing::Test {
 protected:
  struct End {
    Ending ending = Ending::kBroken;
    std::string why;
    double at = 0;  ///< [s] since begin()
  };

  /// @param first relative error after one second
  End play(double first) {
    const Experiment experiment = small(kStopWhen);
    VirtualLoop loop;
    MemoryBus bus([&loop] { return loop.now(); });
    loop.drainWith([&bus] { bus.deliver(); });
    Node node(bus, loop, {"lab", 0, 1});
    Node analyzer(bus, loop, {"analyzer", 0, 1});
    std::optional<End> end;
    const std::int64_t begin = loop.now();
    ExperimentController controller({node, loop, experiment, "."}, writeExperiment(experiment),
                                    [&](Ending ending, const std::string& why) {
                                      if (!end)
                                        end = End{ending, why, units::seconds(loop.now() - begin)};
                                      loop.stop();
                                    });
    loop.every(kSecond_us, begin + kSecond_us, [&] {
      analysis_t message{};
      message.utime = loop.now();
      message.robot_id = analysis_t::POOL;
      message.program = toId(experiment.programs.at("abp"));
      message.estimates.resize(1);
      message.num_estimates = 1;
      message.estimates[0].name = "D_r";
      message.estimates[0].value = 0.75;
      message.estimates[0].sigma = 0.75 * first / std::sqrt(units::seconds(message.utime - begin));
      analyzer.publish(channels::kAnalysis, message);
      progress_ = controller.progress();
    });
    node.start();
    analyzer.start();
    controller.begin();
    loop.run();
    faults_ = controller.faults();
    return end.value_or(End{});
  }

  Progress progress_;  ///< the last one before the end
  std::vector<std::string> faults_;
};

TEST_F(ExperimentControllerStop, EndsTheRunWhenTheEstimateIsKnown) {
  const End end = play(0.5);  // 10 % after 25 s
  EXPECT_EQ(end.ending, Ending::kDone);
  EXPECT_NEAR(end.at, 25, 1.01);  // 0.5 / sqrt(25) may round to more than 0.1
  EXPECT_THAT(end.why,
              StartsWith("stop_when: D_r of abp is known to 10 %: relative error 0.1 after"));
  EXPECT_TRUE(progress_.at_most);
  EXPECT_THAT(progress_.stop, StartsWith("D_r of abp 10"));
  EXPECT_THAT(progress_.stop, HasSubstr("wanted 10 %"));
}

TEST_F(ExperimentControllerStop, MarksARunThatDoesNotMeetTheRule) {
  const End end = play(2);
  EXPECT_EQ(end.ending, Ending::kUnmet);
  EXPECT_GE(end.at, 60);
  EXPECT_THAT(end.why,
              StartsWith("stop_when was not reached; D_r of abp is known to 10 %: relative "
                         "error 0.2"));
  EXPECT_EQ(faults_.back(), end.why);
}

}  // namespace
}  // namespace lab::runner::controller_stop_test
