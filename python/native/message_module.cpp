// Single messages: encodings to Python objects and back.
#include <pybind11/pybind11.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "common/schema/checked_encoding.hpp"
#include "common/schema/schema.hpp"
#include "python/native/module.hpp"
#include "python/native/types.hpp"

namespace lab::python {
namespace py = pybind11;
namespace {

using schema::Field;
using schema::Kind;
using schema::Type;

/// The Python class of each type, set by active_lab/messages.py.
std::map<std::string, py::object>& classes() {
  static auto* all = new std::map<std::string, py::object>();  // outlives the interpreter
  return *all;
}

template <class Integer>
Integer bigEndian(const std::uint8_t* at) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i) bits = bits << 8U | at[i];
  return static_cast<Integer>(bits);
}

class Decoder {
 public:
  Decoder(const Type& type, std::span<const std::uint8_t> encoding)
      : type_(type), left_(encoding) {}

  py::object toPython() {
    take(sizeof(std::int64_t));
    py::object message = readStruct(type_);
    if (!left_.empty()) fail();
    return message;
  }

 private:
  [[noreturn]] void fail() const {
    throw py::value_error("the bytes are no encoding of " + type_.name + ", or are damaged");
  }

  const std::uint8_t* take(std::size_t size) {
    if (size > left_.size()) fail();
    const std::uint8_t* at = left_.data();
    left_ = left_.subspan(size);
    return at;
  }

  py::object readStruct(const Type& type) {
    const py::object& made = classes().at(type.name);
    py::object message = made.attr("__new__")(made);
    std::vector<std::int64_t> numbers(type.fields.size(), 0);
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
      const Field& field = type.fields[i];
      if (!field.array) {
        const py::object value = readValue(field);
        if (py::isinstance<py::int_>(value)) numbers[i] = value.cast<std::int64_t>();
        py::setattr(message, field.name.c_str(), value);
        continue;
      }
      std::size_t count = field.count;
      if (field.count_field >= 0) {
        const std::int64_t number = numbers[static_cast<std::size_t>(field.count_field)];
        if (number < 0 || static_cast<std::uint64_t>(number) > left_.size()) fail();
        count = static_cast<std::size_t>(number);
      }
      py::setattr(message, field.name.c_str(), readArray(field, count));
    }
    return message;
  }

  py::object readArray(const Field& field, std::size_t count) {
    if (field.kind == Kind::kByte) {
      return py::bytes(reinterpret_cast<const char*>(take(count)), count);
    }
    py::list values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = readValue(field);
    return values;
  }

  py::object readValue(const Field& field) {
    switch (field.kind) {
      case Kind::kBoolean:
        return py::bool_(*take(1) != 0);
      case Kind::kByte:
        return py::int_(*take(1));
      case Kind::kInt8:
        return py::int_(bigEndian<std::int8_t>(take(1)));
      case Kind::kInt16:
        return py::int_(bigEndian<std::int16_t>(take(2)));
      case Kind::kInt32:
        return py::int_(bigEndian<std::int32_t>(take(4)));
      case Kind::kInt64:
        return py::int_(bigEndian<std::int64_t>(take(8)));
      case Kind::kFloat:
        return py::float_(
            static_cast<double>(std::bit_cast<float>(bigEndian<std::uint32_t>(take(4)))));
      case Kind::kDouble:
        return py::float_(std::bit_cast<double>(bigEndian<std::uint64_t>(take(8))));
      case Kind::kString: {
        const auto length = bigEndian<std::int32_t>(take(4));
        if (length < 1) fail();
        const auto size = static_cast<std::size_t>(length);
        const auto* text = reinterpret_cast<const char*>(take(size));
        return py::reinterpret_steal<py::str>(
            PyUnicode_DecodeUTF8(text, static_cast<py::ssize_t>(size - 1), "surrogateescape"));
      }
      case Kind::kStruct:
        return readStruct(*field.type);
    }
    fail();
  }

  const Type& type_;
  std::span<const std::uint8_t> left_;
};

class Encoder {
 public:
  std::string encode(const Type& type, const py::object& message) {
    put(static_cast<std::uint64_t>(type.hash), sizeof type.hash);
    writeStruct(type, message);
    return std::move(bytes_);
  }

 private:
  void put(std::uint64_t bits, std::size_t size) {
    for (std::size_t i = size; i-- > 0;) bytes_.push_back(static_cast<char>(bits >> (8 * i)));
  }

  [[noreturn]] static void fail(const Type& type, const Field& field, const std::string& what) {
    throw py::value_error(type.name + "." + field.name + ": " + what);
  }

  void writeStruct(const Type& type, const py::object& message) {
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
      const Field& field = type.fields[i];
      if (const Field* list = listOf(type, i)) {
        writeNumber(type, field, py::int_(checkedLength(type, i, *list, message)));
        continue;
      }
      const py::object value = message.attr(field.name.c_str());
      if (!field.array) {
        writeValue(type, field, value);
        continue;
      }
      const std::size_t length = py::len(value);
      if (field.count_field < 0 && length != field.count) {
        fail(type, field,
             "found " + std::to_string(length) + " elements, expected " +
                 std::to_string(field.count));
      }
      if (PyBytes_Check(value.ptr()) != 0 && field.kind == Kind::kByte) {
        bytes_ += value.cast<std::string>();
        continue;
      }
      for (const py::handle element : value) {
        writeValue(type, field, py::reinterpret_borrow<py::object>(element));
      }
    }
  }

  /// The first list that field `index` counts; nullptr: it counts none.
  static const Field* listOf(const Type& type, std::size_t index) {
    for (const Field& field : type.fields) {
      if (field.count_field == static_cast<int>(index)) return &field;
    }
    return nullptr;
  }

  /// The length of the lists that field `index` counts: what the field itself says has no effect.
  static std::size_t checkedLength(const Type& type, std::size_t index, const Field& first,
                                   const py::object& message) {
    const std::size_t length = py::len(message.attr(first.name.c_str()));
    for (const Field& field : type.fields) {
      if (field.count_field != static_cast<int>(index)) continue;
      const std::size_t other = py::len(message.attr(field.name.c_str()));
      if (other != length) {
        fail(type, field,
             "found " + std::to_string(other) + " elements, expected " + std::to_string(length) +
                 " as in " + first.name);
      }
    }
    return length;
  }

  void writeValue(const Type& type, const Field& field, const py::object& value) {
    if (field.kind == Kind::kStruct) {
      if (!py::isinstance(value, classes().at(field.type->name))) {
        fail(type, field,
             "found " + py::repr(value).cast<std::string>().substr(0, 60) + ", expected a " +
                 field.type->name);
      }
      writeStruct(*field.type, value);
    } else if (field.kind == Kind::kString) {
      writeText(type, field, value);
    } else {
      writeNumber(type, field, value);
    }
  }

  void writeText(const Type& type, const Field& field, const py::object& value) {
    if (PyUnicode_Check(value.ptr()) == 0) fail(type, field, "expected a text (str)");
    const auto encoded = py::reinterpret_steal<py::bytes>(
        PyUnicode_AsEncodedString(value.ptr(), "utf-8", "surrogateescape"));
    if (!encoded) throw py::error_already_set();
    const std::string text = encoded;
    if (text.find('\0') != std::string::npos) {
      fail(type, field, "found a zero character, expected none");
    }
    put(static_cast<std::uint64_t>(text.size() + 1), sizeof(std::int32_t));
    bytes_ += text;
    bytes_ += '\0';
  }

  void writeNumber(const Type& type, const Field& field, const py::object& value) {
    try {
      if (field.kind == Kind::kDouble) {
        put(std::bit_cast<std::uint64_t>(value.cast<double>()), 8);
      } else if (field.kind == Kind::kFloat) {
        put(std::bit_cast<std::uint32_t>(static_cast<float>(value.cast<double>())), 4);
      } else {
        const std::size_t size = schema::sizeOf(field.kind);
        const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
        if (!index) throw py::error_already_set();
        const auto number = index.cast<std::int64_t>();
        const bool is_byte = field.kind == Kind::kByte || field.kind == Kind::kBoolean;
        const std::int64_t most =
            is_byte ? 255 : std::numeric_limits<std::int64_t>::max() >> (64 - 8 * size);
        const std::int64_t least = is_byte ? 0 : -most - 1;
        if (number < least || number > most) {
          fail(type, field,
               "found " + std::to_string(number) + ", expected " + std::to_string(least) + " to " +
                   std::to_string(most));
        }
        put(static_cast<std::uint64_t>(number), size);
      }
    } catch (const py::error_already_set& error) {
      if (!error.matches(PyExc_TypeError)) throw;
      failNumber(type, field, value);
    } catch (const py::cast_error&) {
      failNumber(type, field, value);
    }
  }

  [[noreturn]] static void failNumber(const Type& type, const Field& field,
                                      const py::object& value) {
    const bool whole = field.kind != Kind::kFloat && field.kind != Kind::kDouble;
    fail(type, field,
         "found " + py::repr(value).cast<std::string>().substr(0, 60) + ", expected a " +
             (whole ? "whole " : "") + "number (" + field.type_name + ")");
  }

  std::string bytes_;
};

std::span<const std::uint8_t> viewOf(const py::bytes& bytes) {
  char* data = nullptr;
  py::ssize_t size = 0;
  if (PyBytes_AsStringAndSize(bytes.ptr(), &data, &size) != 0) throw py::error_already_set();
  return {reinterpret_cast<const std::uint8_t*>(data), static_cast<std::size_t>(size)};
}

}  // namespace

void addMessages(py::module_& module) {
  module.def("set_classes", [](const py::dict& all) {
    for (const auto& [name, type] : all) {
      classes()[py::str(name)] = py::reinterpret_borrow<py::object>(type);
    }
  });
  module.def(
      "type_of",
      [](const py::bytes& encoding) -> py::object {
        const auto view = viewOf(encoding);
        const Type* type =
            schema::messageSchema().findHash(schema::fingerprintOf(view.data(), view.size()));
        return type == nullptr ? py::object(py::none()) : py::str(type->name);
      },
      py::arg("encoding"), "Name of the type; None: it is unknown.");
  module.def(
      "decode",
      [](const py::bytes& encoding) {
        const auto view = viewOf(encoding);
        const Type* type =
            schema::messageSchema().findHash(schema::fingerprintOf(view.data(), view.size()));
        if (type == nullptr) {
          throw py::value_error(
              "the message is of a type that this version does not know: its fingerprint is that "
              "of no type in active_lab.messages");
        }
        return Decoder(*type, view).toPython();
      },
      py::arg("encoding"));
  module.def(
      "checked",
      [](const py::bytes& encoding) {
        const schema::CheckedEncoding checked = schema::checkReceived(viewOf(encoding));
        py::object usable = py::none();
        if (checked.usable) {
          const auto* remaining = reinterpret_cast<const char*>(checked.remaining.data());
          usable = checked.removed == 0 ? encoding : py::bytes(remaining, checked.remaining.size());
        }
        return py::make_tuple(usable, checked.problem, checked.removed);
      },
      py::arg("encoding"),
      "(a message of the bus as services use it, None: they refuse it; the first problem; robots "
      "removed).");
  module.def(
      "encode",
      [](const std::string& type, const py::object& message) {
        return py::bytes(Encoder().encode(typeOf(type), message));
      },
      py::arg("type"), py::arg("message"));
}

}  // namespace lab::python
