#include "runner/campaign/engines/bundles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "common/text/printable.hpp"
#include "runner/campaign/campaign.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr double kBundle_s = 60;

void requireOneLine(const std::string& text) {
  const bool plain = std::ranges::all_of(text, [](char letter) {
    const auto byte = static_cast<unsigned char>(letter);
    return byte >= 0x20 && byte != 0x7F;
  });
  if (plain) return;
  throw UserError(fmt::format(
      "{}: found a control character, such as the end of a line, expected a path that a script can "
      "hold in one line; rename the folder",
      printable(text)));
}

/// A string of Python.
std::string pythonText(const std::string& text) {
  requireOneLine(text);
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + "\"";
}

}  // namespace

std::vector<Bundle> bundlesOf(const std::vector<std::size_t>& rows, std::size_t size) {
  std::vector<Bundle> bundles;
  for (std::size_t i = 0; i < rows.size(); i += size) {
    const std::size_t end = std::min(rows.size(), i + size);
    bundles.emplace_back(rows.begin() + static_cast<std::ptrdiff_t>(i),
                         rows.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return bundles;
}

std::size_t bundleSize(std::size_t rows, double seconds, std::size_t most) {
  const double by_time = std::ceil(kBundle_s / std::max(seconds, 1e-3));
  const std::size_t by_count = (rows + most - 1) / std::max<std::size_t>(1, most);
  const auto size = std::max(by_count, static_cast<std::size_t>(by_time));
  return std::clamp<std::size_t>(size, 1, std::max<std::size_t>(1, rows));
}

void requireScriptable(const fs::path& path, const std::string& engine) {
  requireOneLine(path.string());
  // In a command, {2} is an argument and {= ... =} is Perl.
  if (engine != "parallel" || path.string().find('{') == std::string::npos) return;
  throw UserError(fmt::format(
      "{}: found a brace, between which GNU parallel replaces and executes text, expected none; "
      "rename the folder, or choose another --engine",
      path.string()));
}

std::string shellWord(const std::string& text) {
  requireOneLine(text);
  const bool plain = !text.empty() && std::ranges::all_of(text, [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
           (letter >= '0' && letter <= '9') ||
           std::string_view("/._-,:=+@").find(letter) != std::string_view::npos;
  });
  if (plain) return text;
  std::string quoted = "'";
  for (const char letter : text) {
    quoted += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  }
  return quoted + "'";
}

std::string workerCommand(const fs::path& lab, const fs::path& campaign, const Bundle& rows) {
  return fmt::format("{} sweep {} --rows {}", shellWord(lab.string()), shellWord(campaign.string()),
                     rowNumbersText(rows));
}

std::string bundleLines(const std::vector<Bundle>& bundles) {
  std::string text;
  for (const Bundle& bundle : bundles) text += rowNumbersText(bundle) + "\n";
  return text;
}

std::string slurmScript(const std::string& name, const fs::path& lab, const fs::path& campaign,
                        const fs::path& bundles) {
  return fmt::format(
      "#!/bin/sh\n"
      "# A campaign of lab sweep: the n-th task of the array computes the n-th line of its list.\n"
      "#SBATCH --job-name={0}\n"
      "#SBATCH --ntasks=1\n"
      "#SBATCH --cpus-per-task=1\n"
      "rows=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" {2})\n"
      "exec {1} sweep {3} --rows \"$rows\"\n",
      name, shellWord(lab.string()), shellWord(bundles.string()), shellWord(campaign.string()));
}

std::string snakefileText(const fs::path& lab, const fs::path& campaign,
                          const std::vector<Bundle>& bundles) {
  std::string text = fmt::format(
      "# A campaign of lab sweep. In this folder: snakemake --cores all\n"
      "# Each rule computes some rows. What has a result is not computed again.\n"
      "import shlex\n\n"
      "LAB = shlex.quote({})\n"
      "CAMPAIGN = shlex.quote({})\n"
      "ROWS = [\n",
      pythonText(lab.string()), pythonText(campaign.string()));
  for (const Bundle& bundle : bundles) {
    text += fmt::format("    {},\n", pythonText(rowNumbersText(bundle)));
  }
  return text +
         "]\n\n"
         "rule tables:\n"
         "    input: expand(\"snakemake/{n}.done\", n=range(len(ROWS)))\n"
         "    output: touch(\"snakemake/tables.done\")\n"
         "    shell: \"{LAB} sweep {CAMPAIGN} --no-run\"\n\n"
         "rule rows:\n"
         "    output: touch(\"snakemake/{n}.done\")\n"
         "    params: rows=lambda wildcards: ROWS[int(wildcards.n)]\n"
         "    shell: \"{LAB} sweep {CAMPAIGN} --rows {params.rows}\"\n";
}

std::string commandsText(const fs::path& lab, const fs::path& campaign,
                         const std::vector<Bundle>& bundles) {
  std::string text;
  for (const Bundle& bundle : bundles) text += workerCommand(lab, campaign, bundle) + "\n";
  return text;
}

}  // namespace lab::runner::campaign
