/// Manual adjustment of the projector's corners: `projector_ctl --adjust FILE`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "common/service/service_main.hpp"
#include "projector_ctl/calibration/corner_adjustment.hpp"
#include "projector_ctl/display/display.hpp"

namespace lab::projector {

/// Shows the arena's outline on the display of the experiment until Enter writes the calibration
/// file, or Escape pressed twice discards it. Then stops the loop.
class AdjustService final : public Service {
 public:
  static constexpr std::int64_t kPeriod = 16'667;  ///< [us] between polls of the keys

  /// @param file receives the calibration
  /// @throws DisplayError
  AdjustService(const ServiceContext& context, std::filesystem::path file, const OpenDisplay& open);

 private:
  void look();
  void show();
  bool save();

  Node& node_;
  Loop& loop_;
  std::filesystem::path file_;
  calibration::ProjectorPlane plane_;
  std::unique_ptr<Display> display_;
  CornerAdjustment corners_;
  std::int64_t escape_utime_ = 0;
};

}  // namespace lab::projector
