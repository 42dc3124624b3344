/// Delays between light command and effect, over all steps of a run.
#pragma once

#include <cstdint>
#include <lab/experiment_event_t.hpp>
#include <lab/light_delivery_t.hpp>
#include <vector>

namespace lab::runner {

class DeliveryTimes {
 public:
  /// @param step a step with its final times
  void add(const experiment_event_t& step);

  /// The LIGHT_DELIVERY message without its header. Delays without a sample are omitted.
  [[nodiscard]] light_delivery_t message() const;

 private:
  std::int32_t steps_ = 0;
  std::vector<double> presented_, seen_, first_acted_, last_acted_;  ///< [s]
};

}  // namespace lab::runner
