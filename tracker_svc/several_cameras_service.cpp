#include "tracker_svc/several_cameras_service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lab/light_seen_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/math/units.hpp"
#include "tracker_svc/camera_devices.hpp"
#include "tracker_svc/cap_spacings.hpp"
#include "tracker_svc/detector/picture_check.hpp"
#include "tracker_svc/marker_tracking.hpp"
#include "tracker_svc/tracker_setup.hpp"

namespace lab::tracker {
namespace {

constexpr std::int64_t kStatusEvery_us = 1'000'000;
constexpr double kMillisecond = 1e-3;
constexpr double kMillimetre = 1e-3;

}  // namespace

/// One of the cameras.
struct SeveralCamerasService::Input {
  Input(Camera the_camera, CameraCalibration the_calibration,
        const detector::MarkerSettings& markers)
      : camera(std::move(the_camera)),
        calibration(std::move(the_calibration)),
        detector(makeMarkerDetector(markers, optics::CameraModel(calibration.camera),
                                    calibration.cap, imagingOf(calibration))),
        gamma(imagingOf(calibration).gamma.value_or(1)),
        spacing(spacingSettings(calibration)),
        pictures(imagingOf(calibration).black) {
    if (markers.kind == detector::MarkerKind::kCaps && !imagingOf(calibration).gamma) {
      response.emplace(detector->camera(), calibration.cap, imagingOf(calibration));
    }
  }

  Camera camera;
  CameraCalibration calibration;
  std::unique_ptr<detector::MarkerDetector> detector;
  std::optional<detector::ResponseFinder> response;  ///< while it is not known
  double gamma;                                      ///< assumed until then
  calibration::SpacingCheck spacing;
  PictureCheck pictures;
  std::unique_ptr<FrameSource> source;
  std::int64_t last_utime = 0;
  std::int64_t frames = 0;
  bool ended = false;
  std::string lost;  ///< why, empty: it is not
};

SeveralCamerasService::SeveralCamerasService(const ServiceContext& context)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      markers_(markersOf(experiment_)),
      fusion_(camerasOf(experiment_).size()),
      tracker_(
          makeMarkerTracker(markers_, trackerSettings(experiment_), robotsInView(experiment_))),
      origin_(originOf(experiment_.camera)),
      origin_utime_(context.loop.now()) {
  for (const Camera& camera : camerasOf(experiment_)) {
    if (!isPainted(camera) && isFilm(camera.source)) {
      throw CameraError(camera.source +
                        ": found a film among several cameras, allowed live cameras; track each "
                        "film with lab track");
    }
    inputs_.push_back(
        std::make_unique<Input>(camera, calibrationInForce(context, camera), markers_));
  }
  status_.state = tracker_status_t::WAITING;
  for (const auto& input : inputs_) {
    status_.calibration_id += (status_.calibration_id.empty() ? "" : ", ") + input->calibration.id;
  }
  if (isFilmed(experiment_.camera)) {
    std::vector<std::string> names;
    for (const auto& input : inputs_) names.push_back(input->camera.name);
    film_.emplace(context.directory, experiment_.camera.film, origin_utime_, loop_.isVirtual(),
                  names);
  }
  node_.subscribe<robot_status_t>(channels::kRobotStatus,
                                  [this](const robot_status_t& status) { handle(status); });
  if (experiment_.projector.sync_patch > 0) watchLight();
  for (std::size_t i = 0; i < inputs_.size(); ++i) open(i, context.cameras);
  loop_.every(kStatusEvery_us, loop_.now() + kStatusEvery_us, [this] { report(); });
  loop_.soon([this] { node_.ready(); });
}

SeveralCamerasService::~SeveralCamerasService() = default;

void SeveralCamerasService::open(std::size_t i, Cameras& cameras) {
  Input& input = *inputs_[i];
  input.source =
      cameras.open(input.camera.source, wantedFormat(input.camera),
                   {.frame = [this, i](const CameraFrame& frame) { handle(i, frame); },
                    .trouble = [this, i](const std::string& what) { trouble(i, what); },
                    .end = [this, i](const std::string& problem) { ended(i, problem); }});
}

double SeveralCamerasService::seconds(std::int64_t utime) const {
  return units::seconds(utime - origin_utime_);
}

void SeveralCamerasService::handle(const robot_status_t& status) {
  wheels_.clear();
  for (const robot_state_t& robot : status.robots) {
    wheels_.push_back({robot.robot_id, seconds(robot.utime), robot.wheel_left, robot.wheel_right});
  }
  tracker_->addReports(wheels_);
  status_instance_ = status.instance;
  status_seq_ = status.seq;
}

void SeveralCamerasService::handle(std::size_t i, const CameraFrame& frame) {
  Input& input = *inputs_[i];
  const optics::CameraParameters& expected = input.calibration.camera;
  if (frame.grey.width != expected.width || frame.grey.height != expected.height) {
    return trouble(i, fmt::format("pictures of {} x {} pixels, but its calibration {} is of {} x "
                                  "{}: set width_px and height_px, or calibrate it again",
                                  frame.grey.width, frame.grey.height, input.calibration.id,
                                  expected.width, expected.height));
  }
  if (frame.utime <= input.last_utime) return;  // a reconnected camera may deliver an older picture
  input.last_utime = frame.utime;
  const std::int64_t arrived = loop_.now();
  const std::uint64_t lost_cameras = lostCameras();
  if (!input.lost.empty()) trouble(i, "");
  if (input.frames++ == 0 && input.source) {
    input.detector->setCompressed(input.source->format().compressed);
    if (input.response) input.response->setCompressed(input.source->format().compressed);
  }
  status_.brightness = input.pictures.look(frame.grey).brightness;
  findResponse(input, frame.grey);
  const double time = seconds(frame.utime);
  const std::vector<detector::Detection>& found =
      input.detector->search(frame.grey, nullptr, tracker_->expect(time));
  for (const detector::Detection& cap : found) {
    if (addSpacing(input.spacing, time, cap, input.calibration.cap.spacing())) ++status_.spacings;
  }
  for (const FusedRound& round : fusion_.add(i, time, found)) publish(round);
  film(i, frame, arrived, lost_cameras);
  readSync(input, frame);
  noteSilent();
  latency_.add(units::seconds(loop_.now() - arrived));
}

/// Those that rounds do not wait for.
std::uint64_t SeveralCamerasService::lostCameras() const {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (!fusion_.isAlive(i)) bits |= std::uint64_t{1} << i;
  }
  return bits;
}

void SeveralCamerasService::film(std::size_t i, const CameraFrame& frame, std::int64_t arrived,
                                 std::uint64_t lost_cameras) {
  if (!film_) return;
  const Input& input = *inputs_[i];
  film_->add({.number = frame.number,
              .camera_utime = frame.utime,
              .arrived_utime = arrived,
              .searched = true,
              .status_instance = status_instance_,
              .status_seq = status_seq_,
              .lost_cameras = lost_cameras},
             frame.utime, frame.grey,
             input.source ? input.source->format() : wantedFormat(input.camera), i);
}

void SeveralCamerasService::findResponse(Input& input, const optics::GreyView& picture) {
  if (!input.response) return;
  input.response->examine(picture);
  const double gamma = input.response->gamma().value_or(input.gamma);
  if (std::exchange(input.gamma, gamma) != gamma) input.detector->setGamma(gamma);
  if (input.response->isSettled()) input.response.reset();
}

void SeveralCamerasService::publish(const FusedRound& round) {
  const std::vector<Track>& tracks = tracker_->update(round.time, round.detections);
  tracked_frame_t message{};
  tracked_details_t details{};
  message.utime = origin_utime_ + units::microseconds(round.time);
  message.origin = origin_;
  message.frame = status_.frames;
  message.frame_period = 1 / experiment_.camera.fps;
  addTracks(tracks, message, details);
  node_.publish(channels::kTrackedFrame, message);
  details.utime = message.utime;
  details.frame = message.frame;
  node_.publish(channels::kTrackedDetails, details);
  status_.caps = details.num_caps;
  status_.unbound = message.num_unidentified;
  ++status_.frames;
  if (std::exchange(status_.state, tracker_status_t::RUNNING) != tracker_status_t::RUNNING) {
    report();
  }
}

/// The first camera that sees the corner with the sync patch times the light.
void SeveralCamerasService::watchLight() {
  for (const auto& input : inputs_) {
    const optics::CameraModel& model = input->detector->camera();
    const optics::Pixel corner = model.project(0, 0, 0);
    const optics::CameraParameters& picture = model.parameters();
    if (corner.x < 0 || corner.x > picture.width - 1 || corner.y < 0 ||
        corner.y > picture.height - 1) {
      continue;
    }
    sync_.emplace(model);
    sync_input_ = input.get();
    break;
  }
  if (!sync_) return;
  node_.subscribe<light_status_t>(channels::kLightStatus, [this](const light_status_t& status) {
    if (status.sync < 0) return;
    sync_->reportChange(seconds(status.utime), status.sync,
                        status.command_instance ^ status.command_seq, status.moving == 0);
  });
}

void SeveralCamerasService::readSync(const Input& input, const CameraFrame& frame) {
  if (sync_input_ != &input) return;
  const std::optional<SyncReading> reading = sync_->look(frame.grey, seconds(frame.utime));
  if (!reading) return;
  light_seen_t message{};
  message.utime = frame.utime;
  message.frame = frame.number;
  message.level = reading->level;
  message.sync = reading->sync;
  node_.publish(channels::kLightSeen, message);
}

void SeveralCamerasService::lose(std::size_t i, const std::string& why) {
  Input& input = *inputs_[i];
  fusion_.lose(i);
  if (!std::exchange(input.lost, why).empty()) return;
  node_.noteError("camera " + input.camera.name + " is lost: " + why);
  report();
}

/// Cameras that send nothing although the others do.
void SeveralCamerasService::noteSilent() {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (!fusion_.isAlive(i) && inputs_[i]->lost.empty()) lose(i, "it sends no pictures");
  }
}

void SeveralCamerasService::trouble(std::size_t i, const std::string& what) {
  Input& input = *inputs_[i];
  if (!what.empty()) return lose(i, what);
  if (std::exchange(input.lost, "").empty()) return;
  node_.noteError("camera " + input.camera.name + " is back");
  report();
}

void SeveralCamerasService::ended(std::size_t i, const std::string& problem) {
  inputs_[i]->ended = true;
  lose(i, problem.empty() ? "it has ended" : problem);
}

std::string SeveralCamerasService::lostText() const {
  std::string text;
  for (const auto& input : inputs_) {
    if (input->lost.empty()) continue;
    text += (text.empty() ? "camera " : "; camera ") + input->camera.name + " is lost (" +
            input->lost + "): its part of the arena is not seen";
  }
  return text;
}

void SeveralCamerasService::report() {
  const auto lost = [](const auto& input) { return !input->lost.empty(); };
  const auto finished = [](const auto& input) { return input->ended; };
  const bool none = std::ranges::all_of(inputs_, lost);
  if (none) {
    status_.state =
        std::ranges::all_of(inputs_, finished) ? tracker_status_t::ENDED : tracker_status_t::GONE;
  }
  const std::string trouble = none ? lostText() : std::string();
  if (std::exchange(status_.trouble, trouble) != trouble) {
    none ? node_.fault(trouble) : node_.ready();
  }
  status_.camera.clear();
  status_.warning = none ? std::string() : lostText();
  status_.dropped = status_.dark = status_.saturated = 0;
  status_.moved = 0;
  status_.spacing_error = status_.spacing_sigma = 0;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    Input& input = *inputs_[i];
    const ClockOffset& clock = fusion_.offsets()[i];
    status_.camera += (i > 0 ? ", " : "") + input.camera.name;
    if (i > 0 && std::isfinite(clock.sigma)) {
      const ViewError& wrong = fusion_.errors()[i];
      status_.camera +=
          fmt::format(" (clock {:+.3f} +- {:.3f} ms, calibration {:+.2f}, {:+.2f} mm)",
                      clock.offset / kMillisecond, clock.sigma / kMillisecond,
                      wrong.shift.x() / kMillimetre, wrong.shift.y() / kMillimetre);
    }
    status_.dropped += input.source ? input.source->dropped() : 0;
    status_.dark += input.pictures.dark();
    status_.saturated += input.pictures.saturated();
    const calibration::SpacingReport spacing = input.spacing.report(seconds(loop_.now()));
    if (std::abs(spacing.mean_error) >= std::abs(status_.spacing_error)) {  // the worst camera
      status_.spacing_error = spacing.mean_error;
      status_.spacing_sigma = spacing.sigma;
    }
    if (spacing.moved || !spacing.fits) status_.moved = 1;
    if (!spacing.text.empty()) {
      status_.warning +=
          (status_.warning.empty() ? "" : "; ") + input.camera.name + ": " + spacing.text;
    }
  }
  const CameraFormat format =
      inputs_[0]->source ? inputs_[0]->source->format() : wantedFormat(inputs_[0]->camera);
  status_.width = format.width;
  status_.height = format.height;
  status_.fps = format.fps;
  status_.exposure = format.exposure;
  status_.gain = format.gain;
  status_.pixels = format.pixels;
  status_.locked = format.locked ? 1 : 0;
  const TrackerCounts& counts = tracker_->counts();
  status_.bindings = counts.bound;
  status_.unbindings = counts.unbound;
  status_.flips = counts.flips;
  status_.lost = counts.lost;
  const Percentiles latency = latency_.percentiles();
  status_.latency_p50 = latency.p50;
  status_.latency_p95 = latency.p95;
  status_.latency_p99 = latency.p99;
  if (const std::string news = film_ ? film_->news() : ""; !news.empty()) node_.noteError(news);
  status_.utime = 0;
  node_.publish(channels::kTrackerStatus, status_);
}

}  // namespace lab::tracker
