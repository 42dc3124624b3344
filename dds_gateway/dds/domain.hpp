/// A participant of this process in a DDS domain.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <string>

namespace lab::dds {

/// Owns a DDS entity; deletes it, with the entities it has created, when the object ends.
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

/// One participant in one domain, with its own configuration. $CYCLONEDDS_URI is not read, because
/// a file for another version of Cyclone would end the process. There may be one per domain and
/// process.
class Domain {
 public:
  /// @param configuration complete XML, as from localConfiguration()
  /// @param where source of the configuration, for errors: "--dds-configuration (my.xml)"
  /// @throws DdsError with Cyclone's warnings
  Domain(int id, const std::string& configuration, const std::string& where);

  [[nodiscard]] dds_entity_t participant() const { return participant_.get(); }
  [[nodiscard]] int id() const { return id_; }

 private:
  int id_;
  Entity domain_;
  Entity participant_;
};

/// Cyclone's warnings and errors since the last call, one per line, each text once, at most 100.
[[nodiscard]] std::string takeWarnings();

/// Number of payloads that are not messages of the topic's type and of packets that are not RTPS,
/// since the start of the process. A reliable writer repeats such payloads; each repetition counts.
[[nodiscard]] std::int64_t malformedReceived();

}  // namespace lab::dds
