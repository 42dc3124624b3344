#include "tracker_svc/views/debug_output.hpp"

#include <algorithm>

#include "tracker_svc/overlay.hpp"
#include "tracker_svc/views/debug_view.hpp"

namespace lab::tracker {
namespace {

/// Copies the data that are drawn, because the drawing happens on another thread.
class HttpDebugOutput final : public DebugOutput {
 public:
  HttpDebugOutput(int port, const optics::CameraModel& camera, const optics::CapGeometry& cap)
      : camera_(camera), cap_(cap), view_(port) {}

  [[nodiscard]] bool wanted() const override { return view_.wanted(); }

  void show(const optics::GreyView& picture, std::span<const Track> tracks,
            std::span<const detector::Rejection> rejected, const std::string& caption) override {
    optics::GreyImage image(picture.width, picture.height);
    for (int y = 0; y < picture.height; ++y) {
      std::copy_n(picture.row(y), picture.width, image.row(y));
    }
    view_.show([this, image = std::move(image), marks = marksOf(tracks),
                candidates = std::vector<detector::Rejection>(rejected.begin(), rejected.end()),
                caption] {
      OverlayInput input;
      input.picture = image.view();
      input.marks = marks;
      input.rejected = candidates;
      input.caption = caption;
      return overlay(input, camera_, cap_);
    });
  }

 private:
  optics::CameraModel camera_;
  optics::CapGeometry cap_;
  DebugView view_;  // last: its destructor ends the thread that uses the members above
};

}  // namespace

std::unique_ptr<DebugOutput> openDebugOutput(Loop& loop, int port,
                                             const optics::CameraModel& camera,
                                             const optics::CapGeometry& cap) {
  if (loop.isVirtual() || port == 0) return nullptr;
  return std::make_unique<HttpDebugOutput>(port, camera, cap);
}

}  // namespace lab::tracker
