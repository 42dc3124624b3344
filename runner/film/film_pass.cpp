#include "runner/film/film_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <lab/robot_status_t.hpp>
#include <limits>
#include <utility>

#include "common/bus/channels.hpp"
#include "tracker_svc/tracker_service.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

/// A message that the log lacks is not searched for longer than this in it [us].
constexpr std::int64_t kReportMargin_us = 1'000'000;
/// So long after its last frame, a tracker reports the same for ever [us].
constexpr std::int64_t kAfterFilms_us = 3'600'000'000;

/// The tracker's timers run from its start to the first frame, for years if one of these times is
/// far from the other.
/// @throws CameraError
void requireNearStart(const fs::path& folder, std::int64_t start_utime,
                      const std::vector<FilmFrame>& table) {
  if (table.empty() || table.front().arrived_utime - start_utime <= kLongestFilm_us) return;
  throw CameraError(fmt::format(
      "{}: start_utime: found {}, expected at most 11 days before the first arrived_utime of {}, "
      "{}: one of them is damaged; lab track {} takes the times of the movie",
      (folder / film_files::kFacts).string(), start_utime, filmTableOf(film_files::kMovie).string(),
      table.front().arrived_utime, (folder / film_files::kMovie).string()));
}

}  // namespace

/// Gives the frames of the films to the tracker, whatever cameras its experiment names.
class FilmPass::FilmCameras final : public Cameras {
 public:
  /// @param films must outlive the sources
  explicit FilmCameras(const std::vector<Film>& films) : films_(films) {}

  /// The tracker opens its cameras in the order of the experiment.
  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string&, const CameraFormat& requested,
                                                  CameraHandlers handlers) override {
    const Film& film = films_[handlers_.size()];
    handlers_.push_back(std::move(handlers));
    if (!film.recorded) return std::make_unique<Source>(requested);
    CameraFormat format = film.facts.format;
    format.compressed = format.compressed || !film.facts.lossless();
    return std::make_unique<Source>(std::move(format));
  }
  [[nodiscard]] std::unique_ptr<FrameSink> offer(const CameraFormat&) override {
    throw CameraError("sim: a film is tracked, nothing is painted");
  }

  /// Rounds do not wait for a lost camera, until it has a frame again.
  void lose(std::uint64_t cameras) const {
    for (std::size_t i = 0; i < handlers_.size(); ++i) {
      if ((cameras >> i & 1U) != 0) handlers_[i].trouble("it was lost in the run");
    }
  }

  void show(std::size_t camera, const CameraFrame& frame) const { handlers_[camera].frame(frame); }

 private:
  class Source final : public FrameSource {
   public:
    explicit Source(CameraFormat format) : format_(std::move(format)) {}
    [[nodiscard]] CameraFormat format() const override { return format_; }
    [[nodiscard]] std::int64_t dropped() const override { return 0; }

   private:
    CameraFormat format_;
  };

  const std::vector<Film>& films_;
  std::vector<CameraHandlers> handlers_;
};

std::vector<FilmPass::Film> FilmPass::openFilms(const std::vector<fs::path>& folders,
                                                const Experiment& experiment) {
  std::vector<Film> films;
  for (const Camera& camera : camerasOf(experiment)) films.emplace_back().camera = camera.name;
  bool any = false;
  std::optional<std::int64_t> start_utime;
  for (const fs::path& folder : folders) {
    FilmFacts facts = readFilmFacts(folder / film_files::kFacts);
    if (facts.start_utime != start_utime.value_or(facts.start_utime)) {
      throw CameraError(fmt::format(
          "{}: start_utime: found {}, expected {} as in {}: the films are not of one start",
          (folder / film_files::kFacts).string(), facts.start_utime, *start_utime,
          (folders.front() / film_files::kFacts).string()));
    }
    start_utime = facts.start_utime;
    const auto film = std::ranges::find(films, facts.camera, &Film::camera);
    if (film == films.end()) {
      throw CameraError(fmt::format(
          "{}: found a film of {}, which is no camera of the experiment; expected the names of the "
          "run",
          folder.string(), facts.camera.empty() ? "the only camera" : "camera " + facts.camera));
    }
    film->recorded = true;
    film->facts = std::move(facts);
    const fs::path movie = folder / film_files::kMovie;
    try {
      film->table = readFilmTable(filmTableOf(movie));
      requireNearStart(folder, *start_utime, film->table);
      film->reader = FilmReader::open(movie.string());
      any = true;
    } catch (const CameraError& error) {
      film->table.clear();
      film->problem = error.what();
      if (folders.size() == 1) throw;
    }
  }
  if (!any) throw CameraError(films.front().problem);
  return films;
}

std::vector<std::size_t> FilmPass::orderOf(const std::vector<Film>& films) {
  std::vector<std::vector<FilmFrame>> tables;
  for (const Film& film : films) tables.push_back(film.table);
  return orderOfArrival(tables);
}

std::int64_t FilmPass::startUtime() const {
  return std::ranges::find(films_, true, &Film::recorded)->facts.start_utime;
}

FilmPass::FilmPass(const std::vector<fs::path>& films, const Experiment& experiment,
                   const fs::path& directory, const std::vector<fs::path>& log)
    : films_(openFilms(films, experiment)),
      order_(orderOf(films_)),
      shown_utime_(startUtime()),
      log_(log),
      loop_(startUtime()),
      bus_([this] { return loop_.now(); }),
      node_(bus_, loop_, {"tracker_svc"}) {
  loop_.drainWith([this] { bus_.deliver(); });
  cameras_ = std::make_unique<FilmCameras>(films_);
  tracker_ = tracker::serviceDescription().make({.node = node_,
                                                 .loop = loop_,
                                                 .experiment = experiment,
                                                 .directory = directory,
                                                 .cameras = *cameras_});
  bus_.subscribe(channels::kTrackedFrame, [this](const Packet& packet) {
    static_cast<void>(decode(packet.data, rounds_.emplace_back().poses));
  });
  bus_.subscribe(channels::kTrackedDetails, [this](const Packet& packet) {
    if (!rounds_.empty()) static_cast<void>(decode(packet.data, rounds_.back().details));
  });
  bus_.subscribe(channels::kTrackerStatus, [this](const Packet& packet) {
    static_cast<void>(decode(packet.data, status_.emplace()));
  });
}

FilmPass::~FilmPass() = default;

bool FilmPass::next() {
  rounds_.clear();
  for (; position_ < order_.size(); ++position_) {
    Film& film = films_[order_[position_]];
    // The others go on without a film that is cut off.
    if (film.position == film.table.size()) continue;
    if (!film.reader->next(picture_)) {
      film.position = film.table.size();
      continue;
    }
    const FilmFrame& frame = film.table[film.position++];
    feedReports(frame);
    loop_.runUntil(frame.arrived_utime);
    shown_utime_ = frame.arrived_utime;
    picture_.number = frame.number;
    picture_.utime = frame.camera_utime;
    picture_.search = frame.searched;
    if (frame.lost_cameras != 0) cameras_->lose(frame.lost_cameras);
    cameras_->show(order_[position_++], picture_);
    bus_.deliver();
    return true;
  }
  return false;
}

void FilmPass::passTime(std::int64_t utime) {
  std::int64_t latest = shown_utime_ + kAfterFilms_us;
  for (std::size_t i = position_; i < order_.size(); ++i) {
    const Film& film = films_[order_[i]];
    if (film.position == film.table.size()) continue;
    latest = film.table[film.position].arrived_utime;
    break;
  }
  loop_.runUntil(std::min(utime, latest));
}

/// The next ROBOT_STATUS that the tracker can have received; none at the end of the log.
const std::optional<FilmPass::Report>& FilmPass::peekReport() {
  while (!report_) {
    const std::optional<Packet> packet = log_.next();
    if (!packet) break;
    // What came before the tracker was started, it did not receive.
    if (packet->channel != channels::kRobotStatus || packet->received_utime < startUtime()) {
      continue;
    }
    robot_status_t status{};
    if (!decode(packet->data, status)) continue;
    report_ = Report{{packet->data.begin(), packet->data.end()},
                     packet->received_utime,
                     status.instance,
                     status.seq};
  }
  return report_;
}

/// Gives the tracker what the robots reported, up to the last ROBOT_STATUS that it had in the run.
void FilmPass::feedReports(const FilmFrame& frame) {
  while (frame.status_seq != 0 &&
         !(fed_instance_ == frame.status_instance && fed_seq_ == frame.status_seq)) {
    const std::optional<Report>& report = peekReport();
    if (!report) return;
    // The log lacks that message.
    if (report->received_utime > frame.arrived_utime + kReportMargin_us) return;
    if (report->instance == frame.status_instance && report->seq > frame.status_seq) return;
    fed_instance_ = report->instance;
    fed_seq_ = report->seq;
    loop_.runUntil(std::min(report->received_utime, frame.arrived_utime));
    bus_.publish(channels::kRobotStatus, report->data);
    bus_.deliver();
    report_.reset();
  }
}

bool FilmPass::lossless() const {
  return std::ranges::all_of(
      films_, [](const Film& film) { return !film.recorded || film.facts.lossless(); });
}

std::int64_t FilmPass::firstUtime() const {
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  for (const Film& film : films_) {
    if (!film.table.empty()) first = std::min(first, film.facts.first_utime);
  }
  return first;
}

std::string FilmPass::lacking() const {
  if (films_.size() == 1) return {};
  std::string text;
  for (const Film& film : films_) {
    const std::int64_t frames = film.facts.lost + film.facts.after_end;
    if (film.recorded && frames == 0) continue;
    text +=
        (text.empty() ? "" : "; ") +
        (film.recorded ? fmt::format("the film of camera {} lacks {} frames", film.camera, frames)
                       : fmt::format("camera {} has no film", film.camera));
  }
  return text;
}

std::string FilmPass::problem() const {
  std::string text;
  for (const Film& film : films_) {
    std::string problem = film.problem;
    if (film.reader) {
      problem = film.reader->problem();
      const auto length = static_cast<std::size_t>(film.reader->length());
      if (problem.empty() && length < film.table.size()) {
        problem = fmt::format("{}: {} frames could be read, its table has {}: was the run killed?",
                              film_files::kMovie, length, film.table.size());
      }
    }
    if (problem.empty()) continue;
    text += text.empty() ? "" : "; ";
    text += film.camera.empty() ? problem : "camera " + film.camera + ": " + problem;
  }
  return text;
}

}  // namespace lab::runner
