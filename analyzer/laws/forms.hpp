/// The list of closed forms; each one is in a file of its own. Internal to closed_forms.cpp.
#pragma once

#include "analyzer/laws/closed_forms.hpp"

namespace lab::analysis {

[[nodiscard]] ClosedForm abpForm();
[[nodiscard]] ClosedForm noisyAbpForm();
[[nodiscard]] ClosedForm bpForm();
[[nodiscard]] ClosedForm rtpForm();

}  // namespace lab::analysis
