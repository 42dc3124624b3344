/// The byte code of the programs that simulated robots run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "robot/dynamics/program_source.hpp"

namespace lab {

/// Programs by hash. They stay in memory until the library ends.
class ProgramLibrary final : public dynamics::ProgramSource {
 public:
  /// More different programs than any run has; senders of others are refused.
  static constexpr std::size_t kMost = 4096;

  /// @return false if there is no room
  bool add(std::uint32_t hash, const std::vector<std::uint8_t>& code) {
    if (codes_.size() >= kMost && !codes_.contains(hash)) return false;
    codes_.try_emplace(hash, code);
    return true;
  }

  dynamics::ProgramBytes find(std::uint32_t hash) override {
    const auto found = codes_.find(hash);
    if (found == codes_.end()) return {};
    return {found->second.data(), static_cast<std::uint8_t>(found->second.size())};
  }

 private:
  std::map<std::uint32_t, std::vector<std::uint8_t>> codes_;
};

}  // namespace lab
