/// Sends the virtual senses of the robots (ROBOT_SENSES).
#pragma once

#include <cstdint>
#include <lab/light_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <optional>

#include "common/experiment/light_messages.hpp"
#include "common/service/service_main.hpp"
#include "light/field/field.hpp"
#include "runner/senses/virtual_senses.hpp"

namespace lab::runner {

/// Takes frames of the tracker at the rate of [senses] and sends the values of each one `delay`
/// after its exposure, or at once if it comes later.
class SenseSender {
 public:
  explicit SenseSender(const ServiceContext& context);

 private:
  void take(const tracked_frame_t& frame);
  void take(const light_status_t& status);

  Node& node_;
  Loop& loop_;
  const Senses& senses_;
  ExperimentImages images_;
  std::optional<light::CompiledField> light_;
  std::int64_t next_utime_ = 0;  ///< frames before it are not used
};

}  // namespace lab::runner
