#include "runner/export/hdf5_import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/files/file_text.hpp"
#include "common/process/limited_call.hpp"
#include "common/schema/array_groups.hpp"
#include "common/schema/lcm_writer.hpp"
#include "common/schema/message_table.hpp"
#include "common/schema/schema.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/export/hdf5_handles.hpp"
#include "runner/export/hdf5_poses.hpp"
#include "runner/export/hdf5_table.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using hdf5::check;
using hdf5::Handle;
using hdf5::kindOf;
using hdf5::ReadFile;
using hdf5::TableReader;
using schema::Field;
using schema::Kind;
using schema::Type;

constexpr FileKind kHdf5File{"an HDF5 file", UINTMAX_MAX};

/// A table from which messages take their rows, one after the other.
struct Source {
  std::unique_ptr<TableReader> table;  ///< null: the file does not have it, so all lists are empty
  hsize_t next = 0;                    ///< the first row that belongs to no message yet
  hsize_t count = 0;                   ///< of the rows of the present list
};

/// How a struct is made of rows.
struct Step {
  enum class Do { kNumber, kText, kCount, kNumbers, kTexts, kStructs };
  Do what = Do::kNumber;
  std::size_t size = 0;
  std::size_t column = 0;
  Source* source = nullptr;  ///< of a list
  std::size_t part = 0;      ///< plan of its elements
};
struct Plan {
  std::vector<Step> steps;
  std::vector<Source*> lists;
};

/// The messages of one channel.
class Channel {
 public:
  Channel(const ReadFile& file, std::string name, const Type& type)
      : name_(std::move(name)), type_(type) {
    for (const std::string& path : schema::tablePaths(type)) {
      Source& source = sources_[path];
      const std::string table = name_ + "/" + hdf5::tableName(path);
      if (!path.empty() && kindOf(file, table) == H5I_BADID) continue;
      source.table = std::make_unique<TableReader>(file, "/" + table,
                                                   schema::MessageTable::allColumns(type, path));
    }
    messages_ = &sources_.at("");
    root_ = plan(type, "", "", *messages_);
    event_ = static_cast<std::size_t>(messages_->table->indexOf(schema::columns::kEvent));
    received_ = static_cast<std::size_t>(messages_->table->indexOf(schema::columns::kReceived));
  }

  /// Number of the next message in the log; nothing: there is none.
  [[nodiscard]] std::optional<std::int64_t> nextEvent() {
    if (messages_->next == messages_->table->rows()) {
      requireEnd();
      return std::nullopt;
    }
    messages_->table->require(messages_->next, messages_->next + 1);
    return static_cast<std::int64_t>(messages_->table->bits(messages_->next, event_));
  }

  void write(LogWriter& log) {
    const hsize_t row = messages_->next;
    encoding_.clear();
    encoding_.number(static_cast<std::uint64_t>(type_.hash), sizeof type_.hash);
    encode(plans_[root_], *messages_->table, row);
    log.write({name_, encoding_.bytes(),
               static_cast<std::int64_t>(messages_->table->bits(row, received_))});
    ++messages_->next;
  }

 private:
  std::size_t plan(const Type& type, const std::string& prefix, const std::string& path,
                   Source& row) {
    Plan result;
    addSteps(type, prefix, path, row, result);
    plans_.push_back(std::move(result));
    return plans_.size() - 1;
  }

  void addSteps(const Type& type, const std::string& prefix, const std::string& path, Source& row,
                Plan& plan) {
    const std::vector<schema::ArrayGroup> groups = schema::arrayGroups(type);
    std::map<int, Source*> counted;
    for (const schema::ArrayGroup& group : groups) {
      Source& source = sources_.at((path.empty() ? "" : path + ".") + prefix + group.name);
      counted[group.count_field] = &source;
      if (source.table != nullptr) plan.lists.push_back(&source);
    }
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
      const Field& field = type.fields[i];
      const std::size_t size = schema::sizeOf(field.kind);
      if (field.count_field >= 0) {
        if (counted.at(field.count_field)->table == nullptr) continue;
        const auto group =
            std::ranges::find(groups, field.count_field, &schema::ArrayGroup::count_field);
        addList(field, *group, (path.empty() ? "" : path + ".") + prefix + group->name,
                *counted.at(field.count_field), plan);
      } else if (const auto list = counted.find(static_cast<int>(i)); list != counted.end()) {
        plan.steps.push_back({.what = Step::Do::kCount, .size = size, .source = list->second});
      } else if (field.type != nullptr) {
        for (std::size_t element = 0; element < field.count; ++element) {
          const std::string index = field.array ? std::to_string(element) + "_" : "";
          addSteps(*field.type, prefix + field.name + "_" + index, path, row, plan);
        }
      } else {
        // The elements of a list of fixed length are columns beside each other, whatever their
        // names.
        const std::size_t first = columnOf(field, prefix, *row.table);
        for (std::size_t element = 0; element < field.count; ++element) {
          plan.steps.push_back(
              {.what = field.kind == Kind::kString ? Step::Do::kText : Step::Do::kNumber,
               .size = size,
               .column = first + element});
        }
      }
    }
  }

  void addList(const Field& field, const schema::ArrayGroup& group, const std::string& path,
               Source& source, Plan& plan) {
    Step step{.what = Step::Do::kNumbers, .size = schema::sizeOf(field.kind), .source = &source};
    if (field.type != nullptr) {
      step.what = Step::Do::kStructs;
      step.part =
          this->plan(*field.type, group.fields.size() > 1 ? field.name + "_" : "", path, source);
    } else {
      if (field.kind == Kind::kString) step.what = Step::Do::kTexts;
      step.column = columnOf(field, "", *source.table);
    }
    plan.steps.push_back(step);
  }

  static std::size_t columnOf(const Field& field, const std::string& prefix,
                              const TableReader& table) {
    const std::string name = prefix + field.name;
    int index = table.indexOf(name);
    const bool elements = field.array && field.count_field < 0;
    if (index == TableReader::kNone && elements) index = table.firstWith(name + "_");
    if (index == TableReader::kNone) table.fail("has no column " + name);
    return static_cast<std::size_t>(index);
  }

  void encode(const Plan& plan, TableReader& table, hsize_t row) {
    for (Source* list : plan.lists) list->count = list->table->children(list->next, row);
    for (const Step& step : plan.steps) {
      switch (step.what) {
        case Step::Do::kNumber:
          encoding_.number(table.bits(row, step.column), step.size);
          break;
        case Step::Do::kText:
          encoding_.text(table.text(row, step.column));
          break;
        case Step::Do::kCount:
          encoding_.number(step.source->count, step.size);
          break;
        default:
          encodeList(step);
      }
    }
    for (Source* list : plan.lists) {
      list->next += list->count;
      list->count = 0;
    }
  }

  void encodeList(const Step& step) {
    Source& source = *step.source;
    const hsize_t begin = source.next;
    const hsize_t end = begin + source.count;
    for (hsize_t row = begin; row < end; ++row) {
      source.table->require(begin, end);
      if (step.what == Step::Do::kNumbers) {
        encoding_.number(source.table->bits(row, step.column), step.size);
      } else if (step.what == Step::Do::kTexts) {
        encoding_.text(source.table->text(row, step.column));
      } else {
        encode(plans_[step.part], *source.table, row);
      }
    }
  }

  void requireEnd() const {
    for (const auto& [path, source] : sources_) {
      if (source.table == nullptr || source.next == source.table->rows()) continue;
      source.table->fail(
          fmt::format("has rows that belong to no message, from row {} on", source.next));
    }
  }

  std::string name_;
  const Type& type_;
  std::map<std::string, Source> sources_;
  Source* messages_ = nullptr;
  std::vector<Plan> plans_;
  std::size_t root_ = 0;
  std::size_t event_ = 0, received_ = 0;
  schema::LcmWriter encoding_;
};

/// Channels with their types.
std::vector<std::pair<std::string, const Type*>> channelsOf(const ReadFile& file) {
  std::vector<std::pair<std::string, const Type*>> channels;
  for (const std::string& name : hdf5::linksOf(file.id)) {
    const std::string table = name + "/messages";
    if (kindOf(file, name) != H5I_GROUP || kindOf(file, table) != H5I_DATASET) continue;
    const Handle dataset = hdf5::openTable(file, table);
    const Type* type = schema::messageSchema().find(hdf5::readText(dataset.get(), "type"));
    if (type != nullptr) channels.emplace_back(name, type);
  }
  return channels;
}

void writeLog(const ReadFile& file,
              const std::vector<std::pair<std::string, const Type*>>& log_channels,
              LogWriter& writer) {
  std::vector<std::unique_ptr<Channel>> channels;
  for (const auto& [name, type] : log_channels) {
    channels.push_back(std::make_unique<Channel>(file, name, *type));
  }
  std::vector<std::optional<std::int64_t>> events;
  for (const auto& channel : channels) events.push_back(channel->nextEvent());
  while (true) {
    std::size_t first = channels.size();
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (events[i] && (first == channels.size() || *events[i] < *events[first])) first = i;
    }
    if (first == channels.size()) break;
    channels[first]->write(writer);
    events[first] = channels[first]->nextEvent();
  }
  writer.flush();
}

constexpr const char* kLog = "log";
constexpr const char* kPoses = "poses";

/// What importHdf5() does in the child.
/// @returns kLog or kPoses
std::string readHere(const fs::path& file, std::uint64_t bytes, const fs::path& log,
                     const fs::path& poses) {
  hdf5::silence();
  const Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), &H5Fclose,
                      "cannot open the file: it is damaged");
  LogWriter log_writer(log);
  std::ofstream csv(poses);
  check(H5PLset_loading_state(0), "cannot turn plug-ins off");
  refuseFurtherFiles();
  const ReadFile read{opened.get(), bytes};
  if (const auto channels = channelsOf(read); !channels.empty()) {
    writeLog(read, channels, log_writer);
    return kLog;
  }
  hdf5::writePoses(read, csv);
  return kPoses;
}

}  // namespace

bool isHdf5(const fs::path& file) {
  // HDF5 File Format Specification 3.0, II.A: the superblock begins at 0, 512, 1024, 2048, ...
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
  if (!regularFileProblem(file, file_kinds::kAny).empty()) return false;
  std::ifstream stream(file, std::ios::binary);
  std::string begin(kSignature.size(), '\0');
  for (std::streamoff at = 0; stream.seekg(at); at = at == 0 ? 512 : 2 * at) {
    if (!stream.read(begin.data(), static_cast<std::streamsize>(begin.size()))) return false;
    if (begin == kSignature) return true;
  }
  return false;
}

Hdf5Content importHdf5(const fs::path& file, const fs::path& log, const fs::path& poses) {
  if (const std::string problem = regularFileProblem(file, kHdf5File); !problem.empty()) {
    throw UserError(file.string() + ": " + problem);
  }
  const std::uint64_t bytes = fs::file_size(file);
  // An export of an hour with 250 robots has 1 GB.
  const CallLimits limits{.processor = std::chrono::seconds(30 + bytes / 100'000),
                          .memory_bytes = 1'000'000'000,
                          .file_bytes = 1'000'000'000 + 30 * bytes};
  try {
    const std::string content =
        callLimited(limits, [&] { return readHere(file, bytes, log, poses); });
    return content == kLog ? Hdf5Content::kLog : Hdf5Content::kPoses;
  } catch (const std::exception& error) {
    throw UserError(file.string() + ": " + error.what());
  }
}

}  // namespace lab::runner
