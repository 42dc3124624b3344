#include "common/bus/contract_upgrade.hpp"

#include "common/bus/codec.hpp"
#include "common/bus/fingerprints.hpp"
#include "common/bus/upgrade/from_version_3.hpp"
#include "common/bus/upgrade/from_version_4.hpp"

namespace lab {
namespace {

template <class Old>
std::optional<std::vector<std::uint8_t>> upgradedFrom(std::int64_t fingerprint, Bytes message) {
  if (fingerprint != Old::getHash()) return std::nullopt;
  Old old{};
  if (!decode(message, old)) return std::nullopt;
  return encode(convert(old));
}

}  // namespace

std::optional<std::vector<std::uint8_t>> upgraded(Bytes message) {
  constexpr std::size_t kFingerprint = 8;  // bytes, big endian
  if (message.size() < kFingerprint) return std::nullopt;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < kFingerprint; ++i) bits = bits << 8 | message[i];
  const auto fingerprint = static_cast<std::int64_t>(bits);
  auto result = upgradedFrom<lab_v3::light_status_t>(fingerprint, message);
  if (!result) result = upgradedFrom<lab_v3::light_command_t>(fingerprint, message);
  if (!result) result = upgradedFrom<lab_v3::experiment_event_t>(fingerprint, message);
  if (!result) result = upgradedFrom<lab_v4::robot_status_t>(fingerprint, message);
  if (!result) result = upgradedFrom<lab_v4::robot_command_t>(fingerprint, message);
  if (!result) result = upgradedFrom<lab_v4::robot_steps_t>(fingerprint, message);
  if (!result) result = upgradedFrom<lab_v4::sim_truth_t>(fingerprint, message);
  if (!result) result = upgradedFrom<lab_v4::analysis_t>(fingerprint, message);
  return result;
}

std::string olderFingerprintList() {
  return fingerprintLine("light_status_t", lab_v3::light_status_t::getHash()) +
         fingerprintLine("light_command_t", lab_v3::light_command_t::getHash()) +
         fingerprintLine("experiment_event_t", lab_v3::experiment_event_t::getHash()) +
         fingerprintLine("robot_status_t", lab_v4::robot_status_t::getHash()) +
         fingerprintLine("robot_command_t", lab_v4::robot_command_t::getHash()) +
         fingerprintLine("robot_steps_t", lab_v4::robot_steps_t::getHash()) +
         fingerprintLine("sim_truth_t", lab_v4::sim_truth_t::getHash()) +
         fingerprintLine("analysis_t", lab_v4::analysis_t::getHash());
}

}  // namespace lab
