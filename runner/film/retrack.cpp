#include "runner/film/retrack.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/message_values.hpp"
#include "common/calibration/camera_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/files/file_text.hpp"
#include "common/math/units.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/film/film_pass.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTrackerName = "tracker_svc";

/// The header of a message of the run, so that its streams remain whole.
template <class Message>
void adoptHeader(Message& message, const Message& of) {
  message.sender = of.sender;
  message.instance = of.instance;
  message.seq = of.seq;
}

/// The frame in place of one of the run. Its time can differ if it is of several cameras, by what
/// the clocks of these are found to differ.
template <class Message>
Message inPlaceOf(const Message& old, Message now) {
  adoptHeader(now, old);
  now.frame = old.frame;
  return now;
}

/// What the tracker knew of the camera in the run, and what it found now.
tracker_status_t merged(const tracker_status_t& old, tracker_status_t now, bool several) {
  adoptHeader(now, old);
  now.utime = old.utime;
  if (!several) now.camera = old.camera;  // of several, it has what is estimated of their clocks
  now.state = old.state;
  now.trouble = old.trouble;
  now.fps = old.fps;
  now.dropped = old.dropped;
  now.latency_p50 = old.latency_p50;
  now.latency_p95 = old.latency_p95;
  now.latency_p99 = old.latency_p99;
  return now;
}

/// The films of a run as one, beside its log.
class Retracking {
 public:
  Retracking(const RetrackOptions& options, LogWriter* writer,
             const std::function<void(const RetrackedFrame&)>& take)
      : options_(options),
        experiment_(experimentToTrack(options)),
        films_(filmStarts(options.run)),
        log_(logSeries(options.run / files::kLog)),
        writer_(writer),
        take_(take) {
    requireFilm(options);
    if (experiment_.cameras.empty()) return;
    constexpr double kNear = 0.25;  // of the time between frames
    near_us_ = units::microseconds(kNear / experiment_.camera.fps);
    counts_.cameras = static_cast<std::int64_t>(experiment_.cameras.size());
  }

  RetrackCounts track() {
    openNext();
    LogReader reader(log_);
    while (const std::optional<Packet> packet = reader.next()) rewrite(*packet);
    while (advance()) {
    }
    if (writer_ != nullptr) writer_->flush();
    return std::move(counts_);
  }

 private:
  void openNext() {
    pass_.reset();
    if (next_film_ == films_.size()) return;
    const std::vector<fs::path>& films = films_[next_film_++];
    for (const fs::path& film : films) checkCalibration(film);
    pass_ = std::make_unique<FilmPass>(films, experiment_, options_.run, log_);
    ++counts_.films;
    counts_.lossless = counts_.lossless && pass_->lossless();
    if (counts_.lacking.empty()) counts_.lacking = pass_->lacking();
    if (start_utime_ == 0) start_utime_ = pass_->firstUtime();
  }

  /// The tracker refuses pictures of another size than that of the calibration.
  void checkCalibration(const fs::path& film) const {
    const FilmFacts facts = readFilmFacts(film / film_files::kFacts);
    fs::path calibration = options_.calibration;
    for (const CameraSpec& camera : experiment_.cameras) {
      if (camera.name != facts.camera || camera.calibration.empty()) continue;
      calibration = options_.run / camera.calibration;
    }
    if (calibration.empty()) return;
    const optics::CameraParameters& camera = readCameraFile(calibration).camera;
    const CameraFormat& format = facts.format;
    if (format.width == camera.width && format.height == camera.height) return;
    throw UserError(fmt::format(
        "{}: found a calibration of {} x {} px, expected {} x {} px, the size of the film {}; "
        "calibrate the camera at that size",
        calibration.string(), camera.width, camera.height, format.width, format.height,
        (film / film_files::kMovie).string()));
  }

  /// Tracks up to the next round of poses. @return false after the last film
  bool advance() {
    while (true) {
      if (pass_ && next_round_ < pass_->rounds().size()) {
        round_ = pass_->rounds()[next_round_++];
        reached_.reset();
        const tracked_frame_t& poses = round_->poses;
        counts_.poses += poses.num_robots + poses.num_unidentified;
        take_({static_cast<double>(poses.utime - start_utime_) * 1e-6, counts_.frames,
               counts_.cameras == 1 ? pass_->picture() : optics::GreyView{}, poses,
               round_->details});
        return true;
      }
      if (!pass_) return false;
      next_round_ = 0;
      if (pass_->next()) {
        ++counts_.frames;
        continue;
      }
      if (counts_.problem.empty()) counts_.problem = pass_->problem();
      openNext();
    }
  }

  /// Whether the films have the frame of this time: tracks up to it.
  bool reach(std::int64_t utime) {
    if (reached_ == utime) return true;
    // A round is in place of one round of the run.
    if (reached_ && utime > *reached_ && !advance()) return false;
    while (!round_ || round_->poses.utime < utime - near_us_) {
      if (!advance()) return false;
    }
    if (std::abs(round_->poses.utime - utime) > near_us_) return false;
    reached_ = utime;
    return true;
  }

  /// A frame cannot be sent before it was exposed. A forged or damaged time far ahead would play
  /// the films to their end, and no frame after it would be found.
  template <class Message>
  static bool hasItsTime(const Packet& packet, const Message& message) {
    constexpr std::int64_t kClocksDiffer_us = 60'000'000;  // between hosts, at most
    return !impossibleHeader(packet.channel, message.utime, message.seq) &&
           message.utime - packet.received_utime < kClocksDiffer_us;
  }

  void write(const Packet& packet) {
    if (writer_ != nullptr) writer_->write(packet);
  }

  template <class Message>
  void writeInPlaceOf(const Packet& packet, const Message& message) {
    if (writer_ == nullptr) return;
    const std::vector<std::uint8_t> bytes = encode(message);
    writer_->write({packet.channel, bytes, packet.received_utime});
  }

  void rewrite(const Packet& packet) {
    if (packet.channel == channels::kTrackedFrame) {
      rewriteFrame(packet);
    } else if (packet.channel == channels::kTrackedDetails) {
      tracked_details_t old{};
      if (!decode(packet.data, old) || old.sender != kTrackerName || !hasItsTime(packet, old)) {
        return write(packet);
      }
      if (!reach(old.utime)) return;
      writeInPlaceOf(packet, inPlaceOf(old, round_->details));
    } else if (packet.channel == channels::kTrackerStatus) {
      tracker_status_t old{};
      if (!decode(packet.data, old) || !pass_) return write(packet);
      pass_->passTime(packet.received_utime);
      writeInPlaceOf(packet,
                     pass_->status() ? merged(old, *pass_->status(), counts_.cameras > 1) : old);
    } else {
      write(packet);
    }
  }

  void rewriteFrame(const Packet& packet) {
    tracked_frame_t old{};
    if (!decode(packet.data, old) || old.sender != kTrackerName) return write(packet);
    if (!hasItsTime(packet, old)) {
      ++counts_.missing;
      return write(packet);
    }
    if (!reach(old.utime)) {
      ++counts_.missing;
      return;
    }
    ++counts_.compared;
    const std::vector<std::uint8_t> bytes = encode(inPlaceOf(old, round_->poses));
    if (std::ranges::equal(bytes, packet.data)) ++counts_.equal;
    if (writer_ != nullptr) writer_->write({packet.channel, bytes, packet.received_utime});
  }

  const RetrackOptions& options_;
  Experiment experiment_;
  std::vector<std::vector<fs::path>> films_;  ///< by start of the tracker
  std::vector<fs::path> log_;
  LogWriter* writer_;
  const std::function<void(const RetrackedFrame&)>& take_;
  std::size_t next_film_ = 0;
  std::unique_ptr<FilmPass> pass_;
  std::size_t next_round_ = 0;            ///< of those of the last frame
  std::optional<FilmPass::Round> round_;  ///< the last
  std::optional<std::int64_t> reached_;   ///< time in the run of what it is in place of
  std::int64_t near_us_ = 0;              ///< rounds of this distance in time are the same one
  std::int64_t start_utime_ = 0;
  RetrackCounts counts_;
};

}  // namespace

Experiment experimentToTrack(const RetrackOptions& options) {
  const fs::path file = options.run / files::kExperiment;
  Experiment experiment =
      parseExperiment(readFileText(file, file_kinds::kExperiment), file.string(), options.set);
  if (!options.calibration.empty()) {
    experiment.camera.calibration = fs::absolute(options.calibration).string();
  }
  experiment.camera.film = {};
  experiment.camera.debug_port = 0;
  return experiment;
}

bool isRunFolder(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / files::kLog, error) && fs::exists(folder / files::kExperiment, error);
}

std::string filmedCamera(const fs::path& run) {
  const std::vector<fs::path> films = filmFolders(run);
  return films.empty() ? std::string() : readFilmFacts(films.front() / film_files::kFacts).camera;
}

void requireFilm(const RetrackOptions& options) {
  const std::string run = options.run.string();
  if (filmFolders(options.run).empty()) {
    throw UserError(
        run +
        ": found no film, expected film/film.mkv with film.json: set camera.record = true "
        "before a run (docs/films.md)");
  }
  const std::string camera = filmedCamera(options.run);
  if (options.calibration.empty() || camera.empty()) return;
  throw UserError(
      fmt::format("{0}: found --calibration and films of several cameras, expected --set "
                  "cameras[0].calibration='\"FILE\"' for each; to track one film alone, give "
                  "{0}/film/{1}/film.mkv",
                  run, camera));
}

RetrackCounts retrack(const RetrackOptions& options, LogWriter* log,
                      const std::function<void(const RetrackedFrame&)>& take) {
  try {
    return Retracking(options, log, take).track();
  } catch (const CameraError& error) {
    throw UserError(error.what());
  } catch (const ExperimentError& error) {
    throw UserError(error.what());
  }
}

std::int64_t filmFramesOf(const fs::path& run) {
  std::int64_t frames = 0;
  try {
    for (const fs::path& film : filmFolders(run)) {
      frames += readFilmFacts(film / film_files::kFacts).frames;
    }
  } catch (const ExperimentError&) {
    return 0;  // retrack() says what is wrong
  }
  return frames;
}

std::vector<tracker::FilmRow> filmRowsOf(const tracked_frame_t& poses,
                                         const tracked_details_t& details, double time) {
  std::vector<tracker::FilmRow> rows;
  const auto add = [&](const tracked_pose_t& pose) {
    tracker::FilmRow row{poses.frame, std::max<std::int64_t>(0, pose.robot_id), time, {}};
    row.pose.x = pose.x;
    row.pose.y = pose.y;
    row.pose.theta = pose.theta;
    std::ranges::copy(pose.covariance, row.pose.covariance.begin());
    row.pose.quality = pose.confidence;
    if (rows.size() < details.caps.size()) {
      const cap_detail_t& cap = details.caps[rows.size()];
      row.pose.used = static_cast<std::uint8_t>(cap.used);
      row.pose.spacing = cap.spacing;
      row.pose.middle = {cap.u, cap.v};
    }
    rows.push_back(row);
  };
  for (const tracked_pose_t& pose : poses.robots) add(pose);
  for (const tracked_pose_t& pose : poses.unidentified) add(pose);
  return rows;
}

std::string retrackText(const RetrackCounts& counts) {
  const bool several = counts.cameras > 1;
  std::string text =
      fmt::format("{} frames{}, {} poses; in {} of {} {} those of the run, bit by bit",
                  counts.frames, several ? fmt::format(" of {} cameras", counts.cameras) : "",
                  counts.poses, counts.equal, counts.compared, several ? "rounds" : "frames");
  if (!counts.lossless) text += "; the film is compressed, so poses differ";
  if (counts.missing > 0) {
    text += fmt::format("; {} {} of the run are not in the film{}", counts.missing,
                        several ? "rounds" : "frames", several ? "s" : "");
  }
  if (!counts.lacking.empty()) text += "; " + counts.lacking;
  return text;
}

}  // namespace lab::runner
