/// Reads the keys of a TOML document into an experiment's form.
#pragma once

#include "common/experiment_form.hpp"
#include "common/experiment_problems.hpp"
#include "common/toml_document.hpp"

namespace lab::keys {

/// What the document says; what is wrong goes to `problems`, and that part of the form keeps its
/// default.
[[nodiscard]] ExperimentForm readForm(const TomlDocument& document, Problems& problems);

}  // namespace lab::keys
