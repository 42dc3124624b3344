#pragma once

#include <string>

namespace lab::report {

/// The PDF without its creation date, so that the same figure gives the same bytes.
/// @throws ReportError if it is not a complete PDF.
[[nodiscard]] std::string undatedPdf(const std::string& pdf);

}  // namespace lab::report
