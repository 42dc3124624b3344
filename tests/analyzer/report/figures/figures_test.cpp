#include "analyzer/report/figures/figures.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <qpdf/Buffer.hh>
#include <qpdf/QPDF.hh>
#include <qpdf/QPDFObjectHandle.hh>
#include <qpdf/QPDFWriter.hh>
#include <sstream>
#include <string>
#include <thread>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/gnuplot.hpp"
#include "analyzer/report/figures/thinning.hpp"
#include "analyzer/report/figures/undated_pdf.hpp"
#include "analyzer/report_error.hpp"
#include "tests/analyzer/report/synthetic_lab.hpp"

namespace lab::report::figures_test {
namespace {

using testing::HasSubstr;
using testing::Not;

RunRecord recordOf(const Experiment& experiment) {
  const TemporaryFolder folder;
  SyntheticLab(folder.path() / "log.lcmlog", experiment).run();
  return readRun(logFiles(folder.path()));
}

std::size_t pointsOf(const PlotTracks& plot) {
  std::size_t points = 0;
  for (const PlotLine& line : plot.lines) points += line.points.size();
  return points;
}

TEST(Figures, GiveASentenceIfThereIsNothingToDraw) {
  const TemporaryFolder scratch;

  for (const Figure& figure : drawFigures({}, scratch.path())) {
    EXPECT_FALSE(figure.sentence.empty()) << figure.name;
    EXPECT_TRUE(figure.svg.empty()) << figure.name;
  }
}

TEST(Figures, StaySmallForALongRun) {
  const TemporaryFolder scratch;
  const RunRecord record = recordOf(syntheticExperiment(10, 300, 20, {paperAbp(), paperRtp()}, 30));

  for (const Figure& figure : drawFigures(record, scratch.path())) {
    EXPECT_THAT(figure.svg, HasSubstr("<svg")) << figure.name;
    EXPECT_LT(figure.svg.size(), 160'000U) << figure.name;
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

TEST(Figures, HaveReproduciblePdfs) {
  const TemporaryFolder scratch;
  const RunRecord record = recordOf(syntheticExperiment(1, 30, 20, {paperAbp()}, 30));

  const std::vector<Figure> first = drawFigures(record, scratch.path());
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // another second, another date
  const std::vector<Figure> again = drawFigures(record, scratch.path());

  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_THAT(first[i].pdf, testing::StartsWith("%PDF")) << first[i].name;
    EXPECT_TRUE(first[i].pdf == again[i].pdf) << first[i].name;
    EXPECT_EQ(first[i].pdf.find("CreationDate"), std::string::npos) << first[i].name;
  }
}

/// A PDF whose objects are compressed together, as cairo 1.18 writes them.
std::string compressedPdf(const std::string& date) {
  QPDF pdf;
  pdf.emptyPDF();
  const auto info = QPDFObjectHandle::newDictionary();
  pdf.getTrailer().replaceKey("/Info", pdf.makeIndirectObject(info));
  pdf.getTrailer().getKey("/Info").replaceKey("/CreationDate", QPDFObjectHandle::newString(date));
  QPDFWriter writer(pdf);
  writer.setOutputMemory();
  writer.setObjectStreamMode(qpdf_o_generate);
  writer.setStaticID(true);
  writer.write();
  const std::shared_ptr<Buffer> bytes = writer.getBufferSharedPointer();
  return std::string(reinterpret_cast<const char*>(bytes->getBuffer()), bytes->getSize());
}

TEST(UndatedPdf, HasNoDateThatWasCompressed) {
  const std::string one = compressedPdf("D:20261124155047Z");
  const std::string other = compressedPdf("D:19990101000000Z");
  ASSERT_EQ(one.find("CreationDate"), std::string::npos) << "not compressed";
  ASSERT_NE(one, other);

  EXPECT_EQ(undatedPdf(one), undatedPdf(other));
}

TEST(UndatedPdf, RefusesAnIncompleteFile) {
  const std::string whole = compressedPdf("D:20261124155047Z");

  EXPECT_THROW(static_cast<void>(undatedPdf(whole.substr(0, whole.size() / 2))), ReportError);
}

/// Width of a PDF's page [cm].
double widthOf(const std::string& pdf) {
  const std::size_t at = pdf.find("/MediaBox [ 0 0 ");
  return at == std::string::npos ? 0 : std::stod(pdf.substr(at + 16)) / 72 * 2.54;
}

TEST(Figures, HaveTheWidthsOfAJournal) {
  const TemporaryFolder scratch;
  const RunRecord record = recordOf(syntheticExperiment(1, 30, 20, {paperAbp()}, 30));

  for (const Figure& figure : drawFigures(record, scratch.path())) {
    const bool curve = figure.name.find("msd") != std::string::npos;
    EXPECT_NEAR(widthOf(figure.pdf), curve ? 8.6 : 17.8, 0.05) << figure.name;
  }
}

TEST(Figures, HaveTheirDataWithUnits) {
  const TemporaryFolder scratch;
  const RunRecord record = recordOf(syntheticExperiment(1, 60, 20, {paperAbp()}, 60));
  const auto& points = record.results.at(0).result.curves.msd;

  for (const Figure& figure : drawFigures(record, scratch.path())) {
    ASSERT_FALSE(figure.csv.empty()) << figure.name;
    if (figure.name != "msd_abp") continue;
    std::istringstream csv(figure.csv);
    std::string line;
    std::getline(csv, line);
    EXPECT_EQ(line,
              "lag_s,value_cm2,standard_error_cm2,noise_cm2,exact_cm2,paper_cm2,z,windows,"
              "judged");
    std::getline(csv, line);
    EXPECT_THAT(line, testing::StartsWith(fmt::format("{:.7g},{:.7g},", points.at(0).tau,
                                                      points.at(0).value * 1e4)));
  }
}

TEST(Figures, ShowTheMsdOfSeveralProgramsInOnePicture) {
  const TemporaryFolder scratch;
  const RunRecord record = recordOf(syntheticExperiment(2, 60, 20, {paperAbp(), paperRtp()}, 15));

  const std::vector<Figure> figures = drawFigures(record, scratch.path());

  const auto msd = std::find_if(figures.begin(), figures.end(),
                                [](const Figure& figure) { return figure.name == "msd"; });
  ASSERT_NE(msd, figures.end());
  EXPECT_THAT(msd->svg, HasSubstr("<svg"));
  EXPECT_THAT(msd->csv, HasSubstr("\nabp,"));
  EXPECT_THAT(msd->csv, HasSubstr("\nrtp,"));
}

TEST(Figures, ShowEveryRobotOfASmallLab) {
  const TemporaryFolder scratch;
  const RunRecord record = recordOf(syntheticExperiment(6, 90, 50, {paperAbp(), paperRtp()}, 30));

  for (const Figure& figure : drawFigures(record, scratch.path())) {
    if (figure.name != "trajectory_program" && figure.name != "speed") continue;
    EXPECT_THAT(figure.caption, Not(HasSubstr("legible"))) << figure.name;
    for (int robot = 1; robot <= 6; ++robot) {
      const std::string id = std::to_string(robot) + ",";
      const bool drawn = figure.csv.find("\n" + id) != std::string::npos ||
                         figure.csv.find("abp," + id) != std::string::npos;
      EXPECT_TRUE(drawn) << figure.name << " " << robot;
    }
  }
}

TEST(Figures, QuoteTextInTheirData) {
  CsvText dut("name,value_cm,judged");
  dut.row("a \"b\", c", 1.5, true);
  dut.row("x", std::nan(""), false);
  dut.row("=A1", -2, false);  // a spreadsheet would compute it
  dut.row("=A1,\r2", -2, false);

  EXPECT_EQ(dut.text(),
            "name,value_cm,judged\n\"a \"\"b\"\", c\",1.5,1\nx,,0\n'=A1,-2,0\n\"'=A1, 2\",-2,0\n");
}

TEST(Figures, RemoveMarkupFromNames) {
  const TemporaryFolder scratch;
  RunRecord record = recordOf(syntheticExperiment(1, 20, 20, {paperAbp()}, 30));
  record.programs[0].name = "a_b <script> 'x' & \\n $y";

  for (const Figure& figure : drawFigures(record, scratch.path())) {
    EXPECT_THAT(figure.svg, Not(HasSubstr("<script"))) << figure.name;
  }
}

TEST(Thinning, DrawsTheWholeOfAShortRun) {
  const PlotTracks dut =
      thinnedTracks(recordOf(syntheticExperiment(1, 30, 20, {paperAbp()}, 30)), 4000, false);

  EXPECT_TRUE(dut.whole_run);
  EXPECT_GE(pointsOf(dut), 600U);
  EXPECT_NEAR(dut.end - dut.begin, 30, 0.1);
}

TEST(Thinning, DrawsTheLatestStretchOfALongRun) {
  const PlotTracks dut =
      thinnedTracks(recordOf(syntheticExperiment(4, 200, 10, {paperAbp()}, 30)), 300, false);

  EXPECT_FALSE(dut.whole_run);
  EXPECT_NEAR(dut.end, 200, 1);
  EXPECT_GT(dut.begin, 100);
  EXPECT_LE(pointsOf(dut), 340U);
}

TEST(Thinning, KeepsPointsForEveryProgram) {
  const RunRecord record = recordOf(syntheticExperiment(1, 200, 10, {paperAbp(), paperRtp()}, 100));

  const PlotTracks dut = thinnedTracks(record, 200, true);

  std::size_t points[2] = {0, 0};
  for (const PlotLine& line : dut.lines) {
    if (line.program >= 0) points[line.program] += line.points.size();
  }
  EXPECT_GT(points[0], 90U);
  EXPECT_GT(points[1], 90U);
}

TEST(Gnuplot, ReportsErrorsOfTheScript) {
  const TemporaryFolder scratch;

  EXPECT_THROW(runGnuplot(scratch.path(), "plot nonsense nonsense\n"), ReportError);
}

TEST(Gnuplot, QuotesTextOnOneLineWithoutMarkup) {
  EXPECT_EQ(gnuplotText("a'b\n<c>&"), "'a’b ‹c›+'");
}

TEST(Gnuplot, ExecutesNothingOfAText) {
  const TemporaryFolder scratch;
  std::string names;
  for (const char* name : {"`touch ran`", "'.system('touch ran').'", "\"; system('touch ran') #",
                           "'\nsystem 'touch ran'\n'", "\\'; !touch ran", "@touch"}) {
    names += (names.empty() ? "plot " : ", ") + std::string("1 title ") + gnuplotText(name);
  }

  runGnuplot(scratch.path(), "set terminal svg\nset output 'a.svg'\n" + names + "\n");

  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "a.svg"));
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "ran"));
}

TEST(Gnuplot, DrawsInFoldersOfAnyName) {
  const TemporaryFolder parent;
  const std::filesystem::path folder = parent.path() / "Rita's <runs> & `touch ran`";
  std::filesystem::create_directory(folder);

  FigureScript script;
  script.figure.name = "a";
  script.script = "eval open_figure('a', 300, 200, 8)\nplot x\n";

  const std::vector<Figure> dut = drawScripts({script}, folder);

  ASSERT_EQ(dut.size(), 1U);
  EXPECT_THAT(dut[0].svg, testing::HasSubstr("<svg"));
}

TEST(Gnuplot, MakesIdsOfSeveralFiguresDifferent) {
  const std::string dut =
      inlineSvg("<?xml?>\n<svg><g id=\"a\"/><use xlink:href='#a'/></svg>", "f1_");

  EXPECT_EQ(dut, "<svg role=\"img\"><g id=\"f1_a\"/><use xlink:href='#f1_a'/></svg>");
}

}  // namespace
}  // namespace lab::report::figures_test
