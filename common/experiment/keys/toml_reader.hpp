/// Reads the keys of a TOML document into an experiment's form.
#pragma once

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"
#include "common/files/toml_document.hpp"
#include "common/programs/program_file.hpp"

namespace lab::keys {

/// Reads the form. Wrong values are reported to `problems`, and their fields keep the defaults.
/// @param model_of finds the program that `model` names
/// @param check_law of each program; empty: laws are not checked
[[nodiscard]] ExperimentForm readForm(const TomlDocument& document, const ModelLookup& model_of,
                                      const LawCheck& check_law, Problems& problems);

}  // namespace lab::keys
