/// A program for the chip, read from an ELF file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <vector>

namespace lab::emulator {

/// A file without a program for this chip; the text says what was found and expected.
class FirmwareImageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline constexpr std::uint32_t kFlashSize = 32 * 1024;
inline constexpr std::uint16_t kEepromSize = 1024;

/// The contents of an ELF file for an ATmega328P; shared by all chips that run it.
class FirmwareImage {
 public:
  /// @throws FirmwareImageError if the file is missing, is not an AVR ELF file, or does not fit
  ///   into the flash.
  explicit FirmwareImage(const std::filesystem::path& elf);

  [[nodiscard]] const std::vector<std::uint8_t>& flash() const { return flash_; }
  [[nodiscard]] std::uint32_t flashBase() const { return flash_base_; }

  /// The first RAM address after the program's variables; the RAM above is for the stack.
  [[nodiscard]] std::uint16_t ramEnd() const { return ram_end_; }

  /// The byte address of an instruction that jumps to itself (exit() ends with one).
  /// @throws FirmwareImageError if there is none.
  [[nodiscard]] std::uint32_t endlessLoop() const;

 private:
  std::vector<std::uint8_t> flash_;
  std::uint32_t flash_base_ = 0;
  std::uint16_t ram_end_ = 0;
};

}  // namespace lab::emulator
