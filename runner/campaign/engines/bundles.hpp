/// Rows in bundles, for engines that start a process for each. Pure functions.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace lab::runner::campaign {

using Bundle = std::vector<std::size_t>;  ///< rows, rising

/// Bundles of `size` rows.
[[nodiscard]] std::vector<Bundle> bundlesOf(const std::vector<std::size_t>& rows, std::size_t size);

/// The number of rows in a bundle: as many as take about a minute, so that starting a job costs
/// little, and not more than `most` bundles.
/// @param seconds of one row
[[nodiscard]] std::size_t bundleSize(std::size_t rows, double seconds, std::size_t most);

/// Checks a path that goes into the scripts and commands of an engine. The folder of a campaign may
/// come from a stranger.
/// @throws UserError if it could end a line or, for the engine parallel, be replaced or executed
void requireScriptable(const std::filesystem::path& path, const std::string& engine);

/// A word for a POSIX shell, on one line.
/// @throws UserError if it has control characters
[[nodiscard]] std::string shellWord(const std::string& text);

/// The command that computes the rows, for a POSIX shell.
[[nodiscard]] std::string workerCommand(const std::filesystem::path& lab,
                                        const std::filesystem::path& campaign, const Bundle& rows);

/// One line per bundle: "0-9,12".
[[nodiscard]] std::string bundleLines(const std::vector<Bundle>& bundles);

/// The job script of a Slurm array, whose n-th task computes the n-th line of `bundles`.
/// @param name of an experiment: sbatch takes what follows a space for further options
[[nodiscard]] std::string slurmScript(const std::string& name, const std::filesystem::path& lab,
                                      const std::filesystem::path& campaign,
                                      const std::filesystem::path& bundles);

/// A Snakemake workflow with a rule for each bundle, and one for the tables.
[[nodiscard]] std::string snakefileText(const std::filesystem::path& lab,
                                        const std::filesystem::path& campaign,
                                        const std::vector<Bundle>& bundles);

/// A shell command per bundle.
[[nodiscard]] std::string commandsText(const std::filesystem::path& lab,
                                       const std::filesystem::path& campaign,
                                       const std::vector<Bundle>& bundles);

}  // namespace lab::runner::campaign
