/// Options and checks that several commands share.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/command_line_sources.hpp"

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace lab::runner {

/// A number in [low, high]. CLI11's own ranges accept nan.
CLI::Validator between(double low, double high);

/// A whole number from 0 to the largest that TOML can hold. CLI11 reads -5 as 2^64 - 5.
CLI::Validator wholeNumber();

/// A flag that is on, off or not given. CLI11's own flags take "not given" for off.
void addChoice(CLI::App& command, const std::string& names, std::optional<bool>& choice,
               const std::string& text);

/// --set KEY=VALUE, repeatable. Two values for one key are refused: nobody can know which one is
/// meant.
CLI::Option* addSettings(CLI::App& command, std::vector<std::string>& set,
                         const std::string& text = "Replaces a key of the file (repeatable)");

/// Whether one of the settings KEY=VALUE is of this key.
[[nodiscard]] bool hasSetting(const std::vector<std::string>& set, const std::string& key);

/// Refuses a setting that contradicts what an option says about the same key.
/// @param given the option as typed: "--seed 2"
/// @throws UserError
void refuseContradiction(const std::vector<std::string>& set, const std::string& given,
                         const std::string& key, const std::string& value);

/// The settings and what an option says that stands for a key, as --seed 2 for seed=2.
/// @throws UserError when a setting contradicts the option
[[nodiscard]] std::vector<std::string> withOption(std::vector<std::string> set,
                                                  const std::string& option, const std::string& key,
                                                  const std::string& value);

/// Refuses files and devices for an option that names a folder.
[[nodiscard]] CLI::Validator folderOrNewName();

/// --runs: the folder in which a run gets its folder. --out, its former name in `lab run`, is the
/// same.
void addRunsFolder(CLI::App& command, std::filesystem::path& runs, const std::string& text);

/// FILE: a file, or the name of a shipped experiment.
void addExperiment(CLI::App& command, std::filesystem::path& file);

/// --dds-configuration and --camera-pipeline. A relative path is one from the working folder.
void addSources(CLI::App& command, CommandLineSources& sources);

}  // namespace lab::runner
