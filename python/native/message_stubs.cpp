// Writes active_lab/messages.pyi: the type hints of the classes that messages.py makes from the
// same definitions.
#include <fstream>
#include <iostream>
#include <string>

#include "common/schema/schema.hpp"

namespace {

using lab::schema::Field;
using lab::schema::Kind;
using lab::schema::Type;

std::string hintOf(const Field& field) {
  if (field.array && field.kind == Kind::kByte) return "bytes";
  std::string one = "int";
  if (field.kind == Kind::kBoolean) one = "bool";
  if (field.kind == Kind::kFloat || field.kind == Kind::kDouble) one = "float";
  if (field.kind == Kind::kString) one = "str";
  if (field.kind == Kind::kStruct) one = field.type_name;
  return field.array ? "Sequence[" + one + "]" : one;
}

void write(std::ostream& out, const Type& type) {
  out << "\nclass " << type.name << "(Message):\n";
  std::string arguments;
  for (const Field& field : type.fields) {
    out << "    " << field.name << ": " << hintOf(field) << "\n";
    for (const auto& constant : field.constants) {
      out << "    " << constant.name << ": ClassVar[int]\n";
    }
    arguments += ", " + field.name + ": " + hintOf(field) + " = ...";
  }
  out << "    def __init__(self, *" << arguments << ") -> None: ...\n"
      << "    @classmethod\n    def decode(cls, encoding: bytes) -> \"" << type.name << "\": ...\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "message_stubs: expected the file to write\n";
    return 2;
  }
  std::ofstream out(argv[1]);
  out << "# Made by python/native/message_stubs.cpp from lcmtypes/.\n"
         "from typing import Any, ClassVar, Dict, Sequence, Type\n\n"
         "class Message:\n    type_name: ClassVar[str]\n    def encode(self) -> bytes: ...\n"
         "    def to_dict(self) -> Dict[str, Any]: ...\n\n"
         "types: Dict[str, Type[Message]]\n"
         "def decode(encoding: bytes) -> Message: ...\n"
         "def type_of(encoding: bytes) -> str | None: ...\n";
  for (const auto& type : lab::schema::messageSchema().types()) write(out, *type);
  return out ? 0 : 1;
}
