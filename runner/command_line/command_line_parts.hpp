/// Parts of the command line of `lab`: each function adds commands. CLI11 fills their options in
/// while parsing; `chosen` is called after it.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace lab::runner {

using Chosen = std::function<int()>;

/// A number that is one: CLI11's own ranges let nan pass.
CLI::Validator between(double low, double high);

/// A whole number from 0 on, for the largest of which TOML has room: CLI11 takes -5 for 2^64 - 5.
CLI::Validator wholeNumber();

/// Names the word that is no command, and the commands there are: CLI11 only says that one is
/// missing. @throws UserError where the parsed command line lacks a command.
void requireCommand(const CLI::App& app);

/// A flag that may be given, denied or left out: CLI11's own takes what is left out for denied.
void addChoice(CLI::App& command, const std::string& names, std::optional<bool>& choice,
               const std::string& text);

/// FILE: a file, or the name of a shipped experiment.
void addExperiment(CLI::App& command, std::filesystem::path& file);

/// calibrate camera, projector, light, motors.
void addCalibrate(CLI::App& app, Chosen& chosen, const std::filesystem::path& programs);

/// pause, resume, mark, end: what is wanted of a running experiment or of a log that is played.
void addRequestCommands(CLI::App& app, Chosen& chosen);

/// @param programs folder of the lab's programs
void addWeb(CLI::App& app, Chosen& chosen, const std::filesystem::path& programs);

}  // namespace lab::runner
