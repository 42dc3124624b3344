/// How surely the light selects the intended program, from the light calibration in the log.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

namespace html {

/// The section of report.html: the margin of each light band, and what the sensors would read
/// without the calibration, by place. Empty if the run had no light calibration.
[[nodiscard]] std::string lightBands(const RunRecord& record);

}  // namespace html

/// The block "light_bands" of summary.json; null if the run had no light calibration.
[[nodiscard]] nlohmann::ordered_json lightBandsJson(const RunRecord& record);

}  // namespace lab::report
