#include "tracker_svc/views/frame_broker.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <utility>

namespace lab::tracker {
namespace {

using namespace std::chrono_literals;

constexpr auto kPeriod = 50ms;        // between two pictures
constexpr auto kCheckViewer = 250ms;  // whether a waiting viewer has gone

using EncodedPictures = std::array<FrameBroker::Picture, 2>;  // by format

/// Paints a picture and encodes it once for each format that a waiter wants. All are null on
/// errors.
template <class Waiters>
EncodedPictures paintAndEncode(const Waiters& waiters,
                               const std::function<optics::RgbImage()>& paint) {
  try {
    EncodedPictures encoded;
    const optics::RgbImage image = paint();
    for (const auto& waiter : waiters) {
      FrameBroker::Picture& picture = encoded.at(static_cast<std::size_t>(waiter->format));
      if (picture) continue;
      const std::vector<std::uint8_t> bytes = waiter->format == FrameBroker::Format::kJpeg
                                                  ? optics::jpegBytes(image)
                                                  : optics::pngBytes(image);
      picture = std::make_shared<const std::string>(bytes.begin(), bytes.end());
    }
    return encoded;
  } catch (const std::exception&) {
    // E.g. no memory is left: these viewers get no picture, the tracker goes on.
    return {};
  }
}

}  // namespace

FrameBroker::FrameBroker() : thread_([this] { run(); }) {}

FrameBroker::~FrameBroker() {
  close();
  thread_.join();
}

void FrameBroker::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    wanted_ = false;
  }
  changed_.notify_all();
}

void FrameBroker::updateWanted() {
  wanted_ = !closed_ && !waiters_.empty() && Clock::now() >= not_before_;
}

void FrameBroker::show(std::function<optics::RgbImage()> paint) {
  if (!wanted_.exchange(false)) return;
  {
    const std::lock_guard lock(mutex_);
    paint_ = std::move(paint);
    not_before_ = Clock::time_point::max();  // until this picture has been served
    wanted_ = false;
  }
  changed_.notify_all();
}

FrameBroker::Picture FrameBroker::next(Format format, Clock::time_point deadline,
                                       const std::function<bool()>& is_viewer_there) {
  const auto waiter = std::make_shared<Waiter>(Waiter{format, false, nullptr});
  std::unique_lock lock(mutex_);
  waiters_.push_back(waiter);
  updateWanted();
  const auto is_over = [&] { return waiter->served || closed_; };
  while (!changed_.wait_until(lock, std::min(deadline, Clock::now() + kCheckViewer), is_over)) {
    if (Clock::now() >= deadline || !is_viewer_there()) break;
  }
  std::erase(waiters_, waiter);
  updateWanted();
  return waiter->picture;
}

void FrameBroker::run() {
  std::unique_lock lock(mutex_);
  while (!closed_) {
    changed_.wait(lock, [this] { return closed_ || paint_; });
    if (closed_) return;
    const std::function<optics::RgbImage()> paint = std::exchange(paint_, {});
    const Waiters now = std::exchange(waiters_, {});
    lock.unlock();
    const EncodedPictures encoded = paintAndEncode(now, paint);
    lock.lock();
    for (const auto& waiter : now) {
      waiter->picture = encoded.at(static_cast<std::size_t>(waiter->format));
      waiter->served = true;
    }
    not_before_ = Clock::now() + kPeriod;
    changed_.notify_all();
    changed_.wait_until(lock, not_before_, [this] { return closed_.load(); });
    updateWanted();
  }
}

}  // namespace lab::tracker
