#include "runner/export/hdf5_handles.hpp"

#include <algorithm>
#include <memory>
#include <vector>

namespace lab::runner::hdf5 {
namespace {

/// Of fixed length, which every program reads.
Handle textType(std::size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), &H5Tclose, "no type of texts");
  check(H5Tset_size(type.get(), size > 0 ? size : 1), "no type of texts");
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "no type of texts");
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), "no type of texts");
  return type;
}

void writeAttribute(hid_t object, const std::string& name, hid_t type, const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), &H5Sclose, "no attribute " + name);
  const Handle attribute(
      H5Acreate2(object, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT), &H5Aclose,
      "no attribute " + name);
  check(H5Awrite(attribute.get(), type, value), "cannot write the attribute " + name);
}

}  // namespace

hid_t numberType(schema::Kind kind) {
  switch (kind) {
    case schema::Kind::kInt8:
      return H5T_STD_I8LE;
    case schema::Kind::kInt16:
      return H5T_STD_I16LE;
    case schema::Kind::kInt32:
      return H5T_STD_I32LE;
    case schema::Kind::kInt64:
      return H5T_STD_I64LE;
    case schema::Kind::kFloat:
      return H5T_IEEE_F32LE;
    case schema::Kind::kDouble:
      return H5T_IEEE_F64LE;
    default:
      return H5T_STD_U8LE;
  }
}

void writeText(hid_t object, const std::string& name, const std::string& text) {
  // Attributes are at most 64 KiB.
  constexpr std::size_t kMost = 60'000;
  const std::string kept = text.substr(0, kMost);
  const Handle type = textType(kept.size());
  // A string ends with a 0, so that an empty text has one byte too.
  writeAttribute(object, name, type.get(), kept.c_str());
}

void writeNumber(hid_t object, const std::string& name, std::int64_t value) {
  writeAttribute(object, name, H5T_NATIVE_INT64, &value);
}

std::string tableName(std::string path) {
  if (path.empty()) return "messages";
  std::ranges::replace(path, '.', '_');  // PyTables wants names that are Python's too
  return path;
}

std::string readText(hid_t object, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0) return {};
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), &H5Aclose, name);
  const Handle type(H5Aget_type(attribute.get()), &H5Tclose, name);
  if (H5Tget_class(type.get()) != H5T_STRING) return {};
  const Handle space(H5Aget_space(attribute.get()), &H5Sclose, name);
  if (H5Tis_variable_str(type.get()) > 0) {  // as h5py writes them
    if (H5Sget_simple_extent_npoints(space.get()) != 1) return {};
    char* allocated = nullptr;
    check(H5Aread(attribute.get(), type.get(), &allocated), name);
    const std::unique_ptr<char, herr_t (*)(void*)> owned(allocated, &H5free_memory);
    return allocated == nullptr ? std::string() : std::string(allocated);
  }
  std::string text(H5Tget_size(type.get()), '\0');
  // A list of texts would not fit.
  if (H5Sget_simple_extent_npoints(space.get()) != 1 || text.empty()) return {};
  check(H5Aread(attribute.get(), type.get(), text.data()), name);
  return text.substr(0, text.find('\0'));
}

}  // namespace lab::runner::hdf5
