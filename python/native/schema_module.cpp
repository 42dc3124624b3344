// The message types as Python data.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "common/schema/array_groups.hpp"
#include "common/schema/message_table.hpp"
#include "common/schema/schema.hpp"
#include "python/native/module.hpp"
#include "python/native/types.hpp"

namespace lab::python {
namespace py = pybind11;
namespace {

py::dict toPython(const schema::Field& field) {
  py::list constants;
  for (const schema::Constant& constant : field.constants) {
    constants.append(py::make_tuple(constant.name, std::stoll(constant.value), constant.comment));
  }
  py::dict result;
  result["name"] = field.name;
  result["type"] = field.type_name;
  result["array"] = field.array;
  result["count"] = field.count;
  result["count_field"] = field.count_field;
  result["unit"] = field.unit;
  result["comment"] = field.comment;
  result["constants"] = constants;
  return result;
}

py::dict schemaDict() {
  py::dict types;
  for (const auto& type : schema::messageSchema().types()) {
    py::list fields;
    for (const schema::Field& field : type->fields) fields.append(toPython(field));
    py::dict entry;
    entry["comment"] = type->comment;
    entry["hash"] = type->hash;
    entry["fields"] = fields;
    types[py::str(type->name)] = entry;
  }
  return types;
}

}  // namespace

const schema::Type& typeOf(const std::string& name) {
  const schema::Type* type = schema::messageSchema().find(name);
  if (type == nullptr) {
    throw py::value_error("found the message type " + name +
                          ", expected one of active_lab.messages");
  }
  return *type;
}

void addSchema(py::module_& module) {
  module.def("schema", &schemaDict, "The message types: {name: {comment, hash, fields}}.");
  module.def("table_paths",
             [](const std::string& type) { return schema::tablePaths(typeOf(type)); });
  module.def("table_columns", [](const std::string& type, const std::string& path) {
    py::dict result;
    for (const schema::ColumnInfo& column : schema::MessageTable::allColumns(typeOf(type), path)) {
      py::dict values;
      if (column.field != nullptr) {
        for (const schema::Constant& constant : column.field->constants) {
          values[py::int_(std::stoll(constant.value))] = constant.name;
        }
      }
      result[py::str(column.name)] = py::make_tuple(column.unit, column.comment, values);
    }
    return result;
  });
}

}  // namespace lab::python
