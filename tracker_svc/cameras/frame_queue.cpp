#include "tracker_svc/cameras/frame_queue.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace lab::cameras {

bool FrameQueue::push(Item item) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !open_ || items_.size() < kCapacity; });
  return add(std::move(item));
}

bool FrameQueue::pushDroppingOldest(Item item) {
  const std::lock_guard lock(mutex_);
  if (items_.size() >= kCapacity) {
    const auto oldest = std::find_if(items_.begin(), items_.end(), [](const Item& one) {
      return one.kind == Item::Kind::kFrame;
    });
    if (oldest != items_.end()) {
      spare_.push_back(std::move(oldest->image));
      items_.erase(oldest);
    }
  }
  return add(std::move(item));
}

bool FrameQueue::add(Item item) {
  if (!open_) return false;
  items_.push_back(std::move(item));
  ready_.signal();
  return true;
}

optics::GreyImage FrameQueue::blank(int width, int height) {
  {
    const std::lock_guard lock(mutex_);
    if (!spare_.empty()) {
      optics::GreyImage image = std::move(spare_.back());
      spare_.pop_back();
      if (image.width == width && image.height == height) return image;
    }
  }
  return {width, height};
}

bool FrameQueue::pause(std::int64_t microseconds) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, std::chrono::microseconds(microseconds),
                            [this] { return !open_; });
}

void FrameQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    open_ = false;
  }
  changed_.notify_all();
}

bool FrameQueue::isOpen() {
  const std::lock_guard lock(mutex_);
  return open_;
}

std::optional<FrameQueue::Item> FrameQueue::pop() {
  std::optional<Item> item;
  {
    const std::lock_guard lock(mutex_);
    if (!items_.empty()) {
      item = std::move(items_.front());
      items_.pop_front();
    }
    if (items_.empty()) ready_.clear();
  }
  changed_.notify_all();
  return item;
}

void FrameQueue::recycle(optics::GreyImage image) {
  const std::lock_guard lock(mutex_);
  if (spare_.size() < kCapacity) spare_.push_back(std::move(image));
}

}  // namespace lab::cameras
