#include "runner/export/hdf5_export.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/bus/log_file.hpp"
#include "common/schema/array_groups.hpp"
#include "common/schema/log_tables.hpp"
#include "common/schema/message_table.hpp"
#include "runner/export/hdf5_handles.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using hdf5::check;
using hdf5::Handle;
using schema::Column;
using schema::Kind;
using schema::MessageTable;

constexpr std::size_t kRows = 16384;  // that are collected before they are written
constexpr hsize_t kChunk_bytes = 256 * 1024;
constexpr unsigned kDeflate = 4;

/// Datasets under a name of their own.
constexpr std::pair<const char*, const char*> kNames[] = {
    {"/TRACKED_FRAME/robots", "/poses"},       {"/ROBOT_STATUS/robots", "/states"},
    {"/SIM_TRUTH/robots", "/truth"},           {"/LIGHT_STATUS/messages", "/light"},
    {"/EXPERIMENT_EVENT/messages", "/events"}, {"/ANALYSIS/estimates", "/analysis"},
    {"/COLLECTIVE/observables", "/collective"}};

/// One table on its way into the file.
class TableWriter {
 public:
  TableWriter(const schema::LoggedChannel& logged, std::string path)
      : channel_(logged.channel),
        type_(*logged.type),
        path_(std::move(path)),
        table_(type_, path_),
        lengths_(table_.columns().size(), 1) {}

  [[nodiscard]] const std::string& channel() const { return channel_; }
  [[nodiscard]] std::int64_t hash() const { return type_.hash; }

  /// First pass: the longest text of each column.
  bool measure(std::int64_t event, const Packet& packet) {
    if (!table_.take(event, packet.received_utime, packet.data)) return false;
    if (table_.rows() >= kRows) table_.clear();
    return true;
  }

  /// Between the passes: makes the dataset.
  void create(hid_t file) {
    for (std::size_t i = 0; i < lengths_.size(); ++i) {
      for (const std::string& text : table_.columns()[i].texts.texts()) {
        lengths_[i] = std::max(lengths_[i], text.size());
      }
    }
    table_ = MessageTable(type_, path_);
    makeType();
    makeDataset(file);
  }

  /// Second pass.
  void write(std::int64_t event, const Packet& packet) {
    table_.take(event, packet.received_utime, packet.data);
    if (table_.rows() >= kRows) flush();
  }

  void flush() {
    const std::size_t rows = table_.rows();
    if (rows == 0) return;
    std::vector<std::byte> records(rows * record_bytes_);
    for (std::size_t i = 0; i < lengths_.size(); ++i) copyColumn(i, rows, records.data());
    const hsize_t begin = written_;
    const hsize_t count = rows;
    written_ += rows;
    check(H5Dset_extent(dataset_->get(), &written_), "cannot extend a table: is the disk full?");
    const Handle space(H5Dget_space(dataset_->get()), &H5Sclose, "a table has no space");
    const Handle part(H5Screate_simple(1, &count, nullptr), &H5Sclose, "no space");
    check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &begin, nullptr, &count, nullptr),
          "no rows");
    check(H5Dwrite(dataset_->get(), record_->get(), part.get(), space.get(), H5P_DEFAULT,
                   records.data()),
          "cannot write a table: is the disk full?");
    table_.clear();
  }

 private:
  [[nodiscard]] std::size_t sizeOf(std::size_t column) const {
    const Column& info = table_.columns()[column];
    return info.kind == Kind::kString ? lengths_[column] : info.itemSize();
  }

  void makeType() {
    record_bytes_ = 0;
    for (std::size_t i = 0; i < lengths_.size(); ++i) record_bytes_ += sizeOf(i);
    record_.emplace(H5Tcreate(H5T_COMPOUND, record_bytes_), &H5Tclose, "no type of records");
    std::size_t offset = 0;
    for (std::size_t i = 0; i < lengths_.size(); ++i) {
      const Column& column = table_.columns()[i];
      if (column.kind == Kind::kString) {
        const Handle text(H5Tcopy(H5T_C_S1), &H5Tclose, "no type of texts");
        check(H5Tset_size(text.get(), lengths_[i]), "no type of texts");
        check(H5Tset_strpad(text.get(), H5T_STR_NULLPAD), "no type of texts");
        check(H5Tinsert(record_->get(), column.name.c_str(), offset, text.get()), "no column");
      } else {
        check(H5Tinsert(record_->get(), column.name.c_str(), offset, hdf5::numberType(column.kind)),
              "no column");
      }
      offset += sizeOf(i);
    }
  }

  void makeDataset(hid_t file) {
    const hsize_t none = 0;
    const hsize_t any = H5S_UNLIMITED;
    const hsize_t chunk = std::max<hsize_t>(1, kChunk_bytes / record_bytes_);
    const Handle space(H5Screate_simple(1, &none, &any), &H5Sclose, "no space");
    const Handle how(H5Pcreate(H5P_DATASET_CREATE), &H5Pclose, "no properties");
    check(H5Pset_chunk(how.get(), 1, &chunk), "no chunks");
    check(H5Pset_shuffle(how.get()), "no filter");
    check(H5Pset_deflate(how.get(), kDeflate), "no filter");
    const Handle groups(H5Pcreate(H5P_LINK_CREATE), &H5Pclose, "no properties");
    check(H5Pset_create_intermediate_group(groups.get(), 1), "no groups");
    std::string name = "/" + channel_ + "/" + hdf5::tableName(path_);
    dataset_.emplace(H5Dcreate2(file, name.c_str(), record_->get(), space.get(), groups.get(),
                                how.get(), H5P_DEFAULT),
                     &H5Dclose, "cannot make the table " + name);
    nlohmann::ordered_json units = nlohmann::ordered_json::object();
    nlohmann::ordered_json descriptions = nlohmann::ordered_json::object();
    for (const Column& column : table_.columns()) {
      if (!column.unit.empty()) units[column.name] = column.unit;
      if (!column.comment.empty()) descriptions[column.name] = column.comment;
    }
    hdf5::writeText(dataset_->get(), "type", type_.name);
    hdf5::writeText(dataset_->get(), "units", units.dump());
    hdf5::writeText(dataset_->get(), "descriptions", descriptions.dump());
  }

  void copyColumn(std::size_t index, std::size_t rows, std::byte* records) const {
    const Column& column = table_.columns()[index];
    std::byte* to = records;
    for (std::size_t i = 0; i < index; ++i) to += sizeOf(i);
    const std::byte* from = column.values.data();
    const std::size_t size = column.itemSize();
    for (std::size_t row = 0; row < rows; ++row, to += record_bytes_, from += size) {
      if (column.kind != Kind::kString) {
        std::memcpy(to, from, size);
        continue;
      }
      std::int32_t code = 0;
      std::memcpy(&code, from, sizeof code);
      const std::string& text = column.texts.texts()[static_cast<std::size_t>(code)];
      std::memset(to, 0, lengths_[index]);
      std::memcpy(to, text.data(), text.size());
    }
  }

  std::string channel_;
  const schema::Type& type_;
  std::string path_;
  MessageTable table_;
  std::vector<std::size_t> lengths_;  ///< of texts [bytes]
  std::size_t record_bytes_ = 0;
  std::optional<Handle> record_;
  std::optional<Handle> dataset_;
  hsize_t written_ = 0;
};

}  // namespace

LeftOut writeHdf5(const std::vector<fs::path>& log, const fs::path& file,
                  const std::map<std::string, std::string>& about) {
  hdf5::silence();
  std::set<std::string> names;
  for (const auto& [target, name] : kNames) names.emplace(name + 1);  // without the slash
  TableChannels channels = tableChannels(schema::LogIndex(log), std::move(names));
  LeftOut left_out = std::move(channels.left_out);
  std::vector<std::unique_ptr<TableWriter>> tables;
  std::map<std::string, std::vector<TableWriter*>, std::less<>> by_channel;
  for (const schema::LoggedChannel& logged : channels.kept) {
    for (const std::string& path : schema::tablePaths(*logged.type)) {
      tables.push_back(std::make_unique<TableWriter>(logged, path));
      by_channel[logged.channel].push_back(tables.back().get());
    }
  }
  std::int64_t number = 0;
  readLog(log, [&](const Packet& packet) {
    const std::int64_t event = number++;
    const auto found = by_channel.find(packet.channel);
    bool taken = found != by_channel.end();
    if (taken) {
      for (TableWriter* table : found->second) taken = table->measure(event, packet) && taken;
    }
    if (!taken) left_out.count(packet.channel);
  });

  const Handle out(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), &H5Fclose,
                   "cannot write " + file.string());
  for (const auto& [name, text] : about) hdf5::writeText(out.get(), name, text);
  for (const auto& table : tables) table->create(out.get());
  number = 0;
  readLog(log, [&](const Packet& packet) {
    const std::int64_t event = number++;
    const auto found = by_channel.find(packet.channel);
    if (found == by_channel.end()) return;
    for (TableWriter* table : found->second) table->write(event, packet);
  });
  for (const auto& table : tables) table->flush();
  for (const auto& [target, name] : kNames) {
    const std::string channel = std::string(target).substr(0, std::string(target).rfind('/'));
    if (H5Lexists(out.get(), channel.c_str(), H5P_DEFAULT) <= 0) continue;
    check(H5Lcreate_hard(out.get(), target, out.get(), name, H5P_DEFAULT, H5P_DEFAULT),
          std::string("no name ") + name);
  }
  check(H5Fflush(out.get(), H5F_SCOPE_GLOBAL), "cannot write " + file.string());
  return left_out;
}

}  // namespace lab::runner
