/// How long the steps of a run took to arrive so far.
#pragma once

#include <lab/experiment_event_t.hpp>
#include <lab/light_delivery_t.hpp>
#include <vector>

namespace lab::runner {

class DeliveryTimes {
 public:
  /// @param step whose watch is over
  void add(const experiment_event_t& step);

  /// For LIGHT_DELIVERY; its header is left empty. Delays that never happened are left out.
  [[nodiscard]] light_delivery_t message() const;

 private:
  std::int32_t steps_ = 0;
  std::vector<double> presented_, seen_, first_acted_, last_acted_;  ///< [s]
};

}  // namespace lab::runner
