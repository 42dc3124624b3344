#include "tests/dds_gateway/peers/raw_type.hpp"

#include <dds/ddsi/ddsi_keyhash.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>

namespace lab::dds {
namespace {

struct RawType : ddsi_sertype {};

struct RawData : ddsi_serdata {
  RawData(const ddsi_sertype* of, ddsi_serdata_kind what) : ddsi_serdata{} {
    ddsi_serdata_init(this, of, what);
  }
  Payload payload;
  Payload on_wire;  ///< the payload, its size rounded up to four bytes
};

const RawData* raw(const ddsi_serdata* data) { return static_cast<const RawData*>(data); }

ddsi_serdata* made(const ddsi_sertype* type, ddsi_serdata_kind kind, Payload payload) {
  auto data = std::make_unique<RawData>(type, kind);
  data->payload = std::move(payload);
  data->on_wire = data->payload;
  data->on_wire.resize((data->payload.size() + 3) / 4 * 4);
  return data.release();
}

ddsi_serdata* fromFragments(const ddsi_sertype* type, ddsi_serdata_kind kind,
                            const nn_rdata* fragment, std::size_t size) {
  Payload payload(size);
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    const unsigned char* bytes = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::copy(bytes, bytes + (fragment->maxp1 - fragment->min), payload.begin() + fragment->min);
  }
  return made(type, kind, std::move(payload));
}

void copyOut(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* to) {
  std::copy_n(raw(data)->on_wire.data() + offset, size, static_cast<unsigned char*>(to));
}

// Points at no memory of its own: if the payload is encrypted, Cyclone returns another address.
ddsi_serdata* reference(const ddsi_serdata* data, std::size_t offset, std::size_t size,
                        ddsrt_iovec_t* to) {
  to->iov_base = const_cast<unsigned char*>(raw(data)->on_wire.data()) + offset;
  to->iov_len = size;
  return ddsi_serdata_ref(data);
}

void unreference(ddsi_serdata* data, const ddsrt_iovec_t*) { ddsi_serdata_unref(data); }

const ddsi_serdata_ops& dataOps() {
  static const ddsi_serdata_ops kOps = [] {
    ddsi_serdata_ops ops{};
    ops.eqkey = [](const ddsi_serdata*, const ddsi_serdata*) { return true; };
    ops.get_size = [](const ddsi_serdata* data) {
      return static_cast<std::uint32_t>(raw(data)->payload.size());
    };
    ops.from_ser = fromFragments;
    ops.from_keyhash = [](const ddsi_sertype* type, const ddsi_keyhash*) {
      return made(type, SDK_KEY, {});
    };
    ops.from_sample = [](const ddsi_sertype* type, ddsi_serdata_kind kind, const void* sample) {
      return made(type, kind, *static_cast<const Payload*>(sample));
    };
    ops.to_ser = copyOut;
    ops.to_ser_ref = reference;
    ops.to_ser_unref = unreference;
    ops.to_sample = [](const ddsi_serdata* data, void* sample, void**, void*) {
      *static_cast<Payload*>(sample) = raw(data)->payload;
      return true;
    };
    ops.to_untyped = [](const ddsi_serdata* data) { return made(data->type, SDK_KEY, {}); };
    ops.untyped_to_sample = [](const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
      return true;
    };
    ops.free = [](ddsi_serdata* data) { delete static_cast<RawData*>(data); };
    ops.print = [](const ddsi_sertype*, const ddsi_serdata*, char* text, std::size_t) {
      text[0] = 0;
      return std::size_t{0};
    };
    ops.get_keyhash = [](const ddsi_serdata*, ddsi_keyhash* key, bool) { *key = {}; };
    return ops;
  }();
  return kOps;
}

const ddsi_sertype_ops& typeOps() {
  static const ddsi_sertype_ops kOps = [] {
    ddsi_sertype_ops ops{};
    ops.version = ddsi_sertype_v0;
    ops.free = [](ddsi_sertype* type) {
      ddsi_sertype_fini(type);
      delete static_cast<RawType*>(type);
    };
    ops.zero_samples = [](const ddsi_sertype*, void*, std::size_t) {};
    ops.realloc_samples = [](void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {};
    ops.free_samples = [](const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {};
    ops.equal = [](const ddsi_sertype*, const ddsi_sertype*) { return true; };
    ops.hash = [](const ddsi_sertype*) { return std::uint32_t{0}; };
    return ops;
  }();
  return kOps;
}

}  // namespace

dds_entity_t rawTopic(dds_entity_t participant, const std::string& topic,
                      const std::string& type_name) {
  auto type = std::make_unique<RawType>();
  ddsi_sertype_init(type.get(), type_name.c_str(), &typeOps(), &dataOps(), true);
  type->allowed_data_representation =
      DDS_DATA_REPRESENTATION_FLAG_XCDR1 | DDS_DATA_REPRESENTATION_FLAG_XCDR2;
  ddsi_sertype* given = type.get();
  const dds_entity_t entity =
      dds_create_topic_sertype(participant, topic.c_str(), &given, nullptr, nullptr, nullptr);
  if (entity > 0) static_cast<void>(type.release());
  return entity;
}

std::vector<Payload> takeRaw(dds_entity_t reader) {
  constexpr std::uint32_t kMost = 64;
  std::array<ddsi_serdata*, kMost> samples{};
  std::array<dds_sample_info_t, kMost> infos{};
  const dds_return_t count =
      dds_takecdr(reader, samples.data(), kMost, infos.data(), DDS_ANY_STATE);
  std::vector<Payload> payloads;
  for (std::size_t i = 0; count > 0 && i < static_cast<std::size_t>(count); ++i) {
    if (infos[i].valid_data) payloads.push_back(raw(samples[i])->payload);
    ddsi_serdata_unref(samples[i]);
  }
  return payloads;
}

dds_return_t writeRaw(dds_entity_t writer, const Payload& payload) {
  return dds_write(writer, &payload);
}

}  // namespace lab::dds
