/// Setting the projector's corners by hand: `projector_ctl --adjust FILE`.
#pragma once

#include <filesystem>
#include <memory>

#include "common/service/service_main.hpp"
#include "projector_ctl/calibration/corner_adjustment.hpp"
#include "projector_ctl/display/display.hpp"

namespace lab::projector {

/// Shows the arena's outline on the display that the experiment names, until Enter writes the
/// calibration file or Escape, twice, leaves without. It stops the loop then.
class AdjustService final : public Service {
 public:
  static constexpr std::int64_t kPeriod = 16'667;  ///< [us] between looks at the keys

  /// @param file where the calibration goes
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
