/// What was turned away, counted from any thread.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "dashboard/web/http_guard.hpp"
#include "dashboard/web/web_server.hpp"

namespace lab::dashboard {

class RefusalCount {
 public:
  void add(Refusal refusal) { counts_.at(static_cast<std::size_t>(refusal)) += 1; }

  [[nodiscard]] Refusals all() const {
    return {of(Refusal::kHost),   of(Refusal::kOrigin),    of(Refusal::kToken),
            of(Refusal::kPath),   of(Refusal::kMalformed), of(Refusal::kOversized),
            of(Refusal::kCrowded)};
  }

 private:
  [[nodiscard]] std::int64_t of(Refusal refusal) const {
    return counts_.at(static_cast<std::size_t>(refusal));
  }

  std::array<std::atomic<std::int64_t>, 8> counts_{};
};

}  // namespace lab::dashboard
