#include "analyzer/analyze_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <functional>
#include <ostream>
#include <set>
#include <string>
#include <string_view>

#include "analyzer/report/figures/figures.hpp"
#include "analyzer/report/html/report_page.hpp"
#include "analyzer/report/record/run_record.hpp"
#include "analyzer/report/sections/segments.hpp"
#include "analyzer/report/summary/diffusion_sentence.hpp"
#include "analyzer/report/summary/findings.hpp"
#include "analyzer/report/summary/summary.hpp"
#include "analyzer/report/summary/trajectories.hpp"
#include "analyzer/report_error.hpp"
#include "common/files/experiment_error.hpp"
#include "common/files/output_links.hpp"
#include "common/files/scratch_folder.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace fs = std::filesystem;
namespace {

void writeBy(const fs::path& file, const std::function<void(std::ostream&)>& writer) {
  std::ofstream stream(file, std::ios::binary);
  writer(stream);
  stream.flush();
  if (!stream) {
    throw ReportError(fmt::format("cannot write {}: is the disk full?", file.filename().string()));
  }
}

void write(const fs::path& file, const std::string& text) {
  writeBy(file, [&](std::ostream& stream) {
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  });
}

/// The error for a log without frames, with the streams it has.
std::string withoutFrames(const fs::path& log, const RunRecord& record) {
  std::string found;
  for (const StreamLoss& stream : record.log.streams) {
    found += fmt::format("{}{} {} from {}", found.empty() ? "" : ", ", stream.received,
                         stream.channel, stream.sender);
  }
  return fmt::format("{}: no TRACKED_FRAME in this log, so there is no motion to analyze; found {}",
                     log.string(), found.empty() ? "nothing of the lab" : found);
}

fs::path outputFolder(const fs::path& run_or_log, const fs::path& wanted) {
  if (!wanted.empty()) return wanted;
  if (fs::is_directory(run_or_log)) return run_or_log;
  return run_or_log.has_parent_path() ? run_or_log.parent_path() : fs::path(".");
}

/// Renaming replaces links that stand where files are written.
void refuseLink(const fs::path& folder) {
  if (const std::string problem = explainLink(folder); !problem.empty()) throw ReportError(problem);
}

/// The facts of the films of a run. A film whose facts are damaged is left out.
std::vector<FilmFacts> filmsOf(const fs::path& run) {
  std::vector<FilmFacts> films;
  for (const fs::path& folder : filmFolders(run)) {
    try {
      films.push_back(readFilmFacts(folder / film_files::kFacts));
    } catch (const ExperimentError&) {
      continue;
    }
  }
  return films;
}

/// @throws ReportError if a duration that fits shall free belongs to no program of the run
void requireTimes(const RunRecord& record, const AnalyzeOptions& options, const fs::path& input) {
  std::set<std::string> known;
  for (const analysis::FeedResult& result : record.results) {
    for (const analysis::FitParameter& time : result.result.law->fitTimes())
      known.insert(time.name);
  }
  for (const std::string& name : options.free_times) {
    if (known.contains(name)) continue;
    throw ReportError(
        known.empty()
            ? fmt::format("{}: found --free {}, but no program of it has a law with such a time; "
                          "leave --free out",
                          input.string(), name)
            : fmt::format("{}: found --free {}, expected {}: the laws of its programs have no "
                          "other time",
                          input.string(), name, fmt::join(known, " or ")));
  }
}

/// Writes all files of a record, each completely or not at all.
AnalyzedRun writeResults(const RunRecord& record, const fs::path& out, bool with_figures) {
  const ScratchFolder scratch(makeFolderIn(out, ".report"));
  std::vector<Figure> figures;
  if (with_figures) figures = drawFigures(record, scratch.path());

  const fs::path for_paper = "figures";
  refuseLink(out / for_paper);
  std::vector<std::string> names{"summary.json", "trajectories.csv", "segments.csv"};
  write(scratch.path() / "summary.json", summaryJson(record));
  writeBy(scratch.path() / "trajectories.csv",
          [&](std::ostream& stream) { writeTrajectories(record, stream); });
  write(scratch.path() / "segments.csv", segmentsCsv(record));
  for (const Figure& figure : figures) {
    if (figure.svg.empty()) continue;
    names.push_back(figure.name + ".svg");
    write(scratch.path() / names.back(), figure.svg);
    fs::create_directories(scratch.path() / for_paper);
    fs::create_directories(out / for_paper);
    names.push_back(for_paper / (figure.name + ".pdf"));
    write(scratch.path() / names.back(), figure.pdf);
    if (figure.csv.empty()) continue;
    names.push_back(for_paper / (figure.name + ".csv"));
    write(scratch.path() / names.back(), figure.csv);
  }
  names.emplace_back("report.html");
  write(scratch.path() / "report.html", reportHtml(record, figures));

  AnalyzedRun analyzed;
  for (const std::string& name : names) {
    fs::rename(scratch.path() / name, out / name);
    analyzed.files.push_back(out / name);
  }
  analyzed.report = out / "report.html";
  analyzed.headline = headlines(record);
  const std::string diffusion = diffusionSentence(record);
  if (!diffusion.empty()) analyzed.headline.push_back(diffusion);
  return analyzed;
}

}  // namespace

fs::path makeFolderIn(const fs::path& out, std::string_view name) {
  fs::path made = makeUniqueFolder(out, name);
  if (!made.empty()) return made;
  throw ReportError(fmt::format(
      "{}: cannot write here; choose another folder with --out or change its permissions",
      out.string()));
}

AnalyzedRun analyzeRun(const fs::path& run_or_log, const fs::path& out_directory,
                       const AnalyzeOptions& options) {
  const std::vector<fs::path> files = logFiles(run_or_log);
  RunRecord record = readRun(files, {options.depth, options.stitch, options.free_times});
  requireTimes(record, options, run_or_log);
  if (fs::is_directory(run_or_log)) record.films = filmsOf(run_or_log);
  if (!options.film.empty()) record.films = filmsOf(options.film);
  record.film_note = options.film_note;
  const fs::path shown = outputFolder(run_or_log, out_directory);
  record.film_stills = !record.films.empty() && fs::exists(shown / "film.jpg");
  record.film_clip = !record.films.empty() && fs::exists(shown / "film.mp4");
  if (record.log.frames == 0 && options.needs_frames) {
    throw ReportError(withoutFrames(files.front(), record));
  }
  return writeResults(record, outputFolder(run_or_log, out_directory), options.figures);
}

AnalyzedRun analyzePoses(const fs::path& file, const fs::path& out_directory,
                         const PoseFileOptions& poses, const PoseProgram& program,
                         const AnalyzeOptions& options) {
  const RunRecord record = poseRun(readPoses(file, poses), file.stem().string(), program,
                                   {options.depth, options.stitch, options.free_times});
  requireTimes(record, options, file);
  return writeResults(record, out_directory, options.figures);
}

}  // namespace lab::report
