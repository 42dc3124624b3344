#include "runner/film/pose_writer.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/output_file.hpp"

namespace lab::runner {

namespace fs = std::filesystem;
namespace {

/// @throws UserError
fs::path checkedOutput(fs::path path, bool may_replace) {
  checkOutput(path, may_replace);
  return path;
}

}  // namespace

PoseWriter::PoseWriter(fs::path path, detector::MarkerKind kind, bool may_replace)
    : file_(checkedOutput(std::move(path), may_replace)), kind_(kind) {
  stream_.open(file_.part(), std::ios::binary);
  if (!stream_) {
    throw UserError(
        fmt::format("{}: cannot be written: {}", file_.path().string(), std::strerror(errno)));
  }
  stream_ << tracker::filmCsvHeader(kind_);
}

void PoseWriter::write(const std::vector<tracker::FilmRow>& rows) {
  for (const tracker::FilmRow& row : rows) stream_ << tracker::filmCsvLine(row, kind_);
  if (!stream_) fail();
}

void PoseWriter::finish() {
  stream_.close();
  if (!stream_) fail();
  file_.finish();
}

void PoseWriter::fail() const {
  throw std::runtime_error(file_.path().string() + ": cannot be written: is the disk full?");
}

}  // namespace lab::runner
