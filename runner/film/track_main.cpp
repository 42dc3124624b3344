#include <CLI/CLI.hpp>
#include <memory>

#include "runner/command_line/command_line_parts.hpp"
#include "runner/film/film_commands.hpp"
#include "tracker_svc/film_tracking.hpp"

namespace lab::runner {

void addTrack(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<TrackOptions>();
  CLI::App* command = app.add_subcommand("track", summaryOf("track"));
  command
      ->add_option("SOURCE", options->source,
                   "Movie, folder or pattern of pictures, or the folder of a run with a film")
      ->required();
  CLI::Option* calibration =
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
      ->check(CLI::Range(1, static_cast<int>(tracker::FilmTracking::kMostDetections)));
  command->add_flag("--force", options->force, "Replace existing files");
  command->add_option("--marker", options->marker, "What is tracked: caps, blobs or tags")
      ->check(CLI::IsMember({"caps", "blobs", "tags"}))
      ->capture_default_str()
      ->group("Markers");
  command
      ->add_option("--cm-per-px", options->cm_per_px,
                   "Size of a pixel, in place of a calibration: a camera straight above, or a "
                   "microscope")
      ->check(between(1e-9, 1000))
      ->excludes(calibration)
      ->group("Markers");
  command
      ->add_option("--height-cm", options->height_cm,
                   "Height of the markers above the floor; else 0 for blobs, that of the caps for "
                   "tags")
      ->check(between(0, 100))
      ->group("Markers");
  command->add_option("--blob", options->blob_tone, "dark or bright blobs; else dark")
      ->check(CLI::IsMember({"dark", "bright"}))
      ->group("Markers");
  command
      ->add_option("--diameter-cm", options->diameters_cm,
                   "Smallest and largest diameter of a disc with the area of one blob")
      ->expected(2)
      ->group("Markers");
  command
      ->add_option("--max-speed-cm-s", options->max_speed_cm_s,
                   "No blob is faster; else it is learnt from the film")
      ->check(between(1e-6, 100'000))
      ->group("Markers");
  command->add_option("--tag-family", options->tag_family, "Family of AprilTags; else tag36h11")
      ->group("Markers");
  command
      ->add_option("--tag-size-cm", options->tag_size_cm,
                   "Side of a tag, where its black border meets white")
      ->check(between(0.01, 1000))
      ->group("Markers");
  command->callback([&chosen, options] { chosen = [options] { return track(*options); }; });
}

}  // namespace lab::runner

int main(int argc, char** argv) {
  return lab::runner::commandMain(argc, argv, lab::runner::addTrack);
}
