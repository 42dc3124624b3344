#include "runner/export/export_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <memory>
#include <vector>

#include "analyzer/log_source.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/message_values.hpp"
#include "common/camera/run_film.hpp"
#include "common/files/file_text.hpp"
#include "common/files/output_links.hpp"
#include "common/math/units.hpp"
#include "common/process/version.hpp"
#include "common/text/printable.hpp"
#include "runner/command_line/command_line_parts.hpp"
#include "runner/command_line/output_file.hpp"
#include "runner/export/csv_export.hpp"
#include "runner/export/film_pictures.hpp"
#include "runner/export/hdf5_export.hpp"
#include "runner/export/mcap_export.hpp"
#include "runner/export/table_channels.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr FileKind kAttachment{"a summary", 64U << 20U};

/// Thrown to stop reading a log early.
struct Found {};

/// The exposure of the first camera frame in the log; 0: it has none.
std::int64_t firstFrame(const std::vector<fs::path>& log) {
  std::int64_t utime = 0;
  try {
    readLog(log, [&](const Packet& packet) {
      tracked_frame_t frame{};
      if (packet.channel != channels::kTrackedFrame || !decode(packet.data, frame) ||
          impossibleHeader(packet.channel, frame.utime, frame.seq)) {
        return;
      }
      utime = frame.utime;
      throw Found{};
    });
  } catch (const Found&) {
  }
  return utime;
}

/// A file or folder that appears under its name only when it is complete.
class Output {
 public:
  Output(fs::path path, bool force, bool folder) : path_(std::move(path)), part_(path_) {
    part_ += ".part";
    removeLink(part_);
    if (folder && fs::is_directory(path_)) {
      if (!force) {
        throw UserError(fmt::format(
            "{}: is there already; choose another folder with --out, or --force to replace it",
            path_.string()));
      }
    } else {
      checkOutput(path_, force);
    }
    fs::remove_all(part_);
    if (folder) fs::create_directory(part_);
  }
  ~Output() {
    std::error_code ignored;
    if (!kept_) fs::remove_all(part_, ignored);
  }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  [[nodiscard]] const fs::path& part() const { return part_; }

  void keep() {
    fs::remove_all(path_);
    fs::rename(part_, path_);
    kept_ = true;
  }

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  fs::path part_;
  bool kept_ = false;
};

class Exporter {
 public:
  explicit Exporter(const ExportOptions& options)
      : options_(options), log_(report::logFiles(options.input)) {
    fs::path beside = options_.input;
    if (fs::is_directory(options_.input)) {
      folder_ = options_.input;
      if (!beside.has_filename()) beside = beside.parent_path();  // "runs/NAME/"
      // The folders `.` and `..` must get their real names.
      if (beside.filename() == "." || beside.filename() == ".." || beside.empty()) {
        beside = fs::canonical(options_.input);
      }
    } else {
      folder_ = options_.input.parent_path();
      beside.replace_extension();
    }
    name_ = beside.filename().string();
    out_ = options_.out.value_or(beside.parent_path());
    if (out_.empty()) out_ = ".";
    fs::create_directories(out_);
  }

  void write() {
    if (options_.mcap) writeMcapFile();
    if (options_.hdf5) {
      one(".h5", false, [this](const fs::path& file) { return writeHdf5(log_, file, about()); });
    }
    if (options_.csv) {
      one("-csv", true, [this](const fs::path& folder) { return writeCsv(log_, folder); });
    }
    if (options_.trackpy) {
      one("-trackpy.csv", false, [this](const fs::path& file) {
        writeTrackpy(log_, file);
        return LeftOut{};
      });
    }
    if (options_.trex) {
      one("-trex", true, [this](const fs::path& folder) {
        writeTrex(log_, folder, name_);
        return LeftOut{};
      });
    }
  }

 private:
  void one(const std::string& ending, bool folder,
           const std::function<LeftOut(const fs::path&)>& write) {
    Output output(out_ / (name_ + ending), options_.force, folder);
    const LeftOut left_out = write(output.part());
    output.keep();
    tell(output.path(), left_out, "");
  }

  static void tell(const fs::path& path, const LeftOut& left_out, const std::string& more) {
    fmt::print("{}{}\n", printable(path.string()), more);
    if (left_out.messages > 0) {
      fmt::print(
          "         {} message{} left out: damaged, or of a type that this version does not "
          "know\n",
          left_out.messages, left_out.messages == 1 ? "" : "s");
    }
    if (!left_out.channels.empty()) fmt::print("         {}\n", channelsText(left_out));
  }

  void writeMcapFile() {
    McapOptions how{.bus = options_.bus, .ros = options_.ros, .each_robot = options_.each_robot};
    how.library = fmt::format("active-lab {}", kVersion);
    how.attachments = attachments();
    std::string film = options_.film;
    const bool own = film.empty() && fs::is_directory(options_.input);
    std::vector<fs::path> films = own ? camerasFilms(folder_) : std::vector<fs::path>();
    std::erase_if(films, [this](const fs::path& of_camera) {
      return isElsewhere(of_camera / film_files::kMovie);
    });
    if (!films.empty()) {
      film = fmt::format("{} films of the cameras", films.size());
      how.film = camerasPictures(films);
    } else if (own) {
      film = filmOfRun(folder_);
      if (!film.empty() && isElsewhere(film)) film.clear();
    }
    if (films.empty() && !film.empty()) {
      const std::int64_t begin = options_.film_start
                                     ? timeZero(log_) + units::microseconds(*options_.film_start)
                                     : firstFrame(log_);
      how.film = filmPictures(film, begin);
    }
    Output output(out_ / (name_ + ".mcap"), options_.force, false);
    const McapResult result = writeMcap(log_, folder_, output.part(), how);
    output.keep();
    tell(output.path(), {.messages = result.left_out},
         result.pictures > 0
             ? fmt::format(", with {} pictures of {}", result.pictures, printable(film))
             : "");
  }

  /// The export is passed on: it holds nothing to which the folder of a stranger links.
  /// @param film a movie, or a folder of pictures
  [[nodiscard]] bool isElsewhere(const fs::path& film) const {
    bool elsewhere = leadsOutOf(folder_, film);
    if (!elsewhere && fs::is_directory(film)) {
      for (const auto& entry : fs::directory_iterator(film)) {
        elsewhere = elsewhere || leadsOutOf(folder_, entry.path());
      }
    }
    if (!elsewhere) return false;
    fmt::print(
        "note     {} leads out of the folder of the run and is left out; --film FILE takes a "
        "film\n",
        printable(film.string()));
    return true;
  }

  [[nodiscard]] std::map<std::string, std::string> attachments() const {
    std::map<std::string, std::string> texts;
    if (const auto start = report::findStart(log_)) texts["experiment.toml"] = start->text;
    for (const char* name : {"summary.json", "provenance.json"}) {
      const fs::path file = folder_ / name;
      if (!fs::is_directory(options_.input) || isLink(file)) continue;
      if (auto text = readWholeFile(file, kAttachment)) texts[name] = std::move(*text);
    }
    return texts;
  }

  [[nodiscard]] std::map<std::string, std::string> about() const {
    std::map<std::string, std::string> texts{
        {"format", "active-lab tables 1"},
        {"run", name_},
        {"version", kVersion},
        {"start_utime", std::to_string(timeZero(log_))},
    };
    if (const auto start = report::findStart(log_)) texts["experiment"] = start->text;
    return texts;
  }

  const ExportOptions& options_;
  std::vector<fs::path> log_;
  fs::path folder_;  ///< of the run
  fs::path out_;
  std::string name_;
};

}  // namespace

ExitCode exportRun(const ExportOptions& options) {
  if (!(options.mcap || options.hdf5 || options.csv || options.trackpy || options.trex)) {
    throw UserError(
        "export: found no format, expected at least one of --mcap, --hdf5, --csv, --trackpy, "
        "--trex");
  }
  if (options.mcap && !options.bus && !options.ros) {
    throw UserError("export: --no-bus and --no-ros leave nothing to write; leave one of them out");
  }
  Exporter(options).write();
  return kDone;
}

void addExport(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand("export", summaryOf("export"));
  command->add_option("RUN|LOG", options->input, "Folder of a run, or a log")->required();
  command->add_flag("--mcap", options->mcap,
                    "For Rerun, Foxglove, Lichtblick, PlotJuggler, ROS 2: RUN.mcap");
  command->add_flag("--hdf5", options->hdf5, "For pandas, h5py, MATLAB, R: RUN.h5");
  command->add_flag("--csv", options->csv, "One file per table, in the folder RUN-csv");
  command->add_flag("--trackpy", options->trackpy, "Poses for trackpy: RUN-trackpy.csv");
  command->add_flag("--trex", options->trex, "Poses as TRex exports them, in the folder RUN-trex");
  command->add_option("--out", options->out, "Folder for the results (default: beside the input)");
  command->add_flag("--force", options->force, "Replace existing files");
  command->add_flag("!--no-bus", options->bus,
                    "MCAP without the messages of the bus; lab analyze needs these");
  command->add_flag("!--no-ros", options->ros, "MCAP without the topics of docs/ros2.md");
  addChoice(*command, "--each-robot,!--no-each-robot", options->each_robot,
            "MCAP with topics of single robots (default: up to 20 robots)");
  command->add_option("--film", options->film,
                      "MCAP: movie or folder of pictures (default: the one in the run's folder)");
  command
      ->add_option("--film-start-s", options->film_start,
                   "Time of its first picture in s of the report (default: the first camera frame)")
      ->check(between(-1e9, 1e9));
  command->callback([&chosen, options] { chosen = [options] { return exportRun(*options); }; });
}

}  // namespace lab::runner
