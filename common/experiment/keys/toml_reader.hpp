/// Reads the keys of a TOML document into an experiment's form.
#pragma once

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"
#include "common/files/toml_document.hpp"

namespace lab::keys {

/// What the document says; what is wrong goes to `problems`, and that part of the form keeps its
/// default.
[[nodiscard]] ExperimentForm readForm(const TomlDocument& document, Problems& problems);

}  // namespace lab::keys
