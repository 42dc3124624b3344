#include "runner/film/pose_writer.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/files/output_links.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/output_file.hpp"

namespace lab::runner {

namespace fs = std::filesystem;

PoseWriter::PoseWriter(fs::path path, detector::MarkerKind kind, bool may_replace)
    : path_(std::move(path)), part_(path_.string() + ".part"), kind_(kind) {
  checkOutput(path_, may_replace);
  removeLink(part_);
  file_.open(part_, std::ios::binary);
  if (!file_) {
    throw UserError(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
  }
  file_ << tracker::filmCsvHeader(kind_);
}

PoseWriter::~PoseWriter() {
  std::error_code ignored;
  fs::remove(part_, ignored);
}

void PoseWriter::write(const std::vector<tracker::FilmRow>& rows) {
  for (const tracker::FilmRow& row : rows) file_ << tracker::filmCsvLine(row, kind_);
  if (!file_) fail();
}

void PoseWriter::finish() {
  file_.close();
  if (!file_) fail();
  fs::rename(part_, path_);
}

void PoseWriter::fail() const {
  throw std::runtime_error(path_.string() + ": cannot be written: is the disk full?");
}

}  // namespace lab::runner
