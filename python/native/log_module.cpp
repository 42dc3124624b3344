// Logs: contents, tables, messages.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/schema/log_tables.hpp"
#include "common/schema/message_table.hpp"
#include "python/native/module.hpp"
#include "python/native/types.hpp"

namespace lab::python {
namespace py = pybind11;
namespace fs = std::filesystem;
namespace {

using Paths = std::vector<fs::path>;

const char* dtypeOf(schema::Kind kind) {
  switch (kind) {
    case schema::Kind::kBoolean:
      return "?";
    case schema::Kind::kByte:
      return "u1";
    case schema::Kind::kInt8:
      return "i1";
    case schema::Kind::kInt16:
      return "<i2";
    case schema::Kind::kInt32:
      return "<i4";
    case schema::Kind::kInt64:
      return "<i8";
    case schema::Kind::kFloat:
      return "<f4";
    case schema::Kind::kDouble:
      return "<f8";
    default:
      return "<i4";  // the code of a text
  }
}

/// An array that owns the column's memory.
py::array arrayOf(schema::Column& column, std::size_t rows) {
  if (rows == 0) return py::array(py::dtype(dtypeOf(column.kind)), std::vector<py::ssize_t>{0});
  auto block = column.values.release(rows * column.itemSize());
  std::byte* data = block.get();
  const py::capsule owner(block.release(), [](void* memory) {
    schema::ColumnMemory::Free()(static_cast<std::byte*>(memory));
  });
  return py::array(py::dtype(dtypeOf(column.kind)), {static_cast<py::ssize_t>(rows)},
                   {static_cast<py::ssize_t>(column.itemSize())}, data, owner);
}

/// A text of a file, which may be damaged.
py::str textOf(std::string_view text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
}

py::tuple tableOf(const schema::LogIndex& log, const std::string& channel, const std::string& type,
                  const std::string& path, const std::optional<std::vector<std::string>>& columns,
                  const schema::ChannelCheck* check) {
  std::optional<schema::LoadedTable> loaded;
  {
    const py::gil_scoped_release released;
    loaded.emplace(schema::loadTable(log, channel, typeOf(type), path, columns, check));
  }
  const std::size_t rows = loaded->table.rows();
  py::dict result;
  for (schema::Column& column : loaded->table.columns()) {
    if (column.kind == schema::Kind::kString) {
      py::list texts;
      for (const std::string& text : column.texts.texts()) {
        texts.append(textOf(text));
      }
      result[py::str(column.name)] = py::make_tuple(arrayOf(column, rows), texts);
    } else {
      result[py::str(column.name)] = arrayOf(column, rows);
    }
  }
  return py::make_tuple(result, rows, loaded->undecodable);
}

std::unique_ptr<schema::LogIndex> indexOf(Paths files) {
  const py::gil_scoped_release released;
  return std::make_unique<schema::LogIndex>(std::move(files));
}

schema::ChannelCheck checkOf(const schema::LogIndex& log, const std::string& channel,
                             const std::string& type) {
  const py::gil_scoped_release released;
  return schema::checkChannel(log, channel, typeOf(type));
}

py::list channelsOf(const schema::LogIndex& log) {
  py::list channels;
  for (const schema::LoggedChannel& logged : log.channels()) {
    py::dict entry;
    entry["channel"] = textOf(logged.channel);
    entry["type"] = logged.type == nullptr ? py::object(py::none()) : py::str(logged.type->name);
    entry["messages"] = logged.messages;
    entry["bytes"] = logged.bytes;
    entry["first_utime"] = logged.first_utime;
    entry["last_utime"] = logged.last_utime;
    channels.append(entry);
  }
  return channels;
}

/// The messages of some channels, one after the other.
class Messages {
 public:
  Messages(Paths files, std::optional<std::set<std::string>> channels)
      : reader_(std::move(files)), channels_(std::move(channels)) {}

  py::tuple next() {
    std::optional<Packet> packet;
    {
      const py::gil_scoped_release released;
      do {
        packet = reader_.next();
      } while (packet && channels_ && !channels_->contains(std::string(packet->channel)));
    }
    if (!packet) throw py::stop_iteration();
    return py::make_tuple(
        textOf(packet->channel), packet->received_utime,
        py::bytes(reinterpret_cast<const char*>(packet->data.data()), packet->data.size()));
  }

 private:
  LogReader reader_;
  std::optional<std::set<std::string>> channels_;
};

}  // namespace

void addLogs(py::module_& module) {
  module.def("is_log", &isLog, py::arg("file"));
  module.def("log_series", &logSeries, py::arg("first"),
             "The files of one log: log.lcmlog, log.lcmlog.01, ...");
  py::class_<schema::LogIndex>(module, "LogIndex", "Where the messages of a log are.")
      .def(py::init(&indexOf), py::arg("files"))
      .def_property_readonly("channels", &channelsOf)
      .def_property_readonly("events",
                             [](const schema::LogIndex& log) { return log.result().events; })
      .def_property_readonly("damaged_places",
                             [](const schema::LogIndex& log) { return log.result().resyncs; })
      .def("table", &tableOf, py::arg("channel"), py::arg("type"), py::arg("path"),
           py::arg("columns"), py::arg("check") = nullptr,
           "(columns, number of rows, damaged messages left out); texts are (codes, texts).")
      .def("check", &checkOf, py::arg("channel"), py::arg("type"));
  py::class_<schema::ChannelCheck>(module, "ChannelCheck",
                                   "What services would not use of the messages of a channel.")
      .def_readonly("refused", &schema::ChannelCheck::refused)
      .def_readonly("removed", &schema::ChannelCheck::removed)
      .def_property_readonly("first",
                             [](const schema::ChannelCheck& check) { return textOf(check.first); });
  py::class_<Messages>(module, "Messages", "Iterator over (channel, received_utime, encoding).")
      .def(py::init<Paths, std::optional<std::set<std::string>>>(), py::arg("files"),
           py::arg("channels"))
      .def("__iter__", [](Messages& messages) -> Messages& { return messages; })
      .def("__next__", &Messages::next);
}

}  // namespace lab::python
