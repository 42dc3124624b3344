/// This process in a DDS domain.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <string>

namespace lab::dds {

/// A DDS entity that ends with the object, and all it made with it.
class Entity {
 public:
  Entity() = default;
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  ~Entity() { reset(); }
  Entity(Entity&& other) noexcept : handle_(other.release()) {}
  Entity& operator=(Entity&& other) noexcept {
    if (this != &other) {
      reset();
      handle_ = other.release();
    }
    return *this;
  }

  [[nodiscard]] dds_entity_t get() const { return handle_; }

 private:
  void reset() {
    if (handle_ > 0) dds_delete(handle_);
    handle_ = 0;
  }
  dds_entity_t release() {
    const dds_entity_t handle = handle_;
    handle_ = 0;
    return handle;
  }

  dds_entity_t handle_ = 0;
};

/// One participant in one domain, with a configuration of its own: $CYCLONEDDS_URI is not read, as
/// a file written for another version of Cyclone would end us. One a domain and process.
class Domain {
 public:
  /// @param configuration XML, whole; as localConfiguration()
  /// @param where names it in errors: "gateway.configuration (my.xml)"
  /// @throws DdsError with what Cyclone complained about.
  Domain(int id, const std::string& configuration, const std::string& where);

  [[nodiscard]] dds_entity_t participant() const { return participant_.get(); }
  [[nodiscard]] int id() const { return id_; }

 private:
  int id_;
  Entity domain_;
  Entity participant_;
};

/// What Cyclone said since the last call (warnings and errors, each text once, at most a hundred),
/// one a line: it says a lot on no channel of ours.
[[nodiscard]] std::string takeWarnings();

/// Payloads that are no message of the topic's type, and packets that are no RTPS, since the
/// process started. A reliable writer sends what was not understood again, and each time counts.
[[nodiscard]] std::int64_t malformedReceived();

}  // namespace lab::dds
