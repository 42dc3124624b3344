#include "runner/film/run_clip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/calibration/camera_file.hpp"
#include "common/camera/run_film.hpp"
#include "common/files/scratch_folder.hpp"
#include "common/process/child_process.hpp"
#include "light/optics/rgb_image.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/film/movie_writer.hpp"
#include "runner/film/retrack.hpp"
#include "runner/runs/run_directory.hpp"
#include "tracker_svc/film_reader.hpp"
#include "tracker_svc/overlay.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostPictures = 240;
constexpr double kClipFps = 24;
constexpr int kClipWidth = 640;  // [px]
constexpr std::size_t kStills = 6;
constexpr int kStillsAcross = 3;
constexpr int kStillWidth = 480;  // [px]

/// A film of the run, and which of its frames are shown.
struct Part {
  fs::path movie;
  FilmFacts facts;
  std::vector<FilmFrame> table;
  std::int64_t stride = 1;

  [[nodiscard]] std::int64_t utimeOf(std::int64_t frame) const {
    return facts.first_utime + table[static_cast<std::size_t>(frame)].camera_utime -
           table.front().camera_utime;
  }
};

/// What the log says of the frames that are shown.
struct Seen {
  tracked_frame_t poses{};
  tracked_details_t details{};
};

std::vector<Part> partsOf(const fs::path& run) {
  std::vector<Part> parts;
  std::int64_t frames = 0;
  for (const fs::path& folder : filmFolders(run)) {
    Part part{folder / film_files::kMovie, readFilmFacts(folder / film_files::kFacts), {}, 1};
    part.table = readFilmTable(filmTableOf(part.movie));
    // The facts of a film that was cut off are those of a moment before.
    if (part.table.empty() || part.facts.first_utime == 0) continue;
    frames += static_cast<std::int64_t>(part.table.size());
    parts.push_back(std::move(part));
  }
  for (Part& part : parts) {
    part.stride = std::max<std::int64_t>(1, (frames + kMostPictures - 1) / kMostPictures);
    if (part.facts.lossless()) continue;
    // Only every so many-th frame can be read without those before it (encodeCommand()).
    const auto group = std::max<std::int64_t>(1, std::llround(part.facts.format.fps));
    part.stride = (part.stride + group - 1) / group * group;
  }
  return parts;
}

/// Copies the frames that are shown into a small movie, without decoding the others.
fs::path shortened(const Part& part, const fs::path& folder) {
  if (part.stride == 1) return part.movie;
  fs::path out = folder / "shown.mkv";
  ChildProcess copy(
      {.arguments = {"ffmpeg", "-hide_banner", "-loglevel", "fatal", "-nostdin", "-y", "-i",
                     "file:" + part.movie.string(), "-map", "0:v:0", "-c", "copy", "-bsf:v",
                     fmt::format("noise=amount=0:drop='mod(n,{})'", part.stride),
                     "file:" + out.string()}});
  copy.wait();
  // The end of a film of a killed run is damaged; what could be copied is shown.
  if (!fs::exists(out)) throw std::runtime_error("ffmpeg could not read " + part.movie.string());
  return out;
}

/// Reads the poses of the frames that are shown. @return time of the first message of the log
std::int64_t readPoses(const fs::path& log, std::map<std::int64_t, Seen>& shown) {
  LogReader reader(logSeries(log));
  std::int64_t begin = 0;
  while (const std::optional<Packet> packet = reader.next()) {
    if (begin == 0) begin = packet->received_utime;
    if (packet->channel == channels::kTrackedFrame) {
      tracked_frame_t poses{};
      if (!decode(packet->data, poses)) continue;
      if (const auto at = shown.find(poses.utime); at != shown.end()) at->second.poses = poses;
    } else if (packet->channel == channels::kTrackedDetails) {
      tracked_details_t details{};
      if (!decode(packet->data, details)) continue;
      if (const auto at = shown.find(details.utime); at != shown.end()) {
        at->second.details = details;
      }
    }
  }
  return begin;
}

class ClipPainter {
 public:
  ClipPainter(const CameraCalibration& calibration, std::int64_t begin_utime)
      : camera_(calibration.camera), cap_(calibration.cap), begin_(begin_utime) {}

  [[nodiscard]] optics::RgbImage paint(const optics::GreyView& picture, std::int64_t utime,
                                       const Seen& seen, int width) const {
    std::vector<tracker::Mark> marks;
    for (const tracker::FilmRow& row : filmRowsOf(seen.poses, seen.details, 0)) {
      const bool known = static_cast<int>(marks.size()) < seen.poses.num_robots;
      marks.push_back({row.pose, known ? fmt::format("R{}", row.id) : "?", true});
    }
    const std::string caption = fmt::format("{:.1f} s", secondsAt(utime));
    return tracker::overlay(
        {.picture = picture, .marks = marks, .rejected = {}, .caption = caption, .width = width},
        camera_, cap_);
  }

  /// [s] since the first message of the log
  [[nodiscard]] double secondsAt(std::int64_t utime) const {
    return static_cast<double>(utime - begin_) * 1e-6;
  }

 private:
  optics::CameraModel camera_;
  optics::CapGeometry cap_;
  std::int64_t begin_;
};

void writeAll(const fs::path& file, const std::vector<std::uint8_t>& bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written: is the disk full?");
}

void make(const std::vector<Part>& parts, const fs::path& log, const CameraCalibration& calibration,
          const fs::path& folder) {
  std::map<std::int64_t, Seen> shown;
  for (const Part& part : parts) {
    const auto frames = static_cast<std::int64_t>(part.table.size());
    for (std::int64_t i = 0; i < frames; i += part.stride) shown[part.utimeOf(i)];
  }
  const ClipPainter painter(calibration, readPoses(log, shown));
  std::optional<MovieWriter> writer;
  std::vector<optics::RgbImage> stills;
  nlohmann::json times = nlohmann::json::array();
  const std::size_t every = std::max<std::size_t>(1, shown.size() / kStills);
  for (const Part& part : parts) {
    const auto film = FilmReader::open(shortened(part, folder).string());
    const auto frames = static_cast<std::int64_t>(part.table.size());
    CameraFrame frame;
    for (std::int64_t i = 0; i < frames && film->next(frame); i += part.stride) {
      const std::int64_t utime = part.utimeOf(i);
      const Seen& seen = shown[utime];
      const optics::RgbImage image = painter.paint(frame.grey, utime, seen, kClipWidth);
      if (!writer) {
        writer.emplace(folder / clip_files::kClip, image.width, image.height, kClipFps);
      }
      writer->write(image);
      if (times.size() % every == every / 2 && stills.size() < kStills) {
        stills.push_back(painter.paint(frame.grey, utime, seen, kStillWidth));
      }
      times.push_back(std::round(painter.secondsAt(utime) * 1e3) / 1e3);
    }
  }
  if (!writer) throw std::runtime_error("the film has no frame that can be read");
  writer->finish();
  writeAll(folder / clip_files::kStills,
           optics::jpegBytes(optics::contactSheet(stills, kStillsAcross)));
  const nlohmann::ordered_json facts{{"fps", kClipFps}, {"t_s", times}};
  const std::string text = facts.dump() + "\n";
  writeAll(folder / clip_files::kTimes, {text.begin(), text.end()});
}

}  // namespace

std::string makeRunClip(const fs::path& run, const fs::path& log, const fs::path& calibration,
                        const fs::path& out) {
  try {
    const std::vector<Part> parts = partsOf(run);
    if (parts.empty()) return {};
    const CameraCalibration camera = readCameraFile(
        calibration.empty() ? run / files::kCalibration / "camera_in_force.json" : calibration);
    const ScratchFolder scratch(makeUniqueFolder(out, ".film"));
    if (scratch.path().empty()) return out.string() + ": cannot write here";
    make(parts, log, camera, scratch.path());
    for (const char* file : {clip_files::kClip, clip_files::kStills, clip_files::kTimes}) {
      fs::rename(scratch.path() / file, out / file);
    }
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace lab::runner
