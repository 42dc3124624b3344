#include "runner/film/run_clip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/message_values.hpp"
#include "common/calibration/camera_file.hpp"
#include "common/experiment/experiment.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/scratch_folder.hpp"
#include "common/math/units.hpp"
#include "light/optics/rgb_image.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/film/clip_films.hpp"
#include "runner/film/movie_writer.hpp"
#include "runner/runs/run_directory.hpp"
#include "tracker_svc/film_reader.hpp"
#include "tracker_svc/overlay.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

constexpr double kClipFps = 24;
constexpr int kClipWidth = 640;  // [px]
constexpr std::size_t kStills = 6;
constexpr int kStillsAcross = 3;
constexpr int kStillWidth = 480;       // [px]
constexpr double kSeveralWider = 1.5;  // several cameras side by side than one
constexpr std::uint8_t kGround = 128;  // [DN] where there is no picture

/// What the log says of the frames that are shown.
struct Seen {
  tracked_frame_t poses{};
  tracked_details_t details{};
};

/// Reads the poses of the frames that are shown.
/// @param near_us TRACKED_FRAME of several cameras differ by up to this from their frames
/// @return time of the first message of the log
std::int64_t readPoses(const fs::path& log, std::int64_t near_us,
                       std::map<std::int64_t, Seen>& shown) {
  const auto keep = [&]<class Message>(const Packet& packet, Message Seen::*member) {
    Message message{};
    if (!decode(packet.data, message) ||
        impossibleHeader(packet.channel, message.utime, message.seq)) {
      return;
    }
    const auto end = shown.upper_bound(message.utime + near_us);
    for (auto at = shown.lower_bound(message.utime - near_us); at != end; ++at) {
      Message& known = at->second.*member;
      const auto distance = [&](const Message& one) { return std::abs(one.utime - at->first); };
      if (distance(message) <= distance(known)) known = message;
    }
  };
  LogReader reader(logSeries(log));
  std::int64_t begin = 0;
  while (const std::optional<Packet> packet = reader.next()) {
    if (begin == 0) begin = packet->received_utime;
    if (packet->channel == channels::kTrackedFrame) keep(*packet, &Seen::poses);
    if (packet->channel == channels::kTrackedDetails) keep(*packet, &Seen::details);
  }
  return begin;
}

/// One of the cameras of the run.
struct View {
  std::string name;  ///< empty: there is only one
  CameraCalibration calibration;
};

/// As one sees the arena: rows from far to near, in each from left to right.
std::vector<View> arranged(std::vector<View> views, int across) {
  const auto centre = [](const View& view) {
    const optics::CameraParameters& camera = view.calibration.camera;
    return optics::CameraModel(camera)
        .toPlane({camera.width / 2.0, camera.height / 2.0}, 0)
        .value_or(optics::Place{});
  };
  std::ranges::stable_sort(views, std::greater{}, [&](const View& view) { return centre(view).y; });
  for (std::size_t from = 0; from < views.size(); from += static_cast<std::size_t>(across)) {
    const std::size_t to = std::min(views.size(), from + static_cast<std::size_t>(across));
    std::ranges::stable_sort(std::span(views).subspan(from, to - from), std::less{},
                             [&](const View& view) { return centre(view).x; });
  }
  return views;
}

/// At most three cameras lie in a row, more in a square.
int tilesAcross(std::size_t cameras) {
  const auto count = static_cast<int>(cameras);
  return count <= 3 ? count : static_cast<int>(std::ceil(std::sqrt(count)));
}

class ClipPainter {
 public:
  ClipPainter(const View& view, std::int64_t begin_utime)
      : name_(view.name),
        camera_(view.calibration.camera),
        cap_(view.calibration.cap),
        begin_(begin_utime) {}

  [[nodiscard]] const std::string& camera() const { return name_; }

  [[nodiscard]] optics::RgbImage paint(const optics::GreyView& picture, std::int64_t utime,
                                       const Seen& seen, int width) const {
    std::vector<tracker::Mark> marks;
    int number = 0;
    for (const tracker::FilmRow& row : filmRowsOf(seen.poses, seen.details, 0)) {
      const bool known = number++ < seen.poses.num_robots;
      if (!name_.empty() && !isInView(row.pose)) continue;
      marks.push_back({row.pose, known ? fmt::format("R{}", row.id) : "?", true});
    }
    const std::string caption =
        fmt::format("{}{:.1f} s", name_.empty() ? "" : name_ + "  ", secondsAt(utime));
    return draw(picture, marks, caption, width);
  }

  /// In place of a picture that is not there.
  [[nodiscard]] optics::RgbImage blank(int width) const {
    const optics::CameraParameters& camera = camera_.parameters();
    return draw(optics::GreyImage(camera.width, camera.height, kGround).view(), {},
                name_ + ": no picture", width);
  }

  /// [s] since the first message of the log
  [[nodiscard]] double secondsAt(std::int64_t utime) const {
    return static_cast<double>(utime - begin_) * 1e-6;
  }

 private:
  [[nodiscard]] bool isInView(const detector::Detection& pose) const {
    const optics::Pixel at = camera_.project(pose.x, pose.y, cap_.height);
    const optics::CameraParameters& camera = camera_.parameters();
    return at.x >= 0 && at.y >= 0 && at.x < camera.width && at.y < camera.height;
  }

  [[nodiscard]] optics::RgbImage draw(const optics::GreyView& picture,
                                      std::span<const tracker::Mark> marks,
                                      const std::string& caption, int width) const {
    return tracker::overlay(
        {.picture = picture, .marks = marks, .rejected = {}, .caption = caption, .width = width},
        camera_, cap_);
  }

  std::string name_;
  optics::CameraModel camera_;
  optics::CapGeometry cap_;
  std::int64_t begin_;
};

/// One picture as it is; several side by side, each in the space of the largest.
optics::RgbImage sideBySide(std::vector<optics::RgbImage> tiles) {
  if (tiles.size() == 1) return std::move(tiles.front());
  optics::RgbImage space(std::ranges::max(tiles, {}, &optics::RgbImage::width).width,
                         std::ranges::max(tiles, {}, &optics::RgbImage::height).height);
  optics::RgbImage& first = tiles.front();
  for (int y = 0; y < first.height; ++y)
    std::copy_n(first.at(0, y), 3 * first.width, space.at(0, y));
  first = std::move(space);
  return optics::contactSheet(tiles, tilesAcross(tiles.size()));
}

/// Makes the pictures of the clip, one after the other.
class ClipMaker {
 public:
  ClipMaker(const std::vector<ClipStart>& starts, const std::vector<View>& views,
            const fs::path& log, const fs::path& folder)
      : starts_(starts), folder_(folder) {
    const ClipFilm& film = leadingFilm(starts.front());
    const double fps = film.facts.format.fps > 0 ? film.facts.format.fps : kAssumedFps;
    if (views.size() > 1) near_us_ = units::microseconds(0.5 / fps);
    for (const ClipStart& start : starts) {
      for (const ClipFilm& part : start) {
        for (std::int64_t i = 0; i < part.frames(); i += part.stride) shown_[part.utimeOf(i)];
      }
      const ClipFilm& leader = leadingFilm(start);
      pictures_ += static_cast<std::size_t>((leader.frames() + leader.stride - 1) / leader.stride);
    }
    const std::int64_t begin = readPoses(log, near_us_, shown_);
    for (const View& view : views) painters_.emplace_back(view, begin);
  }

  void make() {
    for (const ClipStart& start : starts_) show(start);
    if (!writer_) throw std::runtime_error("the film has no frame that can be read");
    writer_->finish();
    replaceFile(folder_ / clip_files::kStills,
                optics::jpegBytes(optics::contactSheet(stills_, kStillsAcross)));
    const nlohmann::ordered_json facts{{"fps", kClipFps}, {"t_s", times_}};
    const std::string text = facts.dump() + "\n";
    replaceFile(folder_ / clip_files::kTimes, text);
  }

 private:
  void show(const ClipStart& start) {
    const ClipFilm& leader = leadingFilm(start);
    std::vector<std::optional<FilmPlayer>> players(painters_.size());
    for (const ClipFilm& part : start) {
      for (std::size_t i = 0; i < painters_.size(); ++i) {
        if (painters_[i].camera() != part.facts.camera) continue;
        try {
          players[i].emplace(part, &part == &leader ? 0 : near_us_, folder_);
        } catch (const std::exception&) {  // the others are shown
          if (start.size() == 1) throw;
        }
      }
    }
    for (std::int64_t i = 0; i < leader.frames(); i += leader.stride) {
      const std::int64_t utime = leader.utimeOf(i);
      for (std::optional<FilmPlayer>& player : players) {
        if (player) player->play(utime);
      }
      const auto shows = [&](const auto& player) { return player && player->at(utime); };
      if (std::ranges::none_of(players, shows)) continue;
      const optics::RgbImage image = picture(players, utime, kClipWidth);
      if (!writer_) {
        writer_.emplace(folder_ / clip_files::kClip, image.width, image.height, kClipFps);
      }
      writer_->write(image);
      const std::size_t every = std::max<std::size_t>(1, pictures_ / kStills);
      if (times_.size() % every == every / 2 && stills_.size() < kStills) {
        stills_.push_back(picture(players, utime, kStillWidth));
      }
      times_.push_back(std::round(painters_.front().secondsAt(utime) * 1e3) / 1e3);
    }
  }

  [[nodiscard]] optics::RgbImage picture(const std::vector<std::optional<FilmPlayer>>& players,
                                         std::int64_t utime, int width) {
    std::vector<optics::RgbImage> tiles;
    if (players.size() > 1) {
      width = static_cast<int>(kSeveralWider * width) / tilesAcross(players.size());
    }
    for (std::size_t i = 0; i < players.size(); ++i) {
      const std::optional<std::int64_t> at = players[i] ? players[i]->at(utime) : std::nullopt;
      tiles.push_back(at ? painters_[i].paint(players[i]->picture(), *at, shown_[*at], width)
                         : painters_[i].blank(width));
    }
    return sideBySide(std::move(tiles));
  }

  const std::vector<ClipStart>& starts_;
  fs::path folder_;
  std::int64_t near_us_ = 0;
  std::size_t pictures_ = 0;
  std::map<std::int64_t, Seen> shown_;
  std::vector<ClipPainter> painters_;
  std::optional<MovieWriter> writer_;
  std::vector<optics::RgbImage> stills_;
  nlohmann::json times_ = nlohmann::json::array();
};

/// The cameras of the run, with the calibrations in force.
std::vector<View> viewsOf(const RetrackOptions& options) {
  if (filmedCamera(options.run).empty()) {
    return {{"", readCameraFile(options.calibration.empty()
                                    ? options.run / files::kCalibration / "camera_in_force.json"
                                    : options.calibration)}};
  }
  std::vector<View> views;
  for (const CameraSpec& camera : experimentToTrack(options).cameras) {
    views.push_back({camera.name, readCameraFile(options.run / camera.calibration)});
  }
  return arranged(views, tilesAcross(views.size()));
}

}  // namespace

std::string makeRunClip(const RetrackOptions& of, const fs::path& log, const fs::path& out) {
  try {
    const std::vector<ClipStart> starts = clipStarts(of.run);
    if (starts.empty()) return {};
    const std::vector<View> views = viewsOf(of);
    const ScratchFolder scratch(makeUniqueFolder(out, ".film"));
    if (scratch.path().empty()) return out.string() + ": cannot write here";
    ClipMaker(starts, views, log, scratch.path()).make();
    for (const char* file : {clip_files::kClip, clip_files::kStills, clip_files::kTimes}) {
      fs::rename(scratch.path() / file, out / file);
    }
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace lab::runner
