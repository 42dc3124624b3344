/// Results as ANALYSIS messages.
#pragma once

#include <cstddef>
#include <lab/analysis_t.hpp>
#include <string>

#include "analyzer/analysis_feed.hpp"

namespace lab::analysis {

/// An ANALYSIS message is smaller than this [bytes].
inline constexpr std::size_t kLargestAnalysis = 8000;

/// The result as a message, header left empty. Lags without windows are omitted. If the message is
/// too large, notes are truncated first, then lags are dropped evenly, except the first and the
/// last one.
/// @param program_name name of the program in the experiment file
[[nodiscard]] analysis_t toMessage(const FeedResult& result, const std::string& program_name);

}  // namespace lab::analysis
