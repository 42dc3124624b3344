#include "tracker_svc/film_tracking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lab::tracker {
namespace {

constexpr double kMoment = 1e-3;  // [s] between pictures without time stamps
constexpr double kCm = 100;

/// The track that a detection of this picture was assigned to, null if none.
const Track* trackOf(const detector::Detection& detection, const std::vector<Track>& tracks) {
  // Compared by pixel position: a track may have corrected the pose.
  for (const Track& track : tracks) {
    if (track.detected && track.pose.middle.x == detection.middle.x &&
        track.pose.middle.y == detection.middle.y) {
      return &track;
    }
  }
  return nullptr;
}

}  // namespace

const std::vector<FilmRow>& FilmTracking::process(std::int64_t number, double time,
                                                  const optics::GreyView& picture,
                                                  std::vector<detector::Rejection>* rejected) {
  tracker_time_ = total_.frames == 0 ? time : std::max(time, tracker_time_ + kMoment);
  found_ = detector_.search(picture, rejected, tracker_.expect(tracker_time_));
  if (found_.size() > most_used_) {
    std::stable_sort(found_.begin(), found_.end(),
                     [](const detector::Detection& a, const detector::Detection& b) {
                       return a.quality > b.quality;
                     });
    total_.surplus += static_cast<std::int64_t>(found_.size() - most_used_);
    ++total_.crowded;
    found_.resize(most_used_);
  }
  const std::vector<Track>& tracks = tracker_.update(tracker_time_, found_);

  rows_.clear();
  for (const detector::Detection& detection : found_) {
    const Track* track = trackOf(detection, tracks);
    const std::int64_t id = track != nullptr ? track->number : 0;
    if (id == 0 && (detection.used & detector::kUsedRim) != 0)
      continue;  // the circle belongs to another cap than expected
    rows_.push_back({number, id, time, detection, track != nullptr ? track->swap : 0});
    // The track knows at which end of its axis a blob has its head.
    if (track != nullptr && detection.heading == detector::HeadingKind::kAxis) {
      rows_.back().pose.theta = track->pose.theta;
    }
  }
  std::stable_sort(rows_.begin(), rows_.end(),
                   [](const FilmRow& a, const FilmRow& b) { return a.id < b.id; });
  count(number);
  return rows_;
}

void FilmTracking::count(std::int64_t number) {
  const auto robots = static_cast<std::int64_t>(rows_.size());
  if (total_.frames == 0) {
    total_.fewest = robots;
  } else {
    total_.missing += std::max<std::int64_t>(0, number - next_number_);
  }
  next_number_ = number + 1;
  ++total_.frames;
  total_.rows += robots;
  total_.fewest = std::min(total_.fewest, robots);
  total_.most = std::max(total_.most, robots);
  for (const FilmRow& row : rows_) {
    confidences_ += static_cast<double>(row.pose.quality);
    if ((row.pose.used & detector::kUsedRim) != 0) ++total_.degraded;
    if (row.pose.merged > 1) ++total_.merged;
    total_.swaps += row.swap;
    if (row.swap > kDoubtful) ++total_.doubtful;
    if (row.id > 0 && ids_.insert(row.id).second) ++total_.ids;
    if (row.pose.spacing > 0) {
      const double off = static_cast<double>(row.pose.spacing) - spacing_mean_;
      spacing_mean_ += off / static_cast<double>(++spacings_);
      spacing_squares_ += off * (static_cast<double>(row.pose.spacing) - spacing_mean_);
    }
  }
}

FilmSummary FilmTracking::summary() const {
  FilmSummary summary = total_;
  if (summary.rows > 0) summary.confidence = confidences_ / static_cast<double>(summary.rows);
  summary.spacing = spacing_mean_;
  if (spacings_ > 1) {
    summary.spacing_spread = std::sqrt(spacing_squares_ / static_cast<double>(spacings_ - 1));
  }
  return summary;
}

std::string_view filmCsvHeader(detector::MarkerKind kind) {
  switch (kind) {
    case detector::MarkerKind::kBlobs:
      return "frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s,area_cm2,length_cm,width_cm,merged,"
             "swap\n";
    case detector::MarkerKind::kTags:
      return "frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s,tag\n";
    case detector::MarkerKind::kCaps:
      break;
  }
  return "frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s\n";
}

std::string filmCsvLine(const FilmRow& row, detector::MarkerKind kind) {
  const detector::Detection& pose = row.pose;
  const bool known = pose.heading != detector::HeadingKind::kUnknown;
  std::string line =
      fmt::format("{},{},{:.6f},{:.6f},{},{:.5f},{:.5f},{:.4f},{:.6f}", row.frame, row.id,
                  pose.x * kCm, pose.y * kCm, known ? fmt::format("{:.8f}", pose.theta) : "",
                  pose.middle.x, pose.middle.y, static_cast<double>(pose.quality), row.time);
  if (kind == detector::MarkerKind::kBlobs) {
    line +=
        fmt::format(",{:.5f},{:.4f},{:.4f},{},{:.2g}", static_cast<double>(pose.area) * kCm * kCm,
                    static_cast<double>(pose.length) * kCm, static_cast<double>(pose.width) * kCm,
                    pose.merged, row.swap);
  } else if (kind == detector::MarkerKind::kTags) {
    line += fmt::format(",{}", pose.tag);
  }
  return line + "\n";
}

}  // namespace lab::tracker
