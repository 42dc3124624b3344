#include "dds_gateway/ros/to_ros.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"
#include "common/text/utf8.hpp"

namespace lab::gateway {
namespace {

constexpr double kCell = 0.01;  // [m]
constexpr double kMostColumns = 160;
constexpr double kMostRows = 120;
constexpr double kFullGrid = 100;  // OccupancyGrid's "occupied"

// Rows and columns of yaw and of the plane in ROS 2's 6 x 6 matrices.
constexpr std::size_t kDim = 6;
constexpr std::size_t kX = 0;
constexpr std::size_t kY = 1;
constexpr std::size_t kYaw = 5;

std::size_t at(std::size_t row, std::size_t column) { return row * kDim + column; }

ros::Header headerOf(std::int64_t utime, const std::string& frame) {
  return {stampOf(utime), cText(frame)};
}

/// A C sequence that points at our memory.
template <class Sequence, class Element>
Sequence sequenceOf(std::vector<Element>& elements) {
  Sequence sequence{};
  sequence._maximum = sequence._length = static_cast<std::uint32_t>(elements.size());
  sequence._buffer = elements.data();
  sequence._release = false;
  return sequence;
}

}  // namespace

ros::Time stampOf(std::int64_t utime) {
  std::int64_t seconds = utime / units::kSecond_us;
  std::int64_t rest = utime % units::kSecond_us;
  if (rest < 0) {
    rest += units::kSecond_us;
    --seconds;
  }
  return {static_cast<std::int32_t>(seconds), static_cast<std::uint32_t>(rest * 1000)};
}

// Cyclone's structs have no const members, but it does not write into samples that it sends.
char* cText(const std::string& text) { return const_cast<char*>(text.c_str()); }

char* sanitizedText(std::string& text) {
  repairUtf8(text);
  return cText(text);
}

ros::Quaternion yaw(double theta) { return {0, 0, std::sin(theta / 2), std::cos(theta / 2)}; }

ros::Pose toPose(const tracked_pose_t& pose) { return {{pose.x, pose.y, 0}, yaw(pose.theta)}; }

void setCovariance(const tracked_pose_t& pose, double (&covariance)[36]) {
  std::fill(std::begin(covariance), std::end(covariance), 0);
  const auto& [xx, xy, xt, yy, yt, tt] = pose.covariance;
  covariance[at(kX, kX)] = xx;
  covariance[at(kX, kY)] = covariance[at(kY, kX)] = xy;
  covariance[at(kX, kYaw)] = covariance[at(kYaw, kX)] = xt;
  covariance[at(kY, kY)] = yy;
  covariance[at(kY, kYaw)] = covariance[at(kYaw, kY)] = yt;
  covariance[at(kYaw, kYaw)] = tt;
}

Motion motionOf(double wheel_left, double wheel_right, double wheel_base) {
  return {(wheel_left + wheel_right) / 2, (wheel_right - wheel_left) / wheel_base};
}

ros::PoseStamped RobotMessages::pose(std::int64_t utime, const tracked_pose_t& pose) const {
  return {headerOf(utime, arena_), toPose(pose)};
}

ros::Odometry RobotMessages::odometry(std::int64_t utime, const tracked_pose_t& pose,
                                      const Motion* motion) const {
  ros::Odometry message{};
  message.header = headerOf(utime, arena_);
  message.child_frame_id = cText(robot_);
  message.pose.pose = toPose(pose);
  setCovariance(pose, message.pose.covariance);
  if (motion != nullptr) {
    message.twist.twist.linear.x = motion->forward;
    message.twist.twist.angular.z = motion->turn;
  } else {
    message.twist.covariance[at(kX, kX)] = kUnknownVariance;
    message.twist.covariance[at(kYaw, kYaw)] = kUnknownVariance;
  }
  return message;
}

ros::TransformStamped RobotMessages::transform(std::int64_t utime,
                                               const tracked_pose_t& pose) const {
  return {headerOf(utime, arena_), cText(robot_), {{pose.x, pose.y, 0}, yaw(pose.theta)}};
}

ros::Illuminance RobotMessages::light(const robot_state_t& state, LightSensor sensor) const {
  const double front = static_cast<double>(state.light_front);
  const double back = static_cast<double>(state.light_back);
  double reading = (front + back) / 2;
  if (sensor == LightSensor::kFront) reading = front;
  if (sensor == LightSensor::kBack) reading = back;
  return {headerOf(state.utime, robot_), reading, 0};
}

LightGrid::LightGrid(double width, double height, std::string frame) : frame_(std::move(frame)) {
  const double cell = std::max({kCell, width / kMostColumns, height / kMostRows});
  // Rounding must not add a cell to a length that is a whole number of cells.
  const auto cells = [cell](double length) {
    return static_cast<std::uint32_t>(std::max(1.0, std::ceil(length / cell - 1e-6)));
  };
  message_.info.resolution = static_cast<float>(cell);
  message_.info.width = cells(width);
  message_.info.height = cells(height);
  message_.info.origin.orientation.w = 1;
  row_.resize(message_.info.width);
  cells_.resize(row_.size() * message_.info.height);
}

const ros::OccupancyGrid& LightGrid::paint(const light::CompiledField& field, std::int64_t utime,
                                           std::int64_t since) {
  const auto cell = static_cast<double>(message_.info.resolution);
  auto out = cells_.begin();
  for (std::uint32_t j = 0; j < message_.info.height; ++j) {
    field.evaluateRow(cell / 2, cell, (j + 0.5) * cell, row_.size(), row_.data());
    for (const double light : row_) {
      *out++ = static_cast<std::int8_t>(std::lround(std::clamp(light, 0.0, 1.0) * kFullGrid));
    }
  }
  message_.header = headerOf(utime, frame_);
  message_.info.map_load_time = stampOf(since);
  message_.data = sequenceOf<decltype(message_.data)>(cells_);
  return message_;
}

const ros::Analysis& AnalysisMessage::make(const analysis_t& analysis,
                                           const std::string& program_text) {
  source_ = analysis;
  text_ = program_text;
  curves_.clear();
  estimates_.clear();
  biased_.clear();
  biased_.reserve(source_.curves.size());
  for (curve_t& curve : source_.curves) {
    auto& biased = biased_.emplace_back(curve.biased.begin(), curve.biased.end());
    ros::Curve out{};
    out.name = sanitizedText(curve.name);
    out.unit = sanitizedText(curve.unit);
    out.lag = sequenceOf<decltype(out.lag)>(curve.lag);
    out.value = sequenceOf<decltype(out.value)>(curve.value);
    out.sigma = sequenceOf<decltype(out.sigma)>(curve.sigma);
    out.exact = sequenceOf<decltype(out.exact)>(curve.exact);
    out.paper = sequenceOf<decltype(out.paper)>(curve.paper);
    out.windows = sequenceOf<decltype(out.windows)>(curve.windows);
    static_assert(sizeof(bool) == sizeof(std::uint8_t));
    for (std::uint8_t& flag : biased) flag = flag != 0 ? 1 : 0;
    out.biased._maximum = out.biased._length = static_cast<std::uint32_t>(biased.size());
    out.biased._buffer = reinterpret_cast<bool*>(biased.data());
    curves_.push_back(out);
  }
  for (estimate_t& estimate : source_.estimates) {
    estimates_.push_back({sanitizedText(estimate.name), sanitizedText(estimate.unit),
                          estimate.value, estimate.sigma, estimate.low, estimate.high,
                          estimate.theory, sanitizedText(estimate.note)});
  }
  message_ = {};
  message_.header = headerOf(source_.utime, frame_);
  message_.robot_id = source_.robot_id;
  message_.program_name = sanitizedText(source_.program.name);
  message_.program = {static_cast<std::uint32_t>(source_.program.hash), sanitizedText(text_)};
  message_.observed = source_.observed;
  message_.segments = source_.segments;
  message_.reversals = source_.reversals;
  message_.contact_share = source_.contact_share;
  message_.verdict = static_cast<std::uint8_t>(source_.verdict);
  message_.max_z = source_.max_z;
  message_.curves = sequenceOf<decltype(message_.curves)>(curves_);
  message_.estimates = sequenceOf<decltype(message_.estimates)>(estimates_);
  return message_;
}

const ros::DiagnosticArray& Diagnostics::make(std::int64_t utime) {
  static const std::string kNoFrame;
  values_.clear();
  values_.reserve(entries_.size());
  statuses_.clear();
  for (Status& entry : entries_) {
    auto& values = values_.emplace_back();
    for (auto& [key, value] : entry.values) {
      values.push_back({sanitizedText(key), sanitizedText(value)});
    }
    ros::DiagnosticStatus status{};
    status.level = entry.level;
    status.name = sanitizedText(entry.name);
    status.message = sanitizedText(entry.message);
    status.hardware_id = sanitizedText(entry.hardware);
    status.values = sequenceOf<decltype(status.values)>(values);
    statuses_.push_back(status);
  }
  message_.header = headerOf(utime, kNoFrame);
  message_.status = sequenceOf<decltype(message_.status)>(statuses_);
  return message_;
}

}  // namespace lab::gateway
