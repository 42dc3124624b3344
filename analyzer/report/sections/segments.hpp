/// Where and why the free motion of each robot was cut or joined.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// "reversal, joined", "program switch", ...
[[nodiscard]] std::string_view pieceEndText(analysis::PieceEnd reason);

/// segments.csv (docs/stitching.md): one row per piece of free motion, ordered by robot and time.
[[nodiscard]] std::string segmentsCsv(const RunRecord& record);

/// For a run: pieces by the reason of their end, and corrected headings.
[[nodiscard]] nlohmann::ordered_json stitchingJson(const RunRecord& record);

/// For a program: the comparison of windows within pieces with all windows; null if there is none.
[[nodiscard]] nlohmann::ordered_json joinsJson(const analysis::ProgramResult& result);

/// The same in one sentence; empty if there is none.
[[nodiscard]] std::string joinsText(const analysis::ProgramResult& result);

namespace html {

/// The section of report.html: counts by reason, effect of the joins on the curves, corrected
/// headings.
[[nodiscard]] std::string stitching(const RunRecord& record);

}  // namespace html
}  // namespace lab::report
