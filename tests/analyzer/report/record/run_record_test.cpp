#include "analyzer/report/record/run_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <lab/robot_stop_t.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "analyzer/report/html/report_page.hpp"
#include "analyzer/report/record/event_record.hpp"
#include "analyzer/report/summary/summary.hpp"
#include "analyzer/report_error.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/message_header.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/process/version.hpp"
#include "tests/analyzer/report/synthetic_lab.hpp"

namespace lab::report {
namespace {

using testing::HasSubstr;

class RunRecordTest : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path log() const { return folder_.path() / "log.lcmlog"; }
  [[nodiscard]] RunRecord read() const { return readRun(logFiles(log())); }
  [[nodiscard]] std::string problem() const {
    try {
      static_cast<void>(read());
    } catch (const ReportError& error) {
      return error.what();
    }
    return "none";
  }

  TemporaryFolder folder_;
  Experiment experiment_ =
      syntheticExperiment(2, 20, 20, {paperAbp(), paperRtp()}, 5);  // 4 steps of light
};

StreamLoss streamOf(const RunRecord& record, const std::string& sender, std::string_view channel,
                    int start = 1) {
  for (const StreamLoss& loss : record.log.streams) {
    if (loss.sender == sender && loss.channel == channel && loss.start == start) return loss;
  }
  ADD_FAILURE() << "no stream " << channel << " of " << sender;
  return {};
}

TEST_F(RunRecordTest, ColoursProgramsByNameAsTheDashboardDoes) {
  experiment_ = syntheticExperiment(2, 20, 20, {paperRtp(), paperAbp()}, 5);  // rtp runs first
  SyntheticLab(log(), experiment_).run();

  const RunRecord dut = read();

  ASSERT_EQ(dut.programs.size(), 2U);
  EXPECT_EQ(dut.programs[0].name, "rtp");
  EXPECT_EQ(dut.programs[0].colour, "#D55E00");
  EXPECT_EQ(dut.programs[1].colour, "#0072B2");
}

TEST_F(RunRecordTest, DescribesAnUndisturbedRun) {
  SyntheticLab(log(), experiment_).run();

  const RunRecord dut = read();

  ASSERT_TRUE(dut.experiment.has_value()) << dut.experiment_problem;
  EXPECT_EQ(dut.experiment->seed, experiment_.seed);
  EXPECT_TRUE(dut.ended);
  EXPECT_NEAR(dut.duration(), 20, 1e-6);
  EXPECT_EQ(dut.log.frames, 400);
  EXPECT_EQ(dut.tracks.rows.size(), 800U);
  EXPECT_EQ(dut.missing_frames, 0);
  ASSERT_EQ(dut.steps.size(), 4U);  // each was sent three times
  EXPECT_EQ(dut.steps[1].label, "light for rtp");
  EXPECT_EQ(dut.steps[1].presented_utime - dut.steps[1].commanded_utime, 17'000);
  ASSERT_EQ(dut.light.size(), 4U);
  EXPECT_DOUBLE_EQ(dut.light[1].low, 0.75);
  EXPECT_TRUE(dut.light[1].uniform);
  ASSERT_EQ(dut.programs.size(), 2U);
  EXPECT_EQ(dut.programs[0].name, "abp");
  EXPECT_TRUE(dut.log.virtual_time);
  for (const StreamLoss& loss : dut.log.streams) {
    EXPECT_EQ(loss.lost, 0) << loss.channel << " of " << loss.sender;
    EXPECT_FALSE(loss.at_least) << loss.channel << " of " << loss.sender;
  }
}

TEST_F(RunRecordTest, HasTheProgramsOfEveryRobotOverTime) {
  SyntheticLab(log(), experiment_).run();

  const RunRecord dut = read();

  ASSERT_EQ(dut.robots.size(), 2U);
  std::vector<int> programs;
  for (const ProgramSpan& span : dut.robots.at(1).programs) {
    if (span.program >= 0) programs.push_back(span.program);
  }
  EXPECT_THAT(programs, testing::ElementsAre(0, 1, 0, 1));
  // 10 s after the start: the third step, as in every row.
  for (std::size_t i = 0; i < dut.tracks.frames.size(); ++i) {
    const double t = dut.seconds(dut.tracks.frames[i].utime);
    if (t < 10.1 || t > 14.9) continue;
    EXPECT_EQ(dut.tracks.rows[dut.tracks.frames[i].first_row].program, 0) << t;
  }
}

TEST_F(RunRecordTest, CountsMissedMessagesExactly) {
  std::int64_t frames_lost = 0;
  std::int64_t statuses_lost = 0;
  SyntheticLab(log(), experiment_, [&](const Packet& packet) {
    const auto header = peekHeader(packet.data);
    // The first, some in the middle, and the last ones, which leave no gap.
    const bool lose_frame = packet.channel == channels::kTrackedFrame &&
                            (header->seq == 1 || header->seq % 50 == 7 || header->seq > 397);
    // Four of the five closing messages of sim_svc: 21 beats and one of READY come before.
    const bool lose_status = packet.channel == channels::kServiceStatus &&
                             header->sender == "sim_svc" && header->seq > 23;
    frames_lost += lose_frame ? 1 : 0;
    statuses_lost += lose_status ? 1 : 0;
    return !lose_frame && !lose_status;
  }).run();

  const RunRecord dut = read();

  ASSERT_GT(frames_lost, 8);
  ASSERT_GT(statuses_lost, 0);
  EXPECT_EQ(streamOf(dut, "sim_svc", channels::kTrackedFrame).lost, frames_lost);
  EXPECT_EQ(streamOf(dut, "sim_svc", channels::kServiceStatus).lost, statuses_lost);
  EXPECT_FALSE(streamOf(dut, "sim_svc", channels::kTrackedFrame).at_least);
  EXPECT_EQ(streamOf(dut, "sim_svc", channels::kRobotStatus).lost, 0);
}

TEST_F(RunRecordTest, CutsTracksAndSeparatesCountsAtARestart) {
  {
    SyntheticLab lab(log(), experiment_);
    lab.begin();
    lab.runUntil(8.02);
    lab.restartSimulation();
    lab.runUntil(20);
    lab.end();
  }

  const RunRecord dut = read();

  EXPECT_TRUE(streamOf(dut, "sim_svc", channels::kTrackedFrame, 1).at_least);
  EXPECT_FALSE(streamOf(dut, "sim_svc", channels::kTrackedFrame, 2).at_least);
  EXPECT_EQ(streamOf(dut, "sim_svc", channels::kTrackedFrame, 1).received +
                streamOf(dut, "sim_svc", channels::kTrackedFrame, 2).received,
            400);
  EXPECT_EQ(dut.robots.at(1).boots, 2);
  EXPECT_EQ(dut.missing_frames, 0);
  // No piece of free motion spans the restart, at which robots have other positions.
  std::int32_t before = -1;
  std::int32_t after = -1;
  for (std::size_t i = 0; i < dut.tracks.frames.size(); ++i) {
    const TrackRow& row = dut.tracks.rows[dut.tracks.frames[i].first_row];
    if (row.segment < 0) continue;
    (dut.seconds(dut.tracks.frames[i].utime) < 8.02 ? before : after) = row.segment;
    if (after >= 0) break;
  }
  EXPECT_GE(before, 0);
  EXPECT_GT(after, before);
}

TEST_F(RunRecordTest, HasEachFaultAndMarkOnce) {
  {
    SyntheticLab lab(log(), experiment_);
    lab.begin();
    lab.runUntil(3);
    lab.fault("sim_svc died");
    lab.mark("door opened");
    lab.runUntil(20);
    lab.end();
  }

  const RunRecord dut = read();

  ASSERT_EQ(dut.faults.size(), 1U);
  EXPECT_EQ(dut.faults[0].text, "sim_svc died");
  EXPECT_NEAR(dut.seconds(dut.faults[0].utime), 3, 1e-6);
  ASSERT_EQ(dut.marks.size(), 1U);
}

/// A script that marks every second reaches the limit of marks in hours.
// Also without losses: the line says which programs the robot loaded, and how long it took.
TEST(ServiceRecords, KeepsEverySerialLine) {
  service_status_t status{};
  status.sender = "robot_bridge";
  status.instance = 5;
  stream_count_t line{};
  line.channel = "serial line";
  line.sender =
      "robot 3 (0 restarts, 1 commands sent again, 0 given up, 2 programs loaded in 0.8 s)";
  line.received = 1200;
  status.received.push_back(line);
  status.num_received = 1;
  ServiceRecords dut;
  dut.take(status);
  RunRecord record;
  dut.finish(record);

  ASSERT_EQ(record.serial_lines.size(), 1U);
  EXPECT_TRUE(record.listeners.empty());
  EXPECT_EQ(record.serial_lines[0].received, 1200);
  EXPECT_THAT(reportHtml(record, {}), testing::HasSubstr("2 programs loaded in 0.8 s"));
  EXPECT_THAT(summaryJson(record), testing::HasSubstr("2 programs loaded in 0.8 s"));
}

TEST(EventRecord, HasFaultsAfterTooManyMarks) {
  EventRecord dut;
  experiment_event_t event{};
  event.kind = experiment_event_t::MARK;
  for (int i = 0; i < 10'005; ++i) {
    event.utime = VirtualLoop::kEpoch + i;
    event.text = std::to_string(i);
    dut.take(event);
  }
  event.kind = experiment_event_t::FAULT;
  event.text = "sim_svc died";
  dut.take(event);
  RunRecord record;
  dut.finish(record);
  ASSERT_EQ(record.faults.size(), 1U);
  EXPECT_EQ(record.faults[0].text, "sim_svc died");
  ASSERT_EQ(record.marks.size(), 10'001U);
  EXPECT_EQ(record.marks.back().text, "5 messages of further marks and faults are not listed");
}

TEST_F(RunRecordTest, CountsLossesOfShellCommandsWhichAreNoServices) {
  {
    bool dropped = false;
    SyntheticLab lab(log(), experiment_, [&](const Packet& packet) {
      return packet.channel != channels::kExperimentCommand || std::exchange(dropped, true);
    });
    lab.begin();
    lab.runUntil(3);
    lab.markByHand("hello");
    lab.runUntil(experiment_.duration);
    lab.end();
  }

  const RunRecord dut = read();

  const StreamLoss wishes = streamOf(dut, "lab_mark", channels::kExperimentCommand);
  EXPECT_EQ(wishes.received, 1);
  EXPECT_EQ(wishes.lost, 1);
  EXPECT_EQ(totalOf(dut.log.streams).lost, 1);
  EXPECT_FALSE(totalOf(dut.log.streams).at_least);
  std::vector<std::string> services;
  for (const ServiceRecord& service : dut.services) services.push_back(service.name);
  EXPECT_THAT(services, testing::ElementsAre("lab", "projector_ctl", "sim_svc"));
}

TEST_F(RunRecordTest, ReportsThatAKilledRunHasNoEnd) {
  {
    SyntheticLab unfinished(log(), experiment_);
    unfinished.begin();
    unfinished.runUntil(12);
  }

  const RunRecord dut = read();

  EXPECT_FALSE(dut.ended);
  EXPECT_NEAR(dut.duration(), 12, 0.1);
  EXPECT_TRUE(streamOf(dut, "sim_svc", channels::kTrackedFrame).at_least);
}

TEST_F(RunRecordTest, ReadsATruncatedAndDamagedLog) {
  SyntheticLab(log(), experiment_).run();
  const std::string whole = readFile(log());
  std::string damaged = whole.substr(0, whole.size() - 11);
  damaged.replace(damaged.size() / 2, 40, 40, 'x');
  std::filesystem::remove(log());
  std::ofstream(log(), std::ios::binary) << damaged;

  const RunRecord dut = read();

  EXPECT_GT(dut.log.frames, 390);
  std::int64_t missing = 0;
  for (const StreamLoss& loss : dut.log.streams) missing += loss.lost;
  for (const auto& [channel, errors] : dut.log.decode_errors) missing += errors;
  EXPECT_GT(missing + dut.log.damaged_places, 0);
}

TEST_F(RunRecordTest, ReadsTheContinuationsOfALog) {
  SyntheticLab(log(), experiment_).run();
  const std::string whole = readFile(log());
  // lcm-logger was restarted: the rest is in a second file.
  const std::string sync = "\xed\xa1\xda\x01";
  const std::size_t cut = whole.find(sync, whole.size() / 2);
  std::ofstream(log(), std::ios::binary) << whole.substr(0, cut);
  std::ofstream(log().string() + ".01", std::ios::binary) << whole.substr(cut);

  const RunRecord dut = read();

  EXPECT_EQ(dut.log.frames, 400);
  for (const StreamLoss& loss : dut.log.streams) EXPECT_EQ(loss.lost, 0);
}

TEST_F(RunRecordTest, RejectsALogOfAnotherContractVersion) {
  {
    LogWriter writer(log());
    experiment_event_t start{};
    start.kind = experiment_event_t::START;
    start.sender = "lab";
    start.contract_version = 7;
    start.version = "9.9.9";
    const auto bytes = encode(start);
    writer.write({channels::kExperimentEvent, bytes, 1'000'000});
  }

  EXPECT_THAT(problem(), HasSubstr("Active Lab 9.9.9 under contract version 7"));
  EXPECT_THAT(problem(), HasSubstr("reads contract versions 1 to 5"));
}

TEST_F(RunRecordTest, ErrorNamesAnUnknownTypeHash) {
  {
    LogWriter writer(log());
    tracked_frame_t frame{};
    frame.sender = "tracker_svc";
    auto bytes = encode(frame);
    bytes[0] ^= 0x55;
    writer.write({channels::kTrackedFrame, bytes, 1'000'000});
  }

  EXPECT_THAT(problem(), HasSubstr("TRACKED_FRAME carries messages of an unknown type (hash "));
}

TEST_F(RunRecordTest, CountsASingleForeignMessageAsDecodeError) {
  {
    LogWriter writer(log());
    tracked_frame_t frame{};
    frame.sender = "sim_svc";
    const auto good = encode(frame);
    auto bad = good;
    bad[0] ^= 0x55;
    const std::vector<std::uint8_t> nonsense{1, 2, 3};
    writer.write({channels::kTrackedFrame, good, 1'000'000});
    writer.write({channels::kTrackedFrame, bad, 1'000'001});
    writer.write({channels::kTrackedFrame, nonsense, 1'000'002});
    writer.write({"SOMETHING_ELSE", nonsense, 1'000'003});
  }

  const RunRecord dut = read();

  EXPECT_EQ(dut.log.decode_errors.at("TRACKED_FRAME"), 2);
  EXPECT_EQ(dut.log.other_channels.at("SOMETHING_ELSE"), 1);
  EXPECT_EQ(dut.log.frames, 1);
}

TEST_F(RunRecordTest, DetectsSpatialLight) {
  experiment_.light.steps[1].layers[0].kind = 3;  // a disk
  experiment_.light.steps[1].layers[0].x = 0.6;
  experiment_.light.steps[1].layers[0].y = 0.45;
  experiment_.light.steps[1].layers[0].size = 0.3;
  SyntheticLab(log(), experiment_).run();

  const RunRecord dut = read();

  ASSERT_GE(dut.light.size(), 2U);
  EXPECT_TRUE(dut.light[0].uniform);
  EXPECT_FALSE(dut.light[1].uniform);
  EXPECT_DOUBLE_EQ(dut.light[1].low, 0);
  EXPECT_DOUBLE_EQ(dut.light[1].high, 0.75);
}

/// Adds forged events to a log, at its beginning and at its end.
TEST_F(RunRecordTest, BelievesOnlyTheRunsOwnRunner) {
  experiment_event_t forged{};
  forged.kind = experiment_event_t::START;
  forged.sender = "forger";
  forged.utime = 1;
  forged.contract_version = 99;
  const std::filesystem::path original = log().string() + ".original";
  SyntheticLab(original, experiment_).run();
  {
    LogWriter writer(log());
    const auto write = [&](std::int8_t kind, std::int64_t utime) {
      forged.kind = kind;
      writer.write({channels::kExperimentEvent, encode(forged), utime});
    };
    std::int64_t last = 0;
    bool first = true;
    static_cast<void>(readLog({original}, [&](const Packet& packet) {
      if (std::exchange(first, false)) write(experiment_event_t::START, packet.received_utime);
      last = packet.received_utime;
      writer.write(packet);
    }));
    write(experiment_event_t::FAULT, last);
    write(experiment_event_t::END, last);
  }

  const RunRecord dut = read();

  EXPECT_TRUE(dut.experiment);
  EXPECT_TRUE(dut.faults.empty());
  EXPECT_NE(dut.end_reason, "");
  ASSERT_TRUE(dut.log.refused.contains("EXPERIMENT_EVENT"));
  EXPECT_EQ(dut.log.refused.at("EXPERIMENT_EVENT").count, 3);
  EXPECT_THAT(dut.log.refused.at("EXPERIMENT_EVENT").first, HasSubstr("from forger: sender"));
}

TEST_F(RunRecordTest, BelievesTheRunnerOfEachRunInALogOfTwo) {
  const std::filesystem::path first = folder_.path() / "first";
  const std::filesystem::path second = folder_.path() / "second";
  for (const std::filesystem::path& one : {first, second}) {
    SyntheticLab lab(one, experiment_);
    lab.begin();
    lab.runUntil(3);
    lab.fault("fault of the " + one.filename().string());
    lab.runUntil(20);
    lab.end();
  }
  for (const bool ends : {true, false}) {
    std::filesystem::remove(log());
    {
      LogWriter writer(log());
      std::int64_t end = 0;
      static_cast<void>(readLog({first}, [&](const Packet& packet) {
        end = packet.received_utime;
        experiment_event_t event{};
        const bool last = packet.channel == channels::kExperimentEvent &&
                          decode(packet.data, event) && event.kind == experiment_event_t::END;
        if (ends || !last) writer.write(packet);
      }));
      const std::int64_t pause = end - VirtualLoop::kEpoch + 10'000'000;
      static_cast<void>(readLog({second}, [&](const Packet& packet) {
        experiment_event_t event{};
        const std::int64_t utime = packet.received_utime + pause;
        if (packet.channel != channels::kExperimentEvent || !decode(packet.data, event)) return;
        event.instance += 1;
        event.utime += pause;
        writer.write({packet.channel, encode(event), utime});
        // Another START within a run is not that of a run.
        if (event.kind != experiment_event_t::FAULT) return;
        event.sender = "forger";
        event.kind = experiment_event_t::START;
        event.contract_version = kContractVersion;
        event.text = writeExperiment(experiment_);
        writer.write({packet.channel, encode(event), utime});
        event.kind = experiment_event_t::FAULT;
        event.text = "forged";
        writer.write({packet.channel, encode(event), utime});
      }));
    }

    const RunRecord dut = read();

    ASSERT_EQ(dut.faults.size(), 2U);
    EXPECT_EQ(dut.faults[0].text, "fault of the first");
    EXPECT_EQ(dut.faults[1].text, "fault of the second");
    EXPECT_GT(dut.log.refused.at("EXPERIMENT_EVENT").count, 0);
  }
}

/// The messages show by themselves that they are of our types.
TEST_F(RunRecordTest, ReadsALogWhoseListOfTypesIsDamaged) {
  const std::filesystem::path original = log().string() + ".original";
  SyntheticLab(original, experiment_).run();
  {
    LogWriter writer(log());
    static_cast<void>(readLog({original}, [&](const Packet& packet) {
      experiment_event_t event{};
      const bool start = packet.channel == channels::kExperimentEvent &&
                         decode(packet.data, event) && event.kind == experiment_event_t::START;
      if (!start) return writer.write(packet);
      event.fingerprints[event.fingerprints.size() / 2] ^= 0x10;
      writer.write({packet.channel, encode(event), packet.received_utime});
    }));
  }

  const RunRecord dut = read();

  EXPECT_EQ(dut.log.frames, 400);
  EXPECT_FALSE(dut.results.empty());
}

TEST_F(RunRecordTest, RemovesOnlyTheRobotWithAnImpossibleNumber) {
  const std::filesystem::path original = log().string() + ".original";
  SyntheticLab(original, experiment_).run();
  {
    LogWriter writer(log());
    static_cast<void>(readLog({original}, [&](const Packet& packet) {
      tracked_frame_t frame{};
      if (packet.channel != channels::kTrackedFrame || !decode(packet.data, frame)) {
        writer.write(packet);
        return;
      }
      frame.robots[0].x = 1e300;
      writer.write({packet.channel, encode(frame), packet.received_utime});
    }));
  }

  const RunRecord dut = read();

  EXPECT_EQ(dut.log.frames, 400);
  EXPECT_EQ(dut.tracks.rows.size(), 400U);
  const RefusedMessages& refused = dut.log.refused.at("TRACKED_FRAME");
  EXPECT_EQ(refused.count, 0);
  EXPECT_EQ(refused.robots, 400);
  EXPECT_THAT(refused.first, HasSubstr("robots[0].x: found 1e+300"));
}

TEST_F(RunRecordTest, CountsAStopWhateverItsHeaderIs) {
  SyntheticLab(log(), experiment_).run();
  {
    LogWriter writer(log().string() + ".01");
    robot_stop_t stop{};
    stop.sender = "panic";
    stop.utime = std::numeric_limits<std::int64_t>::min();
    for (const std::int64_t seq : {stop.utime, -(stop.utime + 1), std::int64_t{-1}}) {
      stop.seq = seq;
      writer.write({channels::kRobotStop, encode(stop), VirtualLoop::kEpoch + 21'000'000});
    }
  }

  const RunRecord dut = read();

  EXPECT_FALSE(dut.log.refused.contains("ROBOT_STOP"));
  EXPECT_EQ(streamOf(dut, "panic", channels::kRobotStop).received, 3);
}

TEST_F(RunRecordTest, ParsesAnExperimentThatIsNoneOnce) {
  // The text takes 0.4 s to parse.
  std::string text = "fileversion = 1\n";
  for (int i = 0; i < 2000; ++i) text += "unknown_" + std::to_string(i) + " = 1\n";
  {
    LogWriter writer(log());
    experiment_event_t start{};
    start.kind = experiment_event_t::START;
    start.sender = "lab";
    start.contract_version = kContractVersion;
    start.text = text;
    const auto bytes = encode(start);
    for (int i = 0; i < 400; ++i) writer.write({channels::kExperimentEvent, bytes, 1'000'000});
  }
  const auto before = std::chrono::steady_clock::now();

  const auto start = findStart(logFiles(log()));

  ASSERT_TRUE(start);
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(30));
}

TEST_F(RunRecordTest, BoundsItsStateUnderForgedSenders) {
  SyntheticLab(log(), experiment_).run();
  {
    LogWriter writer(log().string() + ".01");
    tracked_frame_t frame{};
    frame.utime = 1;
    for (int i = 0; i < 60'000; ++i) {
      frame.sender = "forger" + std::to_string(i);
      writer.write({channels::kTrackedFrame, encode(frame), VirtualLoop::kEpoch + 21'000'000});
    }
  }

  const RunRecord dut = read();

  EXPECT_EQ(dut.log.frames, 400);
  EXPECT_EQ(dut.log.refused.at("TRACKED_FRAME").count, 60'000);
  EXPECT_LE(dut.log.streams.size(), 600U);
  EXPECT_GT(dut.log.foreign_senders, 59'000);
}

}  // namespace
}  // namespace lab::report
