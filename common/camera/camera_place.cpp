#include "common/camera/camera_place.hpp"

#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "common/camera/camera_source.hpp"
#include "common/files/file_text.hpp"

namespace lab {
namespace {

constexpr unsigned kVideoMajor = 81;  // of all video devices (linux/major.h: VIDEO_MAJOR)
constexpr FileKind kRecordedFilm{"a movie, a picture or a folder of pictures", UINTMAX_MAX};

}  // namespace

int videoDeviceError(const std::string& path) {
  struct stat facts {};
  if (stat(path.c_str(), &facts) != 0) return errno;
  return S_ISCHR(facts.st_mode) && major(facts.st_rdev) == kVideoMajor ? 0 : ENOTTY;
}

std::string cameraPlaceProblem(const std::string& source) {
  if (source.starts_with(kPipelinePrefix) || isCameraAddress(source)) return {};
  if (isVideoDeviceSource(source)) {
    if (videoDeviceError(videoDevicePath(source)) != ENOTTY) return {};
    return "found \"" + source + "\", which is no video device, expected one, such as /dev/video0";
  }
  std::error_code error;
  const std::filesystem::file_status facts = std::filesystem::status(source, error);
  if (error || !std::filesystem::exists(facts) || std::filesystem::is_directory(facts)) return {};
  const std::string problem = regularFileProblem(source, kRecordedFilm);
  return problem.empty() ? std::string() : source + ": " + problem;
}

}  // namespace lab
