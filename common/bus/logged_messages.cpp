#include "common/bus/logged_messages.hpp"

#include <stdexcept>

#include "common/bus/contract_upgrade.hpp"

namespace lab {

LoggedMessages::LoggedMessages(const std::vector<std::filesystem::path>& files)
    : files_(files), mapped_(files.size()) {}

Bytes LoggedMessages::at(const LogPosition& at) {
  std::unique_ptr<MappedFile>& mapped = mapped_.at(at.file);
  if (!mapped) mapped = std::make_unique<MappedFile>(files_[at.file], "log");
  Bytes message;
  try {
    message = mapped->part(at.offset, at.size);
  } catch (const std::runtime_error&) {
    mapped.reset();  // the file may come back
    throw;
  }
  mapped->release(message.data());
  newer_ = upgraded(message);
  return newer_ ? Bytes(*newer_) : message;
}

}  // namespace lab
