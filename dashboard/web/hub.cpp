#include "dashboard/web/hub.hpp"

#include <algorithm>
#include <utility>

namespace lab::dashboard {

void Hub::publish(std::string_view topic, std::string text) {
  publishQuietly(topic, std::move(text));
  changed_.notify_all();
}

void Hub::publishQuietly(std::string_view topic, std::string text) {
  auto newest = std::make_shared<const std::string>(std::move(text));
  const std::lock_guard lock(mutex_);
  auto entry = topics_.find(topic);
  if (entry == topics_.end()) entry = topics_.emplace(topic, Topic{}).first;
  entry->second.text.swap(newest);  // the old text is freed outside the lock
  entry->second.version = ++version_;
  entry->second.removed = false;
}

void Hub::remove(std::string_view topic) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = topics_.find(topic);
    if (found == topics_.end() || found->second.removed) return;
    found->second = {std::make_shared<const std::string>("null"), ++version_, true};
    const auto is_removed = [](const auto& entry) { return entry.second.removed; };
    if (std::ranges::count_if(topics_, is_removed) > kMaxRemoved) {
      auto oldest = found;
      for (auto entry = topics_.begin(); entry != topics_.end(); ++entry) {
        if (is_removed(*entry) && entry->second.version < oldest->second.version) oldest = entry;
      }
      topics_.erase(oldest);
    }
  }
  changed_.notify_all();
}

Hub::Text Hub::newest(std::string_view topic) const {
  const std::lock_guard lock(mutex_);
  const auto entry = topics_.find(topic);
  return entry == topics_.end() || entry->second.removed ? nullptr : entry->second.text;
}

std::vector<Hub::Change> Hub::changesSince(std::uint64_t& seen,
                                           std::chrono::milliseconds timeout) const {
  std::vector<Change> changes;
  {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [&] { return closed_ || version_ > seen; });
    if (closed_) return changes;
    for (const auto& [name, topic] : topics_) {
      if (topic.removed && seen == 0) continue;
      if (topic.version > seen) changes.push_back({name, topic.text, topic.version});
    }
    seen = version_;
  }
  std::ranges::sort(changes, {}, &Change::version);
  return changes;
}

void Hub::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

bool Hub::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

}  // namespace lab::dashboard
