#include "runner/film/film_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <lab/robot_status_t.hpp>
#include <string_view>
#include <utility>

#include "common/bus/channels.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

/// A message that the log lacks is not searched for longer than this in it [us].
constexpr std::int64_t kReportMargin_us = 1'000'000;

}  // namespace

/// Gives the frames of the film to the tracker, whatever camera its experiment names.
class FilmPass::FilmCameras final : public Cameras {
 public:
  explicit FilmCameras(CameraFormat format) : format_(std::move(format)) {}

  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string&, const CameraFormat&,
                                                  CameraHandlers handlers) override {
    handlers_ = std::move(handlers);
    return std::make_unique<Source>(format_);
  }
  [[nodiscard]] std::unique_ptr<FrameSink> offer(const CameraFormat&) override {
    throw CameraError("sim: a film is tracked, nothing is painted");
  }

  void show(const CameraFrame& frame) const { handlers_.frame(frame); }

 private:
  class Source final : public FrameSource {
   public:
    explicit Source(const CameraFormat& format) : format_(format) {}
    [[nodiscard]] CameraFormat format() const override { return format_; }
    [[nodiscard]] std::int64_t dropped() const override { return 0; }

   private:
    const CameraFormat& format_;
  };

  CameraFormat format_;
  CameraHandlers handlers_;
};

FilmPass::FilmPass(const fs::path& film, const Experiment& experiment, const fs::path& directory,
                   const std::vector<fs::path>& log)
    : facts_(readFilmFacts(film / film_files::kFacts)),
      table_(readFilmTable(filmTableOf(film / film_files::kMovie))),
      reader_(FilmReader::open((film / film_files::kMovie).string())),
      log_(log),
      loop_(facts_.start_utime),
      bus_([this] { return loop_.now(); }),
      node_(bus_, loop_, {"tracker_svc"}) {
  loop_.drainWith([this] { bus_.deliver(); });
  CameraFormat format = facts_.format;
  format.compressed = format.compressed || !facts_.lossless();
  cameras_ = std::make_unique<FilmCameras>(format);
  tracker_ = std::make_unique<tracker::TrackerService>(ServiceContext{.node = node_,
                                                                      .loop = loop_,
                                                                      .experiment = experiment,
                                                                      .directory = directory,
                                                                      .cameras = *cameras_});
  const auto keep = [this]<class Message>(std::string_view channel, Message& into) {
    bus_.subscribe(channel,
                   [&into](const Packet& packet) { static_cast<void>(decode(packet.data, into)); });
  };
  keep(channels::kTrackedFrame, poses_);
  keep(channels::kTrackedDetails, details_);
  bus_.subscribe(channels::kTrackerStatus, [this](const Packet& packet) {
    static_cast<void>(decode(packet.data, status_.emplace()));
  });
}

bool FilmPass::next() {
  if (position_ >= table_.size() || !reader_->next(picture_)) return false;
  const FilmFrame& frame = table_[position_++];
  feedReports(frame);
  loop_.runUntil(frame.arrived_utime);
  picture_.number = frame.number;
  picture_.utime = frame.camera_utime;
  picture_.search = frame.searched;
  cameras_->show(picture_);
  bus_.deliver();
  return true;
}

void FilmPass::passTime(std::int64_t utime) {
  const bool more = position_ < table_.size();
  loop_.runUntil(more ? std::min(utime, table_[position_].arrived_utime) : utime);
}

/// The next ROBOT_STATUS that the tracker can have received; none at the end of the log.
const std::optional<FilmPass::Report>& FilmPass::peekReport() {
  while (!report_) {
    const std::optional<Packet> packet = log_.next();
    if (!packet) break;
    // What came before the tracker was started, it did not receive.
    if (packet->channel != channels::kRobotStatus || packet->received_utime < facts_.start_utime) {
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

std::string FilmPass::problem() const {
  if (std::string problem = reader_->problem(); !problem.empty()) return problem;
  const auto length = static_cast<std::size_t>(reader_->length());
  if (length >= table_.size()) return {};
  return fmt::format("{}: {} frames could be read, its table has {}: was the run killed?",
                     film_files::kMovie, length, table_.size());
}

}  // namespace lab::runner
