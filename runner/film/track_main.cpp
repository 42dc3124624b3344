#include <CLI/CLI.hpp>
#include <memory>

#include "runner/command_line/command_line_parts.hpp"
#include "runner/film/film_commands.hpp"

namespace lab::runner {

void addTrack(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<TrackOptions>();
  CLI::App* command = app.add_subcommand("track", summaryOf("track"));
  command
      ->add_option("SOURCE", options->source,
                   "Movie, folder or pattern of pictures, or the folder of a run with a film")
      ->required();
  command->add_option("--calibration", options->calibration,
                      "Calibration of the camera (default for a run: its own)");
  command->add_option("--out", options->out,
                      "File of poses (CSV; default for a run: film/poses.csv in it)");
  addSettings(*command, options->set, "A run: replaces a key of its experiment (repeatable)");
  command->add_option(
      "--overlay", options->overlay,
      "Draw the found and the refused caps: NAME.png a contact sheet; .mp4, .mkv, .avi a "
      "movie; else a folder of pictures");
  command->add_option("--every", options->every, "Use only every N-th frame")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command
      ->add_option(
          "--fps", options->fps,
          "Frames per second, for pictures without frames.csv, or to replace the rate of a movie")
      ->check(between(0.001, 100'000));
  command
      ->add_option("--robots", options->robots,
                   "Number of robots: at most this many, the best, are taken")
      ->check(CLI::Range(1, 100'000));
  command->add_flag("--force", options->force, "Replace existing files");
  command->callback([&chosen, options] { chosen = [options] { return track(*options); }; });
}

}  // namespace lab::runner

int main(int argc, char** argv) {
  return lab::runner::commandMain(argc, argv, lab::runner::addTrack);
}
