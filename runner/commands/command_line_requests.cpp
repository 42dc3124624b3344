#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "runner/command_line/command_line_parts.hpp"
#include "runner/commands/commands.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

/// A command, and what its words are called; none: it takes none.
struct Wish {
  const char* name;
  const char* meaning;
  ExitCode (*act)(const RequestOptions&);
  const char* words = nullptr;
  const char* words_meaning = nullptr;
  bool words_needed = false;
};

constexpr Wish kWishes[] = {
    {"pause", "The script's clock stands; light and robots go on as they are", pauseScript},
    {"resume", "The script goes on where it was paused", resumeScript},
    {"mark", "Writes a remark into the run's record", markRun, "TEXT", "The remark", true},
    {"end", "Ends the run as Ctrl-C does: data kept, report written", endRun, "WHY",
     "Reason, for the record"},
};

void addWish(CLI::App& app, Chosen& chosen, const Wish& wish) {
  auto options = std::make_shared<RequestOptions>();
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand(wish.name, wish.meaning);
  if (wish.words != nullptr) {
    command->add_option(wish.words, *words, wish.words_meaning)->required(wish.words_needed);
  }
  command->add_option("--lab", options->lab, "Which lab, when several run");
  command->callback([&chosen, options, words, act = wish.act] {
    options->text = fmt::format("{}", fmt::join(*words, " "));
    chosen = [options, act] { return act(*options); };
  });
}

}  // namespace

void addRequestCommands(CLI::App& app, Chosen& chosen) {
  for (const Wish& wish : kWishes) addWish(app, chosen, wish);
}

void addWeb(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<WebOptions>();
  options->programs = programs;
  CLI::App* command = app.add_subcommand(
      "web", "The page in a browser without a lab: past runs, comparisons, starting an experiment");
  command->add_option("--port", options->port, "The first one tried (default: 8480)")
      ->check(CLI::Range(1024, 65535));
  command->add_option("--runs", options->runs, "Folder of past runs")->capture_default_str();
  command->add_flag("--open", options->open, "Show it in your browser");
  command->callback([&chosen, options] { chosen = [options] { return web(*options); }; });
}

}  // namespace lab::runner
