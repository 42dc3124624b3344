#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <optional>
#include <utility>

namespace lab::gateway {

/// A map of bounded size, which removes the least recently used entry first.
template <class Key, class Value>
class LruMap {
 public:
  explicit LruMap(std::size_t most) : most_(most) {}

  /// @return the value of this key, marked as used; nullptr if there is none
  template <class Wanted>
  [[nodiscard]] Value* find(const Wanted& key) {
    const auto found = places_.find(key);
    if (found == places_.end()) return nullptr;
    entries_.splice(entries_.end(), entries_, found->second);
    return &found->second->second;
  }

  /// Adds a key that is not in the map.
  /// @return the value that was removed to make room
  std::optional<Value> add(const Key& key, Value value) {
    std::optional<Value> gone;
    if (entries_.size() >= most_) {
      gone = std::move(entries_.front().second);
      places_.erase(entries_.front().first);
      entries_.pop_front();
    }
    entries_.emplace_back(key, std::move(value));
    places_.emplace(key, std::prev(entries_.end()));
    return gone;
  }

  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  void clear() {
    places_.clear();
    entries_.clear();
  }

 private:
  using Entries = std::list<std::pair<Key, Value>>;
  std::size_t most_;
  Entries entries_;  ///< the longest unused first
  std::map<Key, typename Entries::iterator, std::less<>> places_;
};

}  // namespace lab::gateway
