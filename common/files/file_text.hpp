/// Reading whole files. A path may come from a file of a stranger, so that nothing here waits for
/// a device or a pipe, or reads without limit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lab {

/// What a file is expected to be, for messages, and its largest size.
struct FileKind {
  std::string_view name;  ///< "a calibration"
  std::uintmax_t most_bytes = 0;
};

/// Kinds of files that an experiment, or a run's folder, names. A calibration of 250 robots has
/// 100 kB, a table of a day at 50 frames a second 100 MB.
namespace file_kinds {
inline constexpr std::uintmax_t kMega = 1'000'000;
inline constexpr FileKind kExperiment{"an experiment file", kMega};
inline constexpr FileKind kProgram{"a program of motion", 100'000};
inline constexpr FileKind kCalibration{"a calibration", 16 * kMega};
inline constexpr FileKind kMapping{"a topic mapping", kMega};
inline constexpr FileKind kDdsConfiguration{"a Cyclone DDS configuration", kMega};
inline constexpr FileKind kImage{"an image", 64U << 20U};
inline constexpr FileKind kPicture{"a picture of a camera", 512U << 20U};
inline constexpr FileKind kFrameTable{"a table of frames", 512 * kMega};
inline constexpr FileKind kText{"a file", 1024 * kMega};
inline constexpr FileKind kLog{"a log of LCM", UINTMAX_MAX};
inline constexpr FileKind kAny{"a file", UINTMAX_MAX};
inline constexpr FileKind kMovie{"a movie", UINTMAX_MAX};
}  // namespace file_kinds

/// A file's content, or the reason why it cannot be used.
struct FileContent {
  std::optional<std::string> text;
  std::string problem;  ///< without the path: "found a device, expected a calibration: ..."
};

/// Reads a regular file of at most kind.most_bytes. Devices, pipes, sockets, folders and the
/// kernel's files (/proc, /sys) are neither read nor opened.
[[nodiscard]] FileContent readRegularFile(const std::filesystem::path& file, const FileKind& kind);

/// As the problem of readRegularFile(), without reading: for large files that are read in pieces.
[[nodiscard]] std::string regularFileProblem(const std::filesystem::path& file,
                                             const FileKind& kind);

/// The content of a regular file, none if it cannot be read.
[[nodiscard]] std::optional<std::string> readWholeFile(const std::filesystem::path& file,
                                                       const FileKind& kind = file_kinds::kText);

/// The content of a regular file.
/// @throws ExperimentError with path, what was found, what was expected and what to do
[[nodiscard]] std::string readFileText(const std::filesystem::path& file, const FileKind& kind);

}  // namespace lab
