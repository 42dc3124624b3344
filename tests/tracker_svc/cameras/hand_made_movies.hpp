// Movies that are written byte by byte: what they state needs no data.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace lab::cameras {

/// A number with its highest byte first.
inline std::string bigEndian(std::uint64_t number, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(number >> (8 * i) & 0xFFU);
  return text;
}

/// An element of Matroska (EBML, RFC 8794): its id, its size, its content.
inline std::string element(std::uint32_t id, const std::string& content) {
  std::string text;
  for (int i = 3; i >= 0; --i) {
    if (const std::uint32_t byte = id >> (8 * i) & 0xFFU; byte != 0 || !text.empty()) {
      text += static_cast<char>(byte);
    }
  }
  return text + bigEndian(0x10000000U | content.size(), 4) + content;
}

/// An MKV of one frame, which no decoder knows: ffprobe gives the size that the file states.
inline std::string mkvOfSize(std::uint32_t width, std::uint32_t height) {
  const std::string video =
      element(0xB0, bigEndian(width, 4)) + element(0xBA, bigEndian(height, 4));
  const std::string track = element(0xD7, bigEndian(1, 1)) + element(0x73C5, bigEndian(1, 1)) +
                            element(0x83, bigEndian(1, 1)) + element(0x86, "V_XYZ") +
                            element(0xE0, video);
  const std::string frame = element(0xA3, std::string("\x81\0\0\x80", 4) + "abc");
  const std::string segment = element(0x1549A966, element(0x2AD7B1, bigEndian(1'000'000, 4))) +
                              element(0x1654AE6B, element(0xAE, track)) +
                              element(0x1F43B675, element(0xE7, bigEndian(0, 1)) + frame);
  return element(0x1A45DFA3, element(0x4282, "matroska")) + element(0x18538067, segment);
}

/// A box of MP4 (ISO 14496-12): its size, its type, its content.
inline std::string mp4Box(const std::string& type, const std::string& content) {
  return bigEndian(content.size() + 8, 4) + type + content;
}

/// As mp4Box(), with version 0 and no flags.
inline std::string fullBox(const std::string& type, const std::string& content) {
  return mp4Box(type, bigEndian(0, 4) + content);
}

/// A number of samples, and how long each of them lasts [ms].
using SampleRun = std::pair<std::uint32_t, std::uint32_t>;

/// An MP4 of samples of one byte each, of 32 x 24 pixels, which ffmpeg can list but not decode.
inline std::string mp4OfSamples(const std::vector<SampleRun>& runs) {
  std::uint32_t count = 0;
  std::string durations;
  for (const auto& [samples, duration] : runs) {
    count += samples;
    durations += bigEndian(samples, 4) + bigEndian(duration, 4);
  }
  const auto words = [](std::initializer_list<std::uint32_t> numbers) {
    std::string text;
    for (const std::uint32_t number : numbers) text += bigEndian(number, 4);
    return text;
  };
  const std::string matrix = words({0x10000, 0, 0, 0, 0x10000, 0, 0, 0, 0x40000000});
  const std::string type = mp4Box("ftyp", "isom" + words({0}) + "isom");
  const std::string sample = mp4Box(
      "mjpg", std::string(6, '\0') + bigEndian(1, 2) + std::string(16, '\0') + bigEndian(32, 2) +
                  bigEndian(24, 2) + words({0x480000, 0x480000, 0}) + bigEndian(1, 2) +
                  std::string(32, '\0') + bigEndian(24, 2) + bigEndian(0xFFFF, 2));
  const auto first_sample = static_cast<std::uint32_t>(type.size() + 8);
  const std::string table = mp4Box(
      "stbl", fullBox("stsd", words({1}) + sample) +
                  fullBox("stts", bigEndian(runs.size(), 4) + durations) +
                  fullBox("stsc", words({1, 1, count, 1})) + fullBox("stsz", words({1, count})) +
                  fullBox("stco", words({1, first_sample})));
  const std::string media = mp4Box(
      "mdia",
      fullBox("mdhd", words({0, 0, 1000, count, 0})) +
          fullBox("hdlr", words({0}) + "vide" + std::string(13, '\0')) +
          mp4Box("minf", fullBox("vmhd", words({0, 0})) +
                             mp4Box("dinf", fullBox("dref", words({1, 12}) + "url " + words({1}))) +
                             table));
  const std::string track =
      mp4Box("trak", fullBox("tkhd", words({0, 0, 1, 0, count, 0, 0, 0, 0}) + matrix +
                                         words({32U << 16, 24U << 16})) +
                         media);
  const std::string movie =
      mp4Box("moov", fullBox("mvhd", words({0, 0, 1000, count, 0x10000}) + bigEndian(0x100, 2) +
                                         std::string(10, '\0') + matrix + std::string(24, '\0') +
                                         words({2})) +
                         track);
  return type + mp4Box("mdat", std::string(count, '\0')) + movie;
}

}  // namespace lab::cameras
