/// Converts messages into the input of the analysis. Used by the online analyzer and for closed
/// logs.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/light_status_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "analyzer/laws/law_of.hpp"
#include "analyzer/service/analysis.hpp"
#include "analyzer/service/program_keys.hpp"
#include "common/experiment/experiment.hpp"

namespace lab::analysis {

/// A result, with the program as it is in the messages.
struct FeedResult {
  program_id_t program{};
  Program definition;  ///< of the program; default: not known
  ProgramResult result;
};

[[nodiscard]] RobotBody bodyOf(const RobotHardware& hardware);

/// The settings of the analysis that follow from an experiment file.
[[nodiscard]] AnalysisConfig analysisConfig(const Experiment& experiment);

/// Takes messages in the order in which they arrive. It uses status messages, and of commands only
/// the definitions of programs.
/// The same messages in the same order give the same bits. Times count from the first message that
/// has one.
///
/// A robot has rebooted if its sender restarts or its count of program starts decreases. Its epochs
/// then begin again, and the track is cut there.
class AnalysisFeed {
 public:
  /// One pose that entered the statistics.
  using SampleSink = std::function<void(int robot, const Sample& sample)>;

  /// One piece of free motion, once it has ended.
  using PieceSink = std::function<void(int robot, const program_id_t& program, const Piece& piece)>;

  explicit AnalysisFeed(const Experiment& experiment);

  void take(const tracked_frame_t& frame);
  void take(const robot_status_t& status);
  void take(const light_status_t& status);

  /// Takes the definitions of programs that the experiment does not have. The orders themselves are
  /// not used.
  void take(const robot_command_t& command);

  /// End of data: processes the frames that still wait for telemetry.
  void flush() { analysis_.flush(); }

  /// Sets AnalysisConfig::find_runs. Call it before the first frame.
  void findRuns() { analysis_.findRuns(); }

  /// Called with every sample, from within take() and flush(), in time order for each robot.
  void onSample(SampleSink sink);

  /// Like onSample(), with the law of the program, but nothing is accumulated: results() stays
  /// empty. Call it before the first frame, instead of onSample().
  void samplesOnly(std::function<void(int robot, const ProgramLaw& law, const Sample&)> sink) {
    analysis_.samplesOnly();
    analysis_.onSample(std::move(sink));
  }

  /// Called with every piece, from within take() and flush(), in time order for each robot.
  void onPiece(PieceSink sink);

  /// As Analysis::onFrame() and Analysis::wholeMotion().
  void onFrame(std::function<void(int robot, const FrameReport& frame)> sink) {
    analysis_.onFrame(std::move(sink));
  }
  void wholeMotion() { analysis_.wholeMotion(); }

  /// As Analysis::stitch().
  void stitch(bool join, bool compare) { analysis_.stitch(join, compare); }
  void freeTimes(const std::vector<std::string>& names) { analysis_.freeTimes(names); }

  /// Per program: the pool of its robots first, then each robot.
  /// @param meanwhile as of Analysis::results()
  [[nodiscard]] std::vector<FeedResult> results(Depth depth = Depth::kLive,
                                                const std::function<void()>& meanwhile = {}) const;

  /// As Analysis::simulateReferences().
  void simulateReferences() { analysis_.simulateReferences(); }

  /// Sets the time of the messages that is 0 s in the analysis, unless it is set. The first message
  /// does so.
  void anchor(std::int64_t utime);

  /// The time of the analysis (s) for a time of the messages.
  [[nodiscard]] double seconds(std::int64_t utime) const;

  /// Time of the last frame taken [us since 1970]; 0: none yet.
  [[nodiscard]] std::int64_t lastFrameUtime() const { return last_frame_utime_; }

  /// States of robots that are later than the message they are in, which are not used; and the
  /// reason for the first one.
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  [[nodiscard]] const std::string& refusal() const { return refusal_; }

  [[nodiscard]] const AnalysisCounters& counters() const { return analysis_.counters(); }
  [[nodiscard]] std::vector<int> robots() const { return analysis_.robots(); }
  [[nodiscard]] StitcherCounters robotCounters(int robot) const {
    return analysis_.robotCounters(robot);
  }

 private:
  /// The boots of one robot; its own counters are reset by each.
  struct Boots {
    std::string sender;
    std::int64_t instance = 0;
    std::int64_t last_utime = 0;
    std::int32_t last_epoch = 0;
    std::int64_t number = 0;
  };

  void define(const Program& program);
  [[nodiscard]] const ProgramLaw& lawOfProgram(const program_id_t& program);
  [[nodiscard]] program_id_t idOf(const ProgramLaw& law) const;
  [[nodiscard]] RobotTelemetry telemetry(const robot_state_t& state, std::int64_t boot) const;
  std::int64_t bootOf(const robot_status_t& status, const robot_state_t& state);

  RobotBody body_;
  std::set<std::int32_t> replayed_robots_;  ///< excluded, because their motion was analyzed in the
                                            ///< run that is replayed
  Analysis analysis_;
  ProgramKeys program_keys_;
  std::map<std::int64_t, Program> definitions_;  ///< by hash
  std::map<std::int64_t, ProgramLaw> laws_;      ///< by hash, of the programs that ran
  std::map<std::int32_t, Boots> boots_;
  Frame frame_;  ///< kept to reuse its memory
  std::int64_t refused_ = 0;
  std::string refusal_;
  std::int64_t origin_utime_ = 0;
  std::int64_t last_frame_utime_ = 0;
};

}  // namespace lab::analysis
