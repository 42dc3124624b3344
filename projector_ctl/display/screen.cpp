#include "projector_ctl/display/screen.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "light/optics/bitmap_font.hpp"

namespace lab::projector {

namespace {

constexpr int kLetterSize = 2;     // screen pixels a letter's pixel
constexpr int kOverlayMargin = 8;  // [px]

}  // namespace

Screen::~Screen() {
  if (!display_) return;
  try {
    present(setup_.safe_field);
  } catch (const DisplayError&) {  // the display is gone
  }
}

void Screen::open() {
  openPlaced(setup_.place);
  misplaced_ = false;
  state_.trouble.clear();
}

void Screen::openPlaced(const std::function<Placement(int columns, int rows)>& place) {
  try {
    display_ = setup_.open();
    const DisplayInfo& info = display_->info();
    state_.name = info.name.empty() ? std::to_string(info.number) : info.name;
    const Placement placement = place(info.width, info.height);
    painter_ = std::make_unique<ScreenPainter>(placement.model, placement.tone);
    overlaid_ = {};
    present(setup_.safe_field);
    measurePace();
    state_.calibration_id = placement.calibration_id;
    state_.overlay = setup_.overlay;
    state_.open = true;
  } catch (...) {
    drop();
    throw;
  }
}

/// If the calibration does not fit the display that came back, the safe field covers all of it.
void Screen::tryOpen() {
  const std::int64_t now = setup_.now();
  if (!reopens_ || now - closed_utime_ < kReopen) return;
  closed_utime_ = now;
  try {
    open();
  } catch (const DisplayError&) {  // not back yet
  } catch (const std::exception& error) {
    try {
      openPlaced([](int columns, int rows) {
        return Placement{optics::ProjectorModel(columns, rows, columns, rows)};
      });
      misplaced_ = true;
      state_.trouble = std::string("safe field on the whole display: ") + error.what();
    } catch (const DisplayError&) {  // gone again
    }
  }
}

void Screen::drop() {
  display_.reset();
  painter_.reset();
  state_.open = false;
  state_.pace = Pace::kUnpaced;
}

void Screen::close(const std::string& why, bool reopen) {
  drop();
  state_.trouble = why;
  reopens_ = reopen;
  closed_utime_ = setup_.now();
}

void Screen::takeEvents() {
  bool resized = false;
  for (const DisplayEvent event : display_->events()) {
    switch (event) {
      case DisplayEvent::kEscape: {
        const std::int64_t now = setup_.now();
        if (escaped_ && now - escape_utime_ <= kTwice) {
          return close("display " + state_.name +
                           ": closed by hand (Escape twice); start the "
                           "projector again to open it",
                       false);
        }
        escaped_ = true;
        escape_utime_ = now;
        break;
      }
      case DisplayEvent::kClosed:
        return close("display " + state_.name +
                         ": its window was closed by hand; start the "
                         "projector again to open it",
                     false);
      case DisplayEvent::kGone:
        return close("display " + state_.name + ": gone; it is opened again when it is back", true);
      case DisplayEvent::kResized:
        resized = true;
        break;
      case DisplayEvent::kOverlay:
        state_.overlay = !state_.overlay;
        break;
      default:
        break;
    }
  }
  if (resized) {
    close("display " + state_.name + ": it changed its size; it is opened again", true);
    closed_utime_ -= kReopen;  // at once
  }
}

/// Measures whether the display waits one refresh per picture. The first pictures are ignored, as
/// they may fill a queue.
void Screen::measurePace() {
  state_.pace = Pace::kUnpaced;
  state_.period = 0;
  if (!display_->mayWait()) return;
  constexpr std::size_t kWarm = 3;
  std::array<std::int64_t, 8> intervals{};
  std::int64_t last = 0;
  for (std::size_t i = 0; i < kWarm + intervals.size(); ++i) {
    display_->present(painter_->picture(), {});
    const std::int64_t now = setup_.now();
    if (i >= kWarm) intervals[i - kWarm] = now - last;
    last = now;
  }
  std::sort(intervals.begin(), intervals.end());
  const double middle = 1e-6 * static_cast<double>(intervals[intervals.size() / 2]);
  const double rate = display_->info().refresh_rate > 0 ? display_->info().refresh_rate : 60;
  if (middle < kLeastWait / rate) return;
  state_.pace = Pace::kDisplay;
  state_.period = middle;
}

void Screen::present(const light::Field& field) {
  const std::span<const Box> painted = painter_->paint(field);
  display_->present(painter_->picture(), painted);
}

ScreenResult Screen::run(const ScreenJob& job) {
  ScreenResult result;
  if (display_) {
    takeEvents();
  } else {  // open it again in a later frame only, so that the closing is reported in between
    tryOpen();
  }
  if (display_) {
    const std::int64_t start = setup_.now();
    try {
      if (overlaid_.width > 0) painter_->forget(overlaid_);
      const std::span<const Box> painted =
          painter_->paint(misplaced_ ? setup_.safe_field : job.field);
      changed_.assign(painted.begin(), painted.end());
      overlaid_ = {};
      if (state_.overlay) drawOverlay(job.overlay);
      const std::int64_t ready = setup_.now();
      if (state_.pace == Pace::kUnpaced && setup_.sleep_until)
        setup_.sleep_until(job.present_utime);
      const std::int64_t handed = setup_.now();
      display_->present(painter_->picture(), changed_);
      result.swap_utime = setup_.now();
      // For a display that waits, presenting is waiting and not work.
      const bool waits = state_.pace == Pace::kDisplay;
      result.work =
          1e-6 * static_cast<double>(ready - start + (waits ? 0 : result.swap_utime - handed));
    } catch (const DisplayError& error) {
      close(std::string(error.what()) + "; it is opened again when it is back", true);
    }
  }
  result.state = state_;
  return result;
}

void Screen::drawOverlay(const std::vector<std::string>& lines) {
  std::size_t longest = 0;
  for (const std::string& line : lines) longest = std::max(longest, line.size());
  optics::GreyImage& picture = painter_->canvas();
  const int width = static_cast<int>(longest) * optics::kGlyphWidth * kLetterSize;
  const int height = static_cast<int>(lines.size()) * optics::kGlyphHeight * kLetterSize;
  overlaid_ = {0, 0, std::min(width + 2 * kOverlayMargin, picture.width),
               std::min(height + 2 * kOverlayMargin, picture.height)};
  for (int y = 0; y < overlaid_.height; ++y)
    std::fill_n(picture.row(y), overlaid_.width, std::uint8_t{0});
  for (std::size_t i = 0; i < lines.size(); ++i) {
    optics::forEachGlyphPixel(
        lines[i], kOverlayMargin,
        kOverlayMargin + static_cast<int>(i) * optics::kGlyphHeight * kLetterSize, kLetterSize,
        [&](int x, int y) {
          if (x < picture.width && y < picture.height) picture.row(y)[x] = 255;
        });
  }
  changed_.push_back(overlaid_);
}

}  // namespace lab::projector
