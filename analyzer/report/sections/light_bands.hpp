/// How surely the light selects the programs that it should, from the calibration in the log.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "analyzer/report/record/run_record.hpp"
#include "common/calibration/light_file.hpp"
#include "light/photometry/light_margin.hpp"

namespace lab::report {

/// One for each band of the experiment's light table.
[[nodiscard]] std::vector<calibration::BandMargin> lightMargins(const LightCalibration& calibration,
                                                                const Experiment& experiment);

namespace html {

/// Margins of the bands, and what each would come to without the calibration, place by place. Empty
/// where the run had none.
[[nodiscard]] std::string lightBands(const RunRecord& record);

}  // namespace html

/// The same for programs; null where the run had no calibration of light.
[[nodiscard]] nlohmann::ordered_json lightBandsJson(const RunRecord& record);

}  // namespace lab::report
