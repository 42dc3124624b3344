#include "sim_svc/emulator/firmware_image.hpp"

#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

namespace lab::emulator {
namespace {

constexpr std::uint16_t kElfMachineAvr = 83;
constexpr std::uint16_t kJumpToItself = 0xCFFF;
constexpr std::uint32_t kRamOffset = 0x800000;  // start of RAM in avr-gcc's address space

/// Suppresses simavr's messages on stdout and stderr; errors are detected by other means.
void ignoreLog(avr_t*, const int, const char*, va_list) {}

/// Checks the header of the file, because simavr does not report what is wrong with it.
void checkHeader(const std::filesystem::path& elf) {
  std::ifstream file(elf, std::ios::binary);
  if (!file) {
    throw FirmwareImageError(elf.string() +
                             ": cannot be read; expected the firmware's ELF file (build " +
                             "the target `firmware`)");
  }
  std::array<char, 20> header{};
  file.read(header.data(), header.size());
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(header[i]); };
  if (file.gcount() != static_cast<std::streamsize>(header.size()) ||
      std::memcmp(header.data(), "\177ELF", 4) != 0) {
    throw FirmwareImageError(elf.string() +
                             ": not an ELF file; expected the firmware's robot_firmware.elf");
  }
  const unsigned machine = byte(18) + 256U * byte(19);
  if (machine != kElfMachineAvr) {
    throw FirmwareImageError(elf.string() + ": an ELF file for machine " + std::to_string(machine) +
                             "; expected one for the AVR (" + std::to_string(kElfMachineAvr) + ")");
  }
}

/// Frees what elf_read_firmware() has allocated.
void release(elf_firmware_t& firmware) {
  std::free(firmware.flash);
  std::free(firmware.eeprom);
  std::free(firmware.fuse);
  std::free(firmware.lockbits);
  for (std::uint32_t i = 0; i < firmware.symbolcount; ++i) {
    std::free(firmware.symbol[i]);
  }
  std::free(firmware.symbol);
}

}  // namespace

FirmwareImage::FirmwareImage(const std::filesystem::path& elf) {
  checkHeader(elf);
  avr_global_logger_set(ignoreLog);
  elf_firmware_t firmware{};
  if (elf_read_firmware(elf.c_str(), &firmware) != 0 || firmware.flashsize == 0) {
    throw FirmwareImageError(elf.string() +
                             ": no program in it; expected the firmware's robot_firmware.elf");
  }
  flash_base_ = firmware.flashbase;
  flash_.assign(firmware.flash, firmware.flash + firmware.flashsize);
  ram_end_ = 0x100;
  for (std::uint32_t i = 0; i < firmware.symbolcount; ++i) {
    if (std::strcmp(firmware.symbol[i]->symbol, "_end") == 0) {
      ram_end_ = static_cast<std::uint16_t>(firmware.symbol[i]->addr - kRamOffset);
    }
  }
  release(firmware);
  if (flash_base_ + flash_.size() > kFlashSize) {
    throw FirmwareImageError(elf.string() + ": " + std::to_string(flash_base_ + flash_.size()) +
                             " bytes of program; the chip's flash holds " +
                             std::to_string(kFlashSize));
  }
}

std::uint32_t FirmwareImage::endlessLoop() const {
  for (std::size_t i = 0; i + 1 < flash_.size(); i += 2) {
    if ((flash_[i] | (flash_[i + 1] << 8)) == kJumpToItself) {
      return flash_base_ + static_cast<std::uint32_t>(i);
    }
  }
  throw FirmwareImageError("the program contains no endless loop");
}

}  // namespace lab::emulator
