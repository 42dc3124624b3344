/// Where the rows of a campaign are computed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "runner/campaign/campaign_table.hpp"
#include "runner/campaign/local_engine.hpp"

namespace lab::runner::campaign {

struct EngineOptions {
  std::filesystem::path lab;       ///< the program, as the other processes or hosts find it
  std::size_t jobs = 0;            ///< at a time; 0: as many as there are
  std::size_t bundle = 0;          ///< rows per job; 0: by the time of one row
  std::string slurm;               ///< further options of sbatch
  std::vector<std::string> hosts;  ///< as --sshlogin of GNU parallel
  bool wait = true;                ///< until all jobs have ended
  std::function<void()> watch{};
};

/// Slurm job arrays. Rows without a result are submitted again, at most three times in all. A
/// campaign whose jobs are still in the queue waits for these first.
[[nodiscard]] EngineEnd runBySlurm(CampaignData& data, const std::filesystem::path& folder,
                                   const std::vector<std::size_t>& rows,
                                   const EngineOptions& options);

/// GNU parallel over ssh hosts. Hosts that see the campaign's folder at the same path write into
/// it; to others it is copied, and their results come back in files.
[[nodiscard]] EngineEnd runByParallel(CampaignData& data, const std::filesystem::path& folder,
                                      const std::vector<std::size_t>& rows,
                                      const EngineOptions& options);

/// Writes a Snakemake workflow, or a list of shell commands, into the campaign's folder.
/// @return lines for the terminal: how it is run
[[nodiscard]] std::vector<std::string> writeSnakefile(const std::filesystem::path& folder,
                                                      const std::vector<std::size_t>& rows,
                                                      const EngineOptions& options);
[[nodiscard]] std::vector<std::string> writeCommands(const std::filesystem::path& folder,
                                                     const std::vector<std::size_t>& rows,
                                                     const EngineOptions& options);

/// Looks for the results of rows that others compute, and updates data.survey.
void refreshRows(CampaignData& data, const std::filesystem::path& folder,
                 const std::vector<std::size_t>& rows);

/// The rows that have neither a result nor a failure.
[[nodiscard]] std::vector<std::size_t> missingRows(const CampaignData& data,
                                                   const std::vector<std::size_t>& rows);

/// Writes the results of some rows into one file, to be sent from a host to another.
void writeResultBundle(const CampaignData& data, const std::filesystem::path& folder,
                       const std::vector<std::size_t>& rows, const std::filesystem::path& file);

/// Takes the results of such a file into the campaign. Damaged ones, and results of other runs, are
/// left out.
void takeResultBundle(CampaignData& data, const std::filesystem::path& folder,
                      const std::filesystem::path& file);

}  // namespace lab::runner::campaign
