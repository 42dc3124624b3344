#include "tests/dds_gateway/ros/golden_messages.hpp"

#include <algorithm>
#include <deque>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <string>

#include "tests/dds_gateway/peers/cdr.hpp"

namespace lab::ros {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

char* text(const char* value) {
  static std::deque<std::string> all;
  return all.emplace_back(value).data();
}

template <class Sequence, class Element>
void fill(Sequence& sequence, std::initializer_list<Element> elements) {
  static std::deque<std::vector<Element>> all;
  auto& storage = all.emplace_back(elements);
  sequence._buffer = storage.data();
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(storage.size());
  sequence._release = false;
}

/// A std::vector<bool> does not store an array of bool.
template <class Sequence>
void fillBools(Sequence& sequence, std::initializer_list<bool> elements) {
  static std::deque<std::vector<std::uint8_t>> all;
  auto& storage = all.emplace_back(elements.begin(), elements.end());
  sequence._buffer = reinterpret_cast<bool*>(storage.data());
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(storage.size());
}

template <class Message>
GoldenMessage golden(const Message& message, const Cdr& bytes) {
  static std::deque<Message> all;
  return {&rosType<Message>(), &all.emplace_back(message), bytes.payload()};
}

const Header& header() {
  static const Header kHeader{{-2, 999'999'999}, text("lab")};
  return kHeader;
}
Cdr& header(Cdr& bytes) { return bytes.i32(-2).u32(999'999'999).text("lab"); }

const Pose kPose{{1, 2, 0.5}, {0, 0, 0.6, 0.8}};
Cdr& pose(Cdr& bytes) { return bytes.f64(1).f64(2).f64(0.5).f64(0).f64(0).f64(0.6).f64(0.8); }

const Twist kTwist{{0.1, 0, 0}, {0, 0, -1.5}};
Cdr& twist(Cdr& bytes) { return bytes.f64(0.1).f64(0).f64(0).f64(0).f64(0).f64(-1.5); }

const TransformStamped& transform() {
  static const TransformStamped kTransform{header(), text("robot1"), {{1, 2, 3}, {0, 0, 1, 0}}};
  return kTransform;
}
Cdr& transform(Cdr& bytes) {
  return header(bytes).text("robot1").f64(1).f64(2).f64(3).f64(0).f64(0).f64(1).f64(0);
}

GoldenMessage odometry() {
  Odometry message{header(), text("robot1/base"), {kPose, {}}, {kTwist, {}}};
  Cdr bytes;
  pose(header(bytes).text("robot1/base"));
  for (int i = 0; i < 36; ++i) {
    message.pose.covariance[i] = i;
    bytes.f64(i);
  }
  twist(bytes);
  for (int i = 0; i < 36; ++i) {
    message.twist.covariance[i] = -i;
    bytes.f64(-i);
  }
  return golden(message, bytes);
}

GoldenMessage occupancyGrid() {
  OccupancyGrid message{header(), {{7, 8}, 0.05F, 3, 1, kPose}, {}};
  fill<decltype(message.data), std::int8_t>(message.data, {0, 100, -1});
  Cdr bytes;
  pose(header(bytes).i32(7).u32(8).f32(0.05F).u32(3).u32(1)).u32(3).u8(0).u8(100).u8(255);
  return golden(message, bytes);
}

GoldenMessage image() {
  Image message{header(), 1, 2, text("mono8"), 0, 2, {}};
  fill<decltype(message.data), std::uint8_t>(message.data, {7, 255});
  Cdr bytes;
  header(bytes).u32(1).u32(2).text("mono8").u8(0).u32(2).u32(2).u8(7).u8(255);
  return golden(message, bytes);
}

GoldenMessage diagnosticArray() {
  DiagnosticStatus status{2, text("lab/tracker"), text("no camera"), text(""), {}};
  fill<decltype(status.values), KeyValue>(status.values,
                                          {{text("frames"), text("0")}, {text("a"), text("")}});
  DiagnosticArray message{header(), {}};
  fill<decltype(message.status), DiagnosticStatus>(message.status, {status});
  Cdr bytes;
  header(bytes).u32(1).u8(2).text("lab/tracker").text("no camera").text("").u32(2);
  bytes.text("frames").text("0").text("a").text("");
  return golden(message, bytes);
}

GoldenMessage analysis() {
  Curve curve{text("msd"), text("m^2"), {}, {}, {}, {}, {}, {}, {}};
  for (auto* sequence : {&curve.lag, &curve.value, &curve.sigma, &curve.exact, &curve.paper}) {
    fill<dds_sequence_float, float>(*sequence, {0.5F, 2});
  }
  fill<decltype(curve.windows), std::int32_t>(curve.windows, {9, 4});
  fillBools(curve.biased, {false, true});
  const Estimate estimate{text("D_r"), text("rad^2/s"), 0.5, 0.1, 0.3, 0.7, kNan, text("fit")};
  Analysis message{header(), -1, text("abp"), {0x89ABCDEF, text("law = 1\n")}, 60, 3, 1, 0.25, 1,
                   1.5,      {}, {}};
  fill<decltype(message.curves), Curve>(message.curves, {curve});
  fill<decltype(message.estimates), Estimate>(message.estimates, {estimate});
  Cdr bytes;
  header(bytes).i32(-1).text("abp").u32(0x89ABCDEF).text("law = 1\n");
  bytes.f64(60).i32(3).i32(1).f64(0.25).u8(1).f64(1.5);
  bytes.u32(1).text("msd").text("m^2");
  for (int i = 0; i < 5; ++i) bytes.u32(2).f32(0.5F).f32(2);
  bytes.u32(2).i32(9).i32(4).u32(2).u8(0).u8(1);
  bytes.u32(1).text("D_r").text("rad^2/s").f64(0.5).f64(0.1).f64(0.3).f64(0.7).f64(kNan);
  bytes.text("fit");
  return golden(message, bytes);
}

/// The messages with few fields.
std::vector<GoldenMessage> small() {
  Cdr stamped;
  Cdr twisted;
  Cdr alone;
  Cdr illuminance;
  Cdr placed;
  PoseArray poses{header(), {}};
  fill<decltype(poses.poses), Pose>(poses.poses, {kPose, kPose});
  Cdr array;
  pose(pose(header(array).u32(2)));
  TFMessage transforms{};
  fill<decltype(transforms.transforms), TransformStamped>(transforms.transforms,
                                                          {transform(), transform()});
  Cdr tree;
  transform(transform(tree.u32(2)));
  ProgramCommand command{1, {}};
  fill<decltype(command.robot_ids), std::int32_t>(command.robot_ids, {1, 2});
  return {golden(String{text("\xc3\xa4")}, Cdr().text("\xc3\xa4")),
          golden(Float64{-0.5}, Cdr().f64(-0.5)),
          golden(PoseStamped{header(), kPose}, pose(header(stamped))),
          golden(poses, array),
          golden(kTwist, twist(alone)),
          golden(TwistStamped{header(), kTwist}, twist(header(twisted))),
          golden(transform(), transform(placed)),
          golden(transforms, tree),
          golden(Illuminance{header(), 120, 0.25}, header(illuminance).f64(120).f64(0.25)),
          golden(Clock{{1, 2}}, Cdr().i32(1).u32(2)),
          golden(LightCommand{0.5, 10, true, text("by hand")},
                 Cdr().f64(0.5).f64(10).u8(1).text("by hand")),
          golden(command, Cdr().u8(1).u32(2).i32(1).i32(2))};
}

}  // namespace

std::vector<GoldenMessage> goldenMessages() {
  std::vector<GoldenMessage> all = small();
  all.push_back(odometry());
  all.push_back(occupancyGrid());
  all.push_back(image());
  all.push_back(diagnosticArray());
  all.push_back(analysis());
  return all;
}

}  // namespace lab::ros
