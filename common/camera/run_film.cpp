#include "common/camera/run_film.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/bus/value_checker.hpp"
#include "common/experiment/keys/experiment_keys.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/files/json_section.hpp"

namespace lab {
namespace fs = std::filesystem;
namespace {

constexpr const char* kForm = "active-lab film 1";
constexpr const char* kTableHeader =
    "frame,t_s,number,camera_utime,arrived_utime,searched,status_instance,status_seq";
constexpr const char* kSeveralColumn = ",lost_cameras";
constexpr std::size_t kTableColumns = 8;
constexpr double kLargest = 9e15;  // whole numbers up to here are exact
static_assert(static_cast<double>(kLongestFilm_us) * 1e-6 > keys::kLongestRun);

fs::path filmFolder(const fs::path& run, int number) {
  return run / (number == 1 ? std::string(film_files::kFolder)
                            : fmt::format("{}_{}", film_files::kFolder, number));
}

/// That folder, or those of the cameras in it.
std::vector<fs::path> filmsIn(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / film_files::kFacts, error)) return {folder};
  std::vector<fs::path> films;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (fs::exists(entry.path() / film_files::kFacts, error)) films.push_back(entry.path());
  }
  std::ranges::sort(films);
  return films;
}

template <typename Number>
bool parse(const std::string& cell, Number& value) {
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size();
}

std::size_t columnsOf(FilmTable table) {
  return table == FilmTable::kSeveralCameras ? kTableColumns + 1 : kTableColumns;
}

bool parseLine(const std::string& line, FilmTable table, FilmFrame& frame) {
  std::vector<std::string> cells(columnsOf(table));
  std::istringstream stream(line);
  for (std::string& cell : cells) {
    if (!std::getline(stream, cell, ',')) return false;
  }
  if (cells.size() > kTableColumns && !parse(cells.back(), frame.lost_cameras)) return false;
  std::int64_t searched = 0;
  const bool numbers = parse(cells[0], frame.frame) && parse(cells[1], frame.time) &&
                       parse(cells[2], frame.number) && parse(cells[3], frame.camera_utime) &&
                       parse(cells[4], frame.arrived_utime) && parse(cells[5], searched) &&
                       parse(cells[6], frame.status_instance) && parse(cells[7], frame.status_seq);
  frame.searched = searched != 0;
  return numbers && std::isfinite(frame.time) && stream.eof();
}

/// What is wrong with the times of a frame that comes after these; empty: nothing.
std::string timeProblem(const FilmFrame& frame, std::span<const FilmFrame> before) {
  ValueChecker check;
  check.time("camera_utime", frame.camera_utime);
  check.time("arrived_utime", frame.arrived_utime);
  if (check.problem()) return *check.problem();
  if (before.empty()) return {};
  if (frame.camera_utime <= before.back().camera_utime) {
    return fmt::format("camera_utime: found {} after {}, expected times that increase",
                       frame.camera_utime, before.back().camera_utime);
  }
  // A clock that was set back gives earlier ones.
  if (frame.arrived_utime - before.front().arrived_utime > kLongestFilm_us) {
    return fmt::format("arrived_utime: found {}, expected at most 11 days after the first, {}",
                       frame.arrived_utime, before.front().arrived_utime);
  }
  return {};
}

}  // namespace

fs::path filmTableOf(const fs::path& movie) {
  return movie.parent_path() / (movie.stem().string() + ".frames.csv");
}

std::string filmTableHeader(FilmTable table) {
  return std::string(kTableHeader) + (table == FilmTable::kSeveralCameras ? kSeveralColumn : "") +
         "\n";
}

std::string filmTableLine(const FilmFrame& frame, FilmTable table) {
  const std::string more =
      table == FilmTable::kSeveralCameras ? fmt::format(",{}", frame.lost_cameras) : "";
  return fmt::format("{},{:.6f},{},{},{},{},{},{}{}\n", frame.frame, frame.time, frame.number,
                     frame.camera_utime, frame.arrived_utime, frame.searched ? 1 : 0,
                     frame.status_instance, frame.status_seq, more);
}

std::vector<FilmFrame> readFilmTable(const fs::path& file) {
  FileContent content = readRegularFile(file, file_kinds::kFrameTable);
  if (!content.text) throw CameraError(file.string() + ": " + content.problem);
  const bool cut = !content.text->empty() && content.text->back() != '\n';
  std::istringstream stream(*std::move(content.text));
  std::string line;
  std::getline(stream, line);
  const FilmTable table = line == std::string(kTableHeader) + kSeveralColumn
                              ? FilmTable::kSeveralCameras
                              : FilmTable::kOneCamera;
  if (table == FilmTable::kOneCamera && line != kTableHeader) {
    throw CameraError(file.string() + ":1: found \"" + line.substr(0, 80) +
                      "\", expected the columns " + kTableHeader);
  }
  std::vector<FilmFrame> frames;
  for (int number = 2; std::getline(stream, line); ++number) {
    if (cut && stream.eof()) break;
    FilmFrame frame;
    if (!parseLine(line, table, frame) || frame.frame != static_cast<std::int64_t>(frames.size())) {
      throw CameraError(fmt::format("{}:{}: found \"{}\", expected frame {} and {} more numbers",
                                    file.string(), number, line.substr(0, 80), frames.size(),
                                    columnsOf(table) - 1));
    }
    if (const std::string problem = timeProblem(frame, frames); !problem.empty()) {
      throw CameraError(fmt::format(
          "{}:{}: {}: the table is damaged; without it, lab track takes the times of the movie",
          file.string(), number, problem));
    }
    frames.push_back(frame);
  }
  return frames;
}

std::vector<std::size_t> orderOfArrival(std::span<const std::vector<FilmFrame>> tables) {
  std::vector<std::size_t> order;
  std::vector<std::size_t> next(tables.size(), 0);
  const auto arrival = [&](std::size_t camera) {
    return tables[camera][next[camera]].arrived_utime;
  };
  while (true) {
    std::optional<std::size_t> first;
    for (std::size_t camera = 0; camera < tables.size(); ++camera) {
      if (next[camera] == tables[camera].size()) continue;
      if (!first || arrival(camera) < arrival(*first)) first = camera;
    }
    if (!first) return order;
    order.push_back(*first);
    ++next[*first];
  }
}

bool writeFilmFacts(const fs::path& file, const FilmFacts& facts) {
  const CameraFormat& format = facts.format;
  nlohmann::ordered_json json{{"form", kForm}};
  if (!facts.camera.empty()) json["camera"] = facts.camera;
  json.update({{"codec", facts.codec},
               {"crf", facts.crf},
               {"width_px", format.width},
               {"height_px", format.height},
               {"fps", format.fps},
               {"exposure_s", format.exposure},
               {"gain", format.gain},
               {"pixels", format.pixels},
               {"locked", format.locked},
               {"compressed", format.compressed},
               {"start_utime", facts.start_utime},
               {"first_utime", facts.first_utime},
               {"last_utime", facts.last_utime},
               {"frames", facts.frames},
               {"lost", facts.lost},
               {"after_end", facts.after_end},
               {"bytes", facts.bytes},
               {"cpu_s", facts.cpu},
               {"complete", facts.complete},
               {"problem", facts.problem}});
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  try {
    replaceFile(file, json.dump(2, ' ', false, kReplace) + "\n");
  } catch (const std::runtime_error&) {
    return false;
  }
  return true;
}

FilmFacts readFilmFacts(const fs::path& file) {
  const std::string name = file.string();
  const nlohmann::json json =
      parseJson(name, readFileText(file, file_kinds::kCalibration), "the facts of a film");
  const JsonSection section(name, "docs/films.md", json);
  if (section.text("form") != kForm) {
    section.fail("form", "found \"" + section.text("form") + "\", expected \"" + kForm + "\"");
  }
  const auto flag = [&](const char* key) {
    const auto entry = json.find(key);
    if (entry == json.end() || !entry->is_boolean()) section.fail(key, "expected true or false");
    return entry->get<bool>();
  };
  const auto whole = [&](const char* key) {
    return static_cast<std::int64_t>(section.number(key, 0, kLargest));
  };
  const auto time = [&](const char* key) {
    constexpr auto kLatest = static_cast<double>(ValueChecker::kLatestUtime);
    return static_cast<std::int64_t>(section.number(key, 0, kLatest));
  };
  FilmFacts facts;
  if (json.contains("camera")) facts.camera = section.text("camera");
  facts.codec = section.text("codec");
  facts.crf = static_cast<int>(section.number("crf", 0, 51));
  facts.format.width = section.pixels("width_px");
  facts.format.height = section.pixels("height_px");
  facts.format.fps = section.number("fps", 0, 1e6);
  // The time between frames must be a number of microseconds.
  constexpr double kLeastFps = 1e-3;
  if (facts.format.fps > 0 && facts.format.fps < kLeastFps) {
    section.fail("fps", fmt::format("found {:g}, expected 0 (not known) or at least {:g}",
                                    facts.format.fps, kLeastFps));
  }
  facts.format.exposure = section.number("exposure_s", 0, 1e6);
  facts.format.gain = section.number("gain", -1e9, 1e9);
  facts.format.pixels = section.text("pixels");
  facts.format.locked = flag("locked");
  facts.format.compressed = flag("compressed");
  facts.start_utime = time("start_utime");
  facts.first_utime = time("first_utime");
  facts.last_utime = time("last_utime");
  facts.frames = whole("frames");
  facts.lost = whole("lost");
  facts.after_end = whole("after_end");
  facts.bytes = whole("bytes");
  facts.cpu = section.number("cpu_s", 0, 1e12);
  facts.complete = flag("complete");
  facts.problem = section.text("problem");
  return facts;
}

std::vector<std::vector<fs::path>> filmStarts(const fs::path& run) {
  std::vector<std::vector<fs::path>> starts;
  for (int number = 1;; ++number) {
    std::vector<fs::path> films = filmsIn(filmFolder(run, number));
    if (films.empty()) return starts;
    starts.push_back(std::move(films));
  }
}

std::vector<fs::path> filmFolders(const fs::path& run) {
  std::vector<fs::path> folders;
  for (const std::vector<fs::path>& films : filmStarts(run)) {
    folders.insert(folders.end(), films.begin(), films.end());
  }
  return folders;
}

fs::path makeFilmFolder(const fs::path& run) {
  for (int number = 1;; ++number) {
    const fs::path folder = filmFolder(run, number);
    if (fs::create_directory(folder)) return folder;
  }
}

}  // namespace lab
