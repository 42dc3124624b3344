#include "runner/campaign/campaign_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "common/bus/log_file.hpp"
#include "common/calibration/light_file.hpp"
#include "common/calibration/projector_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_log_size.hpp"
#include "common/files/file_text.hpp"
#include "common/files/mapped_file.hpp"
#include "light/field/image.hpp"
#include "runner/command_line/command_line_parts.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

/// SHA-256 of a file that may be larger than the memory.
std::string sha256OfLarge(const fs::path& path) {
  constexpr std::size_t kPart = 1 << 24;  // bytes
  MappedFile file(path, "log");
  std::size_t at = 0;
  return light::sha256([&] {
    const auto part = file.part(at, std::min(kPart, file.bytes().size() - at));
    file.release(part.data());
    at += part.size();
    return part;
  });
}

/// Files by the path in the experiment, each read once.
class FileCollector {
 public:
  explicit FileCollector(fs::path source) : source_(std::move(source)) {}

  /// Replaces a path of the experiment by the file's name in the campaign.
  void adopt(std::string& path, const FileKind& kind) {
    if (path.empty()) return;
    const auto known = names_.find(path);
    if (known == names_.end()) {
      const fs::path file = source_ / path;
      std::string content = readFileText(file, kind);
      const std::string name = nameFor(sha256Of(content), file);
      files_[name] = {std::move(content), {}};
      names_[path] = name;
    }
    path = names_.at(path);
  }

  /// The same for a recording, which may be large. Its name has the hash of its content too.
  void adoptRecording(std::string& path) {
    if (path.empty()) return;
    const auto known = names_.find(path);
    if (known == names_.end()) {
      fs::path log = source_ / path;
      if (fs::is_directory(log)) log /= files::kLog;
      if (!isLog(log)) {
        throw UserError(fmt::format(
            "found no log in {}, expected the folder of a run or a log, relative to the experiment "
            "file",
            (source_ / path).string()));
      }
      const std::string name = nameFor(sha256OfLarge(log), log);
      files_[name] = {{}, fs::canonical(log)};
      names_[path] = name;
    }
    path = names_.at(path);
  }

  CampaignFiles take() { return std::move(files_); }

 private:
  static std::string nameFor(const std::string& hash, const fs::path& file) {
    return (fs::path(names::kFiles) / (hash + file.extension().string())).string();
  }

  fs::path source_;
  std::map<std::string, std::string> names_;
  CampaignFiles files_;
};

void adoptFiles(Experiment& experiment, FileCollector& files) {
  files.adopt(experiment.hardware.motors, file_kinds::kCalibration);
  files.adopt(experiment.camera.calibration, file_kinds::kCalibration);
  for (CameraSpec& camera : experiment.cameras) {
    files.adopt(camera.calibration, file_kinds::kCalibration);
  }
  files.adopt(experiment.camera.frames, file_kinds::kFrameTable);
  files.adopt(experiment.projector.calibration, file_kinds::kCalibration);
  files.adopt(experiment.projector.light_calibration, file_kinds::kCalibration);
  for (RobotSpec& robot : experiment.robots) files.adoptRecording(robot.log);
  for (LightStep& step : experiment.light.steps) {
    for (LayerSpec& layer : step.layers) {
      files.adopt(layer.image, file_kinds::kImage);
      for (std::string& image : layer.drive.images) files.adopt(image, file_kinds::kImage);
    }
  }
}

/// A simulated run of a campaign has neither network nor page: these keys decide nothing.
void leaveOutNetwork(Experiment& experiment) {
  experiment.network = {};
  experiment.gateway = {};
  experiment.link = {};
  experiment.dashboard = {};
  experiment.hosts.clear();
  experiment.services.clear();
}

void requireVirtual(const Experiment& experiment) {
  for (const RobotSpec& robot : experiment.robots) {
    if (robot.body != Body::kSerial) continue;
    throw UserError(fmt::format(
        "robots: robot {} is a real one (body = \"serial\"), and the runs of this campaign are "
        "simulated in virtual time; set body = \"sim\", or play them on the lab with --live",
        robot.id));
  }
  if (experiment.camera.tracker == Tracker::kCamera && !isPainted(experiment.camera)) {
    throw UserError(fmt::format(
        "camera.camera = \"{}\": the runs of this campaign are simulated in virtual time, where "
        "there "
        "is only the simulated camera; set camera = \"sim\", or play them on the lab with --live",
        experiment.camera.source));
  }
}

/// What prepareRun() checks, before the first run.
void requireUsable(const Experiment& experiment, const fs::path& source, bool live) {
  if (!live) requireVirtual(experiment);
  checkFiles(experiment, source);
}

std::vector<std::string> settingsOf(const Request& request, const std::vector<Axis>& axes,
                                    const PointValues& values) {
  std::vector<std::string> settings = request.set;
  for (std::size_t i = 0; i < axes.size(); ++i) settings.push_back(axes[i].key + "=" + values[i]);
  return settings;
}

void requireNotSet(const Request& request, const std::vector<Axis>& axes) {
  for (const std::string& setting : request.set) {
    for (const Axis& axis : axes) {
      if (!hasSetting({setting}, axis.key)) continue;
      throw UserError(fmt::format(
          "--set {}: the key is swept (--over {}=...), expected one of them", setting, axis.key));
    }
  }
}

/// Text of a point for messages: "programs.NAME.eta_rad_s=3, duration_s=60".
std::string pointText(const std::vector<Axis>& axes, const PointValues& values) {
  std::string text;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    text += (i == 0 ? "" : ", ") + axes[i].key + "=" + values[i];
  }
  return text;
}

/// @throws ExperimentError, UserError that name the point
Experiment checkedExperiment(const std::string& text, const Request& request,
                             const std::vector<Axis>& axes, const PointValues& values,
                             const fs::path& source) {
  try {
    Experiment experiment =
        parseExperiment(text, request.file, settingsOf(request, axes, values), source);
    requireUsable(experiment, source, request.live.has_value());
    return experiment;
  } catch (const ExperimentError& error) {
    if (axes.empty()) throw;
    std::vector<std::string> problems = error.problems();
    problems.push_back("at the point " + pointText(axes, values) +
                       (request.random > 0 ? "; ranges can round: low:high:round=0.01" : ""));
    throw ExperimentError(std::move(problems));
  }
}

// Measured with the shipped experiments: bytes of a result and of a summary, and what a pose of a
// robot needs in trajectories.csv and the figures of a report.
constexpr double kResult_bytes = 12e3;
constexpr double kSummary_bytes = 15e3;
constexpr double kSummaryOfRobot_bytes = 8e3;
constexpr double kTrajectoryRow_bytes = 90;
constexpr double kReport_bytes = 3e6;

}  // namespace

Plan planCampaign(const Request& request, const std::string& text) {
  const Design design = request.design();
  requireNotSet(request, design.axes);
  const fs::path source = fs::path(request.file).parent_path();
  FileCollector files(source);
  Plan plan;
  std::set<std::string> hashes;
  std::vector<PointValues> points = pointsOf(design);
  requireFewRows(request, points.size(), request.file);
  for (PointValues& values : points) {
    Experiment experiment = checkedExperiment(text, request, design.axes, values, source);
    experiment.analysis.twins = 0;
    if (!request.live) leaveOutNetwork(experiment);
    adoptFiles(experiment, files);
    experiment.seed = 0;
    Point point = makePoint(std::move(values), writeExperiment(experiment), experiment.duration);
    if (!hashes.insert(point.hash).second) {
      throw UserError(fmt::format(
          "found two points with the same experiment ({}), expected different ones: do the swept "
          "keys have an effect?",
          fmt::join(point.values, ", ")));
    }
    plan.points.push_back(std::move(point));
  }
  plan.files = files.take();
  return plan;
}

Experiment experimentOf(const Point& point, std::uint64_t seed, const fs::path& folder) {
  Experiment experiment = parseExperiment(point.experiment, "the point's experiment", {}, folder);
  experiment.seed = seed;
  return experiment;
}

Cost costOf(const Request& request, const std::vector<Point>& points,
            const std::vector<Row>& rows) {
  struct OfPoint {
    double duration = 0;
    double log = 0;
    double kept = 0;
  };
  std::vector<OfPoint> each;
  each.reserve(points.size());
  for (const Point& point : points) {
    const Experiment experiment = parseExperiment(point.experiment, "the point's experiment");
    const auto robots = static_cast<double>(experiment.robots.size());
    OfPoint one{experiment.duration, expectedLogBytes(experiment), kResult_bytes};
    const double summary = kSummary_bytes + robots * kSummaryOfRobot_bytes;
    if (request.keep == Keep::kSummary) one.kept += summary;
    if (request.keep == Keep::kLogs) {
      one.kept += summary + one.log + kReport_bytes +
                  robots * experiment.camera.fps * experiment.duration * kTrajectoryRow_bytes;
    }
    each.push_back(one);
  }
  Cost cost;
  double kept = 0;
  double work = 0;
  for (const Row& row : rows) {
    const OfPoint& one = each[row.point];
    cost.virtual_s += one.duration;
    kept += one.kept;
    work = std::max(work, one.log);
  }
  cost.kept_bytes = static_cast<std::int64_t>(kept);
  cost.work_bytes = static_cast<std::int64_t>(work);
  return cost;
}

}  // namespace lab::runner::campaign
