/// Results as ANALYSIS messages.
#pragma once

#include <cstddef>
#include <lab/analysis_t.hpp>
#include <string>

#include "analyzer/analysis_feed.hpp"

namespace lab::analysis {

/// An ANALYSIS message is smaller than this [bytes].
inline constexpr std::size_t kLargestAnalysis = 8000;

/// The result as a message, header left empty. Lags without windows are left out; where the message
/// would not fit, notes are cut short first and then lags dropped evenly, the first and last kept.
/// @param program_name of the experiment file.
[[nodiscard]] analysis_t toMessage(const FeedResult& result, const std::string& program_name);

}  // namespace lab::analysis
