/// The list of closed forms; each one is in a file of its own.
#pragma once

#include <array>

#include "analyzer/laws/closed_forms.hpp"

namespace lab::analysis {

[[nodiscard]] ClosedForm abpForm();
[[nodiscard]] ClosedForm noisyAbpForm();
[[nodiscard]] ClosedForm bpForm();
[[nodiscard]] ClosedForm rtpForm();

/// In the order of messages.
inline constexpr std::array kForms{&abpForm, &noisyAbpForm, &bpForm, &rtpForm};

}  // namespace lab::analysis
