#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "analyzer/laws/law_of.hpp"
#include "analyzer/laws/paper_figures.hpp"
#include "analyzer/report_error.hpp"
#include "common/experiment/experiment_file.hpp"

namespace lab::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> idsOf(const std::vector<PaperPanel>& panels) {
  std::vector<std::string> ids;
  for (const PaperPanel& panel : panels) ids.push_back(panel.id);
  return ids;
}

const PaperPanel& panel(const std::string& id) {
  for (const PaperPanel& one : paperPanels()) {
    if (one.id == id) return one;
  }
  throw std::out_of_range(id);
}

std::set<double> values(const std::vector<std::string>& ids, const std::string& key) {
  std::set<double> all;
  for (const std::string& id : ids) all.insert(paperSet(id).law->parameter(key));
  return all;
}

TEST(ReproductionPlan, HasEveryPanelOfTheFigures) {
  EXPECT_THAT(idsOf(paperPanels()), ElementsAre("2a", "2b", "2c", "2d", "2e", "3a", "3b", "3c",
                                                "3d", "4b", "4c", "4d", "4e"));
}

TEST(ReproductionPlan, HasTheParametersOfThePaper) {
  const analysis::ProgramLaw& b2 = paperSet(panel("2b").curves.at(0)).law;
  EXPECT_DOUBLE_EQ(b2->parameter("v"), 0.03);
  EXPECT_DOUBLE_EQ(b2->parameter("epsilon"), 0.5);
  EXPECT_DOUBLE_EQ(b2->parameter("eta"), 3);
  EXPECT_EQ(panel("2a").curves, panel("2b").curves);
  EXPECT_EQ(values(panel("2c").points, "eta"), (std::set<double>{3}));
  EXPECT_EQ(values(panel("2d").points, "epsilon"), (std::set<double>{0.25}));
  EXPECT_EQ(values(panel("2e").curves, "epsilon"), (std::set<double>{0.25}));

  const analysis::ProgramLaw& b3 = paperSet(panel("3b").curves.at(0)).law;
  EXPECT_EQ(b3->name(), "noisy_abp");
  EXPECT_DOUBLE_EQ(b3->parameter("va"), 0.01);
  EXPECT_DOUBLE_EQ(b3->parameter("V"), 0.10);
  EXPECT_DOUBLE_EQ(b3->parameter("epsilon"), 0.1);
  const analysis::ProgramLaw& c3 = paperSet(panel("3c").curves.at(0)).law;
  EXPECT_EQ(c3->name(), "bp");
  EXPECT_DOUBLE_EQ(c3->parameter("V"), 0.07);
  EXPECT_DOUBLE_EQ(c3->parameter("epsilon"), 0.2);
  EXPECT_EQ(values(panel("3d").curves, "epsilon"), (std::set<double>{0.2}));

  const PaperSet& b4 = paperSet(panel("4b").curves.at(0));
  EXPECT_TRUE(b4.short_recording);
  EXPECT_DOUBLE_EQ(b4.law->parameter("v"), 0.05);
  EXPECT_DOUBLE_EQ(b4.law->parameter("gamma"), 3);
  EXPECT_DOUBLE_EQ(b4.law->parameter("tau_t"), 0.5);
  EXPECT_EQ(panel("4c").curves, panel("4b").curves);
  EXPECT_EQ(values(panel("4d").curves, "tau_t"), (std::set<double>{0.5}));
  EXPECT_EQ(values(panel("4e").curves, "gamma"), (std::set<double>{1}));
}

TEST(ReproductionPlan, NamesChosenParameters) {
  EXPECT_EQ(values(panel("2c").curves, "epsilon"), (std::set<double>{0.1, 0.5, 0.9}));
  EXPECT_EQ(values(panel("2c").points, "epsilon"), (std::set<double>{0.1, 0.25, 0.5, 0.7, 0.9}));
  EXPECT_EQ(values(panel("2d").curves, "eta"), (std::set<double>{1, 3, 6}));
  EXPECT_EQ(values(panel("2e").curves, "eta"), (std::set<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(panel("3d").points.size(), 9U);
  EXPECT_EQ(values(panel("4d").curves, "gamma"), (std::set<double>{0.5, 1, 2, 3}));
  EXPECT_EQ(values(panel("4e").curves, "tau_t"), (std::set<double>{0.5, 1, 2}));
  for (const char* id : {"2c", "2d", "2e", "3d", "4d", "4e"}) {
    EXPECT_FALSE(panel(id).chosen.empty()) << id;
  }
  for (const char* id : {"2a", "2b", "3a", "3b", "3c", "4b", "4c"}) {
    EXPECT_TRUE(panel(id).chosen.empty()) << id;
  }
}

TEST(ReproductionPlan, RecordsEachSetOnce) {
  std::set<std::string> ids;
  for (const PaperSet& set : paperSets()) EXPECT_TRUE(ids.insert(set.id).second) << set.id;
  EXPECT_EQ(setsOf(paperPanels()).size(), paperSets().size()) << "a set that no panel shows";
  EXPECT_EQ(setsOf(choosePanels("2a,2b")).size(), 1U);
}

TEST(ReproductionPlan, MakesValidExperimentsWithDistinctSeeds) {
  std::set<std::uint64_t> seeds;
  for (const PaperSet& set : paperSets()) {
    for (const bool firmware : {false, true}) {
      const RecordingOptions options{.hours = 0.5, .seed = 7, .through_firmware = firmware};
      const Experiment dut = parseExperiment(experimentText(set, options), set.id);

      const auto programs = dut.programs;
      ASSERT_EQ(programs.size(), 1U);
      const auto law = analysis::lawOf(programs.begin()->second, dut.hardware.diameter);
      EXPECT_EQ(law->name(), set.law->name());
      ASSERT_EQ(law->parameters().size(), set.law->parameters().size());
      for (const analysis::LawParameter& one : set.law->parameters()) {
        EXPECT_DOUBLE_EQ(law->parameter(one.name), one.value) << set.id << " " << one.name;
      }
      EXPECT_DOUBLE_EQ(dut.duration, set.short_recording ? 180 : 1800);
      EXPECT_GE(dut.camera.fps, 50);
      EXPECT_GT(dut.camera.position_noise, 0);
      EXPECT_DOUBLE_EQ(dut.reversal.distance, 0.40);
      EXPECT_EQ(dut.robots.at(0).body, firmware ? Body::kFirmware : Body::kSim);
      if (!firmware) {
        EXPECT_TRUE(seeds.insert(dut.seed).second);
      }
    }
    const RecordingOptions second{.seed = 7, .member = 1};
    EXPECT_TRUE(seeds.insert(parseExperiment(experimentText(set, second), set.id).seed).second);
  }
}

TEST(ReproductionPlan, SelectsPanelsAndCompleteFigures) {
  EXPECT_THAT(idsOf(choosePanels("3d, 2b")), ElementsAre("2b", "3d"));
  EXPECT_THAT(idsOf(choosePanels("4")), ElementsAre("4b", "4c", "4d", "4e"));
  EXPECT_THAT(idsOf(choosePanels("fig3")), ElementsAre("3a", "3b", "3c", "3d"));
  EXPECT_EQ(choosePanels("").size(), paperPanels().size());
}

TEST(ReproductionPlan, ErrorNamesUnknownPanels) {
  for (const char* wrong : {"5", "2b,", "4a", "b", "2bb"}) {
    try {
      static_cast<void>(choosePanels(wrong));
      FAIL() << wrong;
    } catch (const ReportError& error) {
      EXPECT_THAT(error.what(), HasSubstr("allowed a list of 2a, 2b")) << wrong;
    }
  }
}

}  // namespace
}  // namespace lab::report
