/// Handles of the HDF5 library that close themselves.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/schema/schema.hpp"

namespace lab::runner::hdf5 {

/// One open object of a file, or a type, a space, a list of properties.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  /// @param what named in the error, if `id` is none
  Handle(hid_t id, Close close, const std::string& what) : id_(id), close_(close) {
    if (id_ < 0) throw std::runtime_error("HDF5: " + what);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }

  [[nodiscard]] hid_t get() const { return id_; }

 private:
  hid_t id_;
  Close close_;
};

inline void check(herr_t status, const std::string& what) {
  if (status < 0) throw std::runtime_error("HDF5: " + what);
}

/// Errors are thrown; the library must not print them too.
inline void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

/// The type of a number, little-endian.
[[nodiscard]] hid_t numberType(schema::Kind kind);

/// A text attribute in UTF-8.
void writeText(hid_t object, const std::string& name, const std::string& text);
void writeNumber(hid_t object, const std::string& name, std::int64_t value);

/// The name of the dataset for one of schema::tablePaths(): "messages", "curves_lags".
[[nodiscard]] std::string tableName(std::string path);

/// @return empty: there is no such text
[[nodiscard]] std::string readText(hid_t object, const std::string& name);

}  // namespace lab::runner::hdf5
