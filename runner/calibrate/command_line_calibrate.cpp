#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "runner/calibrate/calibrate_commands.hpp"
#include "runner/campaign/twins/calibrate_twin_command.hpp"
#include "runner/command_line/command_line_parts.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

void addCalibrateCamera(CLI::App& calibrate, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<CalibrateCameraOptions>();
  options->programs = programs;
  CLI::App* command = calibrate.add_subcommand(
      "camera", "Lens and pose, from the arena's corners and the caps in a film");
  command->add_option("SOURCE", options->source,
                      "Film of driving robots: movie, folder or pattern of pictures; or an "
                      "experiment file (TOML), whose lab is started and filmed");
  command->add_option("--corners", options->corners,
                      "\"u,v u,v u,v u,v\": pixels of the arena's inner corners on the floor, "
                      "(0, 0), (width, 0), (width, height), (0, height)");
  command->add_option("--board", options->board, "Columns x rows of discs, spacing in cm")
      ->capture_default_str();
  command->add_option("--board-pictures", options->board_pictures,
                      "Movie or pictures of the board in several poses");
  command->add_option("--print-board", options->print_board,
                      "Only write a drawing of the board: NAME.svg");
  command->add_option("--out", options->out, "The calibration")->capture_default_str();
  command->add_option("--arena-cm", options->arena_cm, "Width x height")->capture_default_str();
  command
      ->add_option("--origin-cm", options->origin_cm,
                   "x,y of the first corner, if the corners are those of a rectangle on the floor")
      ->capture_default_str();
  command->add_option("--camera", options->camera,
                      "Name of the camera, if the experiment file has several");
  const auto addLength = [&](const char* name, double& value, const char* what, double low) {
    command->add_option(name, value, what)->check(between(low, 50))->capture_default_str();
  };
  addLength("--cap-height-cm", options->cap_height_cm, "Height of a robot's cap above the floor",
            0);
  addLength("--cap-radius-cm", options->cap_radius_cm, "Radius of the white cap", 0.5);
  addLength("--robot-radius-cm", options->robot_radius_cm, "Radius of the body", 0.5);
  addLength("--big-radius-cm", options->big_radius_cm, "Radius of the big circle", 0.05);
  addLength("--small-radius-cm", options->small_radius_cm, "Radius of the small circle", 0.05);
  addLength("--spacing-cm", options->spacing_cm, "Distance between the centres of both circles",
            0.5);
  command
      ->add_option("--big-offset-cm", options->big_offset_cm,
                   "Big circle's centre in front of the axis (default: half the spacing)")
      ->check(between(-50, 50));
  command->add_option("--print-caps", options->print_caps,
                      "Only write a drawing of caps: NAME.svg");
  command
      ->add_option("--camera-height-cm", options->camera_height_cm,
                   "Camera above the floor, measured to 1 cm: improves the result")
      ->check(between(10, 5000));
  command->add_option("--corner-px", options->corner_px, "Standard error of the corners in pixels")
      ->check(between(0.02, 20))
      ->capture_default_str();
  command->add_option("--film-s", options->film_s, "With an experiment file: duration of the film")
      ->check(between(5, 3600))
      ->capture_default_str();
  command->add_option("--runs", options->runs, "With an experiment file: folder for the runs")
      ->capture_default_str();
  addSettings(*command, options->set, "With an experiment file: replaces a key (repeatable)");
  addSources(*command, options->sources);
  command->add_flag(
      "--virtual-time", options->virtual_time,
      "With an experiment file: as fast as the machine allows; only camera = \"sim\"");
  command->add_flag("--k3", options->k3, "Fit k3 too: for lenses of short focal length");
  command->add_flag("--force", options->force, "Replace an existing file");
  command->callback(
      [&chosen, options] { chosen = [options] { return calibrateCamera(*options); }; });
}

void addCalibrateProjector(CLI::App& calibrate, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<CalibrateProjectorOptions>();
  options->programs = programs;
  CLI::App* command = calibrate.add_subcommand(
      "projector", "Places of its pixels at sensor height, by structured light and the camera");
  addExperiment(*command, options->file);
  command->add_option("--out", options->out, "The calibration")->capture_default_str();
  command
      ->add_option("--surface-cm", options->surface_cm,
                   "Height of the white board above the floor (default: 5; simulated: sheet_cm)")
      ->check(between(0, 100));
  command->add_option("--projector-cm", options->projector_cm,
                      "x,y,z of its lens, if the board is not at the height of the light sensors");
  command->add_option("--resolution", options->resolution,
                      "Pixels of the display, as 1920x1080, if it is not headless");
  command->add_option("--frames", options->frames, "Camera frames per pattern")
      ->check(CLI::Range(1, 200))
      ->capture_default_str();
  command->add_flag("--virtual-time", options->virtual_time,
                    "One process, as fast as the machine allows, the same to the bit");
  command->add_option("--runs", options->runs, "Folder for the runs")->capture_default_str();
  addSettings(*command, options->set);
  addSources(*command, options->sources);
  command->add_flag("--force", options->force, "Replace existing files");
  command->callback(
      [&chosen, options] { chosen = [options] { return calibrateProjector(*options); }; });
}

void addCalibrateLight(CLI::App& calibrate, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<CalibrateLightOptions>();
  options->programs = programs;
  CLI::App* command = calibrate.add_subcommand(
      "light",
      "The projector's gamma and vignetting, and the robots' light sensors, by a staircase");
  addExperiment(*command, options->file);
  command->add_option("--out", options->out, "The calibration")->capture_default_str();
  command->add_option("--rounds", options->rounds, "Staircases, at different places")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  addChoice(*command, "--camera,!--no-camera", options->camera,
            "Also film the staircase with the camera (default: if it is the tracker)");
  command->add_flag("--virtual-time", options->virtual_time,
                    "One process, as fast as the machine allows, the same to the bit");
  command->add_option("--runs", options->runs, "Folder for the runs")->capture_default_str();
  addSettings(*command, options->set);
  addSources(*command, options->sources);
  command->add_flag("--force", options->force, "Replace an existing file");
  command->callback(
      [&chosen, options] { chosen = [options] { return calibrateLight(*options); }; });
}

}  // namespace

void addCalibrate(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<CalibrateOptions>();
  options->programs = programs;
  CLI::App* command = app.add_subcommand("calibrate", summaryOf("calibrate"));
  command->require_subcommand(1);
  addCalibrateCamera(*command, chosen, programs);
  addCalibrateProjector(*command, chosen, programs);
  addCalibrateLight(*command, chosen, programs);
  CLI::App* motors = command->add_subcommand(
      "motors", "Gain and dead band of each wheel, and the wheel base, by driving");
  addExperiment(*motors, options->file);
  motors->add_flag("--virtual-time", options->virtual_time,
                   "One process, as fast as the machine allows, the same to the bit");
  motors->add_option("--robot", options->robots, "Only these robots (default: all)");
  addRunsFolder(*motors, options->out, "Folder for the runs");
  addSettings(*motors, options->set);
  addSources(*motors, options->sources);
  motors->callback(
      [&chosen, options] { chosen = [options] { return calibrateMotors(*options); }; });
  campaign::addCalibrateTwin(*command, chosen);
}

}  // namespace lab::runner
