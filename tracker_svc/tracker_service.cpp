#include "tracker_svc/tracker_service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lab/light_seen_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_state_t.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/math/units.hpp"
#include "tracker_svc/camera_devices.hpp"
#include "tracker_svc/cap_spacings.hpp"
#include "tracker_svc/detector/scale_map.hpp"
#include "tracker_svc/marker_tracking.hpp"
#include "tracker_svc/several_cameras_service.hpp"
#include "tracker_svc/tracker_setup.hpp"

namespace lab::tracker {
namespace {

constexpr std::int64_t kReportEvery_us = 1'000'000;
constexpr std::int64_t kSearchEvery_us = 1'000'000;
constexpr std::int64_t kOtherTracker_us = 2'000'000;
constexpr std::int64_t kListen_us = 300'000;

std::string sizeText(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

TrackerService::TrackerService(const ServiceContext& context)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      calibration_(calibrationInForce(context, context.experiment.camera)),
      markers_(markersOf(experiment_)),
      detector_(makeMarkerDetector(markers_, optics::CameraModel(calibration_.camera),
                                   calibration_.cap, imagingOf(calibration_))),
      gamma_(imagingOf(calibration_).gamma.value_or(1)),
      tracker_(makeMarkerTracker(markers_, trackerSettings(context.experiment),
                                 robotsInView(context.experiment))),
      spacing_(spacingSettings(calibration_)),
      pictures_(imagingOf(calibration_).black),
      blind_(static_cast<double>(
                 detector::ScaleMap(detector_->camera(), calibration_.cap).smallest()) *
                 calibration_.cap.small_radius,
             imagingOf(calibration_).black),
      robots_(robotsInView(context.experiment).size()),
      origin_(originOf(experiment_.camera)),
      origin_utime_(context.loop.now()),
      // A tracker that is already running is noticed within a few frames.
      other_until_(loop_.isVirtual() ? 0 : loop_.now() + kListen_us) {
  try {
    debug_ = openDebugOutput(loop_, experiment_.camera.debug_port, detector_->camera(),
                             markers_.outline(calibration_.cap));
  } catch (const std::runtime_error& error) {  // tracking works without the debug view
    node_.noteError(std::string(error.what()) + ": no debug view");
  }
  if (markers_.kind == detector::MarkerKind::kCaps && !imagingOf(calibration_).gamma) {
    response_.emplace(detector_->camera(), calibration_.cap, imagingOf(calibration_));
  }
  status_.camera = experiment_.camera.source;
  status_.state = tracker_status_t::WAITING;
  status_.calibration_id = calibration_.id;
  node_.subscribe<robot_status_t>(channels::kRobotStatus,
                                  [this](const robot_status_t& status) { handle(status); });
  node_.subscribe<tracked_frame_t>(
      channels::kTrackedFrame, [this](const tracked_frame_t& frame) { watchOtherTracker(frame); });
  if (experiment_.projector.sync_patch > 0) {
    sync_.emplace(detector_->camera());
    node_.subscribe<light_status_t>(channels::kLightStatus, [this](const light_status_t& status) {
      if (status.sync < 0) return;
      // The instance and the sequence number together identify a new light command.
      sync_->reportChange(seconds(status.utime), status.sync,
                          status.command_instance ^ status.command_seq, status.moving == 0);
    });
  }
  if (isFilmed(experiment_.camera)) {
    film_.emplace(context.directory, experiment_.camera.film, origin_utime_, loop_.isVirtual());
  }
  source_ = context.cameras.open(experiment_.camera.source, wantedFormat(experiment_.camera),
                                 {.frame = [this](const CameraFrame& frame) { handle(frame); },
                                  .trouble = [this](const std::string& what) { trouble(what); },
                                  .end = [this](const std::string& problem) { ended(problem); }});
  loop_.every(kReportEvery_us, loop_.now() + kReportEvery_us, [this] { report(); });
  loop_.soon([this] { node_.ready(); });
}

double TrackerService::seconds(std::int64_t utime) const {
  return units::seconds(utime - origin_utime_);
}

void TrackerService::handle(const robot_status_t& status) {
  wheels_.clear();
  for (const robot_state_t& robot : status.robots) {
    wheels_.push_back({robot.robot_id, seconds(robot.utime), robot.wheel_left, robot.wheel_right});
  }
  tracker_->addReports(wheels_);
  status_instance_ = status.instance;
  status_seq_ = status.seq;
}

void TrackerService::watchOtherTracker(const tracked_frame_t& frame) {
  const NodeIdentity& own = node_.identity();
  if (frame.sender != own.name || frame.instance == own.instance) return;
  const bool first = !silent_;
  // The tracker that was started first continues.
  if (frame.instance < own.instance) other_until_ = loop_.now() + kOtherTracker_us;
  if (!first || frame.instance > own.instance) return;
  silent_ = true;
  warn("another tracker (instance " + std::to_string(frame.instance) +
       ") publishes in this lab: this one stays silent until that one is stopped");
}

void TrackerService::handle(const CameraFrame& frame) {
  const optics::CameraParameters& camera = calibration_.camera;
  if (frame.grey.width != camera.width || frame.grey.height != camera.height) {
    trouble("pictures of " + sizeText(frame.grey.width, frame.grey.height) +
            " pixels, but the "
            "calibration " +
            calibration_.id + " is of " + sizeText(camera.width, camera.height) +
            ": set width_px and height_px, or run lab calibrate camera again");
    return;
  }
  if (status_.state == tracker_status_t::GONE) trouble("");
  const std::int64_t arrived = loop_.now();
  std::int64_t utime = frame.utime;
  if (origin_ == robot_state_t::REPLAY) {  // times of a recording count from its first picture
    if (file_utime_ == 0) file_utime_ = arrived - frame.utime;
    utime += file_utime_;
  }
  if (utime <= last_utime_) return;  // a reconnected camera may deliver an older picture
  last_utime_ = utime;
  const bool begins = status_.state != tracker_status_t::RUNNING;
  status_.state = tracker_status_t::RUNNING;
  if (begins && source_) {
    detector_->setCompressed(source_->format().compressed);
    if (response_) response_->setCompressed(source_->format().compressed);
  }
  ++status_.frames;
  const Exposure exposure = pictures_.look(frame.grey);
  status_.brightness = exposure.brightness;
  findResponse(frame.grey);
  const std::vector<Track>& tracks = track(frame, seconds(utime), arrived, exposure);
  film(frame, utime, arrived);
  if (loop_.now() >= other_until_) {
    if (std::exchange(silent_, false)) trouble("");
    publish(frame, utime, tracks);
    readSync(frame, utime);
  }
  latency_.add(units::seconds(loop_.now() - arrived));
  if (begins) report();
}

void TrackerService::findResponse(const optics::GreyView& picture) {
  if (!response_) return;
  response_->examine(picture);
  const double gamma = response_->gamma().value_or(gamma_);
  if (std::exchange(gamma_, gamma) != gamma) detector_->setGamma(gamma);
  if (response_->isSettled()) response_.reset();
}

void TrackerService::film(const CameraFrame& frame, std::int64_t utime, std::int64_t arrived) {
  if (!film_) return;
  film_->add({.number = frame.number,
              .camera_utime = frame.utime,
              .arrived_utime = arrived,
              .searched = searched_,
              .status_instance = status_instance_,
              .status_seq = status_seq_},
             utime, frame.grey, source_ ? source_->format() : wantedFormat(experiment_.camera));
}

const std::vector<Track>& TrackerService::track(const CameraFrame& frame, double time,
                                                std::int64_t now, const Exposure& exposure) {
  const optics::GreyView& picture = frame.grey;
  const std::vector<detector::Expected>& expected = tracker_->expect(time);
  const bool draw = debug_ && debug_->wanted();
  std::vector<detector::Rejection> rejected;
  const std::vector<detector::Detection>* found = nullptr;
  searched_ = draw || frame.search || !all_detected_ || now >= next_search_;
  if (searched_) {
    found = &detector_->search(picture, draw ? &rejected : nullptr, expected);
    next_search_ = now + kSearchEvery_us;
  } else {
    found = &detector_->follow(picture, expected);
    const auto missing = [](const detector::Detection& cap) { return cap.quality <= 0; };
    if (std::ranges::any_of(*found, missing))
      found = &detector_->search(picture, nullptr, expected);
  }
  const std::vector<Track>& tracks = tracker_->update(time, *found);
  std::size_t detected = 0;
  for (const Track& one : tracks) {
    if (!one.detected) continue;
    ++detected;
    if (addSpacing(spacing_, time, one.pose, calibration_.cap.spacing())) ++status_.spacings;
  }
  all_detected_ = detected >= robots_ && detected == tracks.size();
  blind_.add(time, exposure, detected > 0 || robots_ == 0);
  if (draw) {
    debug_->show(picture, tracks, rejected,
                 std::to_string(detected) + " markers of " + std::to_string(robots_));
  }
  return tracks;
}

void TrackerService::publish(const CameraFrame& frame, std::int64_t utime,
                             const std::vector<Track>& tracks) {
  tracked_frame_t message{};
  tracked_details_t details{};
  message.utime = utime;
  message.origin = origin_;
  message.frame = frame.number;
  const double fps = source_ ? source_->format().fps : 0;
  message.frame_period = 1 / (fps > 0 ? fps : experiment_.camera.fps);
  addTracks(tracks, message, details);
  node_.publish(channels::kTrackedFrame, message);
  details.utime = utime;
  details.frame = frame.number;
  node_.publish(channels::kTrackedDetails, details);
  status_.caps = details.num_caps;
  status_.unbound = message.num_unidentified;
}

void TrackerService::readSync(const CameraFrame& frame, std::int64_t utime) {
  if (!sync_) return;
  const std::optional<SyncReading> reading = sync_->look(frame.grey, seconds(utime));
  if (!reading) return;
  light_seen_t message{};
  message.utime = utime;
  message.frame = frame.number;
  message.level = reading->level;
  message.sync = reading->sync;
  node_.publish(channels::kLightSeen, message);
}

void TrackerService::warn(const std::string& what) {
  status_.trouble = what;
  node_.fault(what);
  report();
}

void TrackerService::trouble(const std::string& what) {
  if (what == status_.trouble) return;
  if (what.empty()) {
    if (silent_) return;
    status_.trouble.clear();
    node_.ready();
    return;
  }
  status_.state = tracker_status_t::GONE;
  all_detected_ = false;
  warn(what);
}

void TrackerService::ended(const std::string& problem) {
  status_.state = tracker_status_t::ENDED;
  if (!problem.empty()) return warn(problem);
  report();
}

void TrackerService::report() {
  if (silent_) return;  // the other tracker publishes
  const CameraFormat format = source_ ? source_->format() : wantedFormat(experiment_.camera);
  status_.width = format.width;
  status_.height = format.height;
  status_.fps = format.fps;
  status_.exposure = format.exposure;
  status_.gain = format.gain;
  status_.pixels =
      gamma_ == 1 ? format.pixels : fmt::format("{}, gamma {:g}", format.pixels, gamma_);
  status_.locked = format.locked ? 1 : 0;
  status_.dropped = source_ ? source_->dropped() : 0;
  status_.dark = pictures_.dark();
  status_.saturated = pictures_.saturated();
  const TrackerCounts& counts = tracker_->counts();
  status_.bindings = counts.bound;
  status_.unbindings = counts.unbound;
  status_.flips = counts.flips;
  status_.lost = counts.lost;
  const calibration::SpacingReport spacing = spacing_.report(seconds(loop_.now()));
  status_.spacing_error = spacing.mean_error;
  status_.spacing_sigma = spacing.sigma;
  const std::string warning = spacing.text.empty() ? blind_.text() : spacing.text;
  if (!warning.empty() && status_.warning.empty()) node_.noteError(warning);
  status_.moved = spacing.moved || !spacing.fits ? 1 : 0;
  status_.warning = warning;
  const Percentiles latency = latency_.percentiles();
  status_.latency_p50 = latency.p50;
  status_.latency_p95 = latency.p95;
  status_.latency_p99 = latency.p99;
  if (const std::string news = film_ ? film_->news() : ""; !news.empty()) node_.noteError(news);
  status_.utime = 0;
  node_.publish(channels::kTrackerStatus, status_);
}

ServiceDescription serviceDescription() {
  return {.name = "tracker_svc",
          .summary = "A camera's pictures to poses of all robots",
          .origin = robot_state_t::UNKNOWN,
          .make = [](const ServiceContext& context) -> std::unique_ptr<Service> {
            if (!context.experiment.cameras.empty()) {
              return std::make_unique<SeveralCamerasService>(context);
            }
            return std::make_unique<TrackerService>(context);
          },
          .uses_ports = usesPorts("tracker_svc")};
}

}  // namespace lab::tracker
