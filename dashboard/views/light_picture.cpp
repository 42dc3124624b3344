#include "dashboard/views/light_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/experiment/light_messages.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace {

/// Whether everything is equal that the text of the topic shows.
bool sameText(const light_status_t& a, const light_status_t& b) {
  return a.label == b.label && a.commander == b.commander && a.moving == b.moving &&
         a.display == b.display && a.trouble == b.trouble;
}

}  // namespace

void LightPicture::setArena(double width, double height) {
  if (!(width > 0) || !(height > 0)) return;
  width_ = width;
  height_ = height;
  painter_.reset();
  painted_.reset();
  changed_ = status_.has_value();
}

void LightPicture::setImages(light::ImageStore images) {
  images_ = std::move(images);
  painted_.reset();
  changed_ = status_.has_value();
}

int LightPicture::rows() const {
  return std::clamp(static_cast<int>(std::lround(kColumns * height_ / width_)), 1, 4 * kColumns);
}

void LightPicture::take(const light_status_t& status) {
  const bool same = status_ && sameText(*status_, status) && status.moving == 0 &&
                    status_->command_seq == status.command_seq &&
                    status_->command_instance == status.command_instance &&
                    status_->mix == status.mix &&
                    status_->first_shown_utime == status.first_shown_utime;
  if (!same) changed_ = true;
  status_ = status;
}

void LightPicture::clear() {
  status_.reset();
  painted_.reset();
  pixels_.clear();
  changed_ = false;
}

bool LightPicture::paint(std::int64_t now) {
  const bool is_recent = painted_utime_ != 0 && now - painted_utime_ < kPeriod_us;
  if (!status_ || !changed_ || is_recent) return false;
  changed_ = false;
  painted_utime_ = now;
  ++version_;
  light::Field field = toField(*status_, images_);
  auto problem = light::validate(field.layers);
  if (!problem && field.mix < 1) problem = light::validate(field.previous);
  trouble_ = problem.value_or("");
  if (problem) return true;
  if (painted_ == field) return true;  // only the text is new
  if (!painter_) painter_.emplace(width_, height_, kColumns, rows());
  const light::Raster& raster = painter_->paint(field);
  pixels_ = light::toGrey(raster);
  mean_ = std::accumulate(raster.values.begin(), raster.values.end(), 0.0) /
          static_cast<double>(raster.values.size());
  painted_ = std::move(field);
  return true;
}

std::string LightPicture::json(const std::string& runner) const {
  if (!status_) return {};
  const bool manual =
      !status_->commander.empty() && !runner.empty() && status_->commander != runner;
  return toText({{"version", version_},
                 {"columns", kColumns},
                 {"rows", rows()},
                 {"mean", number(mean_)},
                 {"label", status_->label},
                 {"commander", status_->commander},
                 {"manual", manual},
                 {"moving", status_->moving != 0},
                 {"display", status_->display},
                 {"trouble", trouble_.empty() ? status_->trouble : trouble_}});
}

}  // namespace lab::dashboard
