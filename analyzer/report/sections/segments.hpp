/// Where the free motion of each robot was cut, and where it was joined, and why.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// "reversal, joined", "program switch", ...
[[nodiscard]] std::string_view pieceEndText(analysis::PieceEnd reason);

/// segments.csv (docs/stitching.md): a row for each piece of free motion, ordered by robot and
/// time.
[[nodiscard]] std::string segmentsCsv(const RunRecord& record);

/// Of a run: pieces by the reason for their end, and mended headings.
[[nodiscard]] nlohmann::ordered_json stitchingJson(const RunRecord& record);

/// Of a program: the comparison of windows within pieces with all; null where there is none.
[[nodiscard]] nlohmann::ordered_json joinsJson(const analysis::ProgramResult& result);

/// One sentence on it; empty where there is none.
[[nodiscard]] std::string joinsText(const analysis::ProgramResult& result);

namespace html {

/// Counts by reason, what the joins do to the curves, and mended headings.
[[nodiscard]] std::string stitching(const RunRecord& record);

}  // namespace html
}  // namespace lab::report
