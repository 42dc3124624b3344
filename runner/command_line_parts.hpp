/// Parts of the command line of `lab`: each function adds commands. CLI11 fills their options in
/// while parsing; `chosen` is called after it.
#pragma once

#include <filesystem>
#include <functional>

namespace CLI {
class App;
}

namespace lab::runner {

using Chosen = std::function<int()>;

/// pause, resume, mark, end: what is wanted of a running experiment or of a log that is played.
void addWishes(CLI::App& app, Chosen& chosen);

/// @param programs folder of the lab's programs
void addWeb(CLI::App& app, Chosen& chosen, const std::filesystem::path& programs);

}  // namespace lab::runner
