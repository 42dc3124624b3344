#include "tracker_svc/cameras/movie_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <utility>

#include "common/camera/camera_source.hpp"
#include "common/camera/run_film.hpp"
#include "common/files/file_text.hpp"
#include "light/median.hpp"
#include "tracker_svc/cameras/grey.hpp"
#include "tracker_svc/cameras/media_process.hpp"
#include "tracker_svc/cameras/packet_times.hpp"
#include "tracker_svc/cameras/picture_size.hpp"

namespace lab::cameras {
namespace {

using nlohmann::json;

// Containers and streams of pictures. Playlists (hls, dash, concat, imf, sdp) are left out: they
// name other files, and ffprobe waits for ever for the next entry of one that does not end.
constexpr const char* kMovieFormats =
    "matroska,webm,mov,mp4,avi,mpegts,mpeg,mpegvideo,flv,live_flv,asf,ogg,nut,mxf,gxf,rm,wtv,dv,"
    "dirac,"
    "ivf,obu,av1,h261,h263,h264,hevc,m4v,vc1,avs2,cavsvideo,dnxhd,mjpeg,mjpeg_2000,smjpeg,mlv,vidc,"
    "yuv4mpegpipe,ser,gif,apng,fits,bmp_pipe,dpx_pipe,exr_pipe,gif_pipe,j2k_pipe,jpeg_pipe,"
    "jpegls_pipe,jpegxl_pipe,pam_pipe,pbm_pipe,pgm_pipe,png_pipe,ppm_pipe,qoi_pipe,sgi_pipe,"
    "sunrast_pipe,tiff_pipe,webp_pipe,tty";

/// The arguments that name the input. What an address names in turn is opened by the listed
/// protocols only.
std::vector<std::string> inputOf(const std::string& source) {
  if (!isCameraAddress(source)) return inputOfMovie(source);
  const std::string protocols = protocolsOf(source);
  if (protocols.empty()) throw CameraError(source + ": " + cameraSourceProblem(source));
  std::vector<std::string> words{"-protocol_whitelist", protocols};
  // Timeout of 5 s for a dead camera [us]; low latency instead of smooth playback.
  std::vector<const char*> options;
  if (source.starts_with("rtsp://")) options = {"-rtsp_transport", "tcp", "-timeout", "5000000"};
  if (source.starts_with("http")) options = {"-rw_timeout", "5000000"};
  words.insert(words.end(), options.begin(), options.end());
  for (const char* word : {"-fflags", "nobuffer", "-flags", "low_delay", "-i"}) {
    words.emplace_back(word);
  }
  words.push_back(source);
  return words;
}

std::string textOf(const json& object, const char* key) {
  const auto entry = object.find(key);
  return entry != object.end() && entry->is_string() ? entry->get<std::string>() : "";
}

/// Parses "30000/1001". 0 if it is no rate of pictures.
double rateOf(const std::string& text) {
  constexpr double kLeast = 1e-3;  // as in film.json
  constexpr double kMost = 1e6;
  const std::size_t slash = text.find('/');
  const double above = std::atof(text.c_str());
  const double below = slash == std::string::npos ? 1 : std::atof(text.c_str() + slash + 1);
  const double rate = below > 0 ? above / below : 0;
  return rate >= kLeast && rate <= kMost ? rate : 0;
}

/// Lossless codecs in common use.
bool losesNothing(const std::string& codec) {
  constexpr std::array kWhole{"ffv1",     "rawvideo", "huffyuv", "ffvhuff", "utvideo",
                              "magicyuv", "png",      "qtrle",   "bmp",     "tiff"};
  return std::ranges::find(kWhole, codec) != kWhole.end();
}

std::string shownNumber(std::int64_t count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

class MovieReader final : public FilmReader {
 public:
  MovieReader(std::string source, double fps)
      : source_(std::move(source)),
        facts_(probeMovie(source_, kMostPackets)),
        decoder_(decodeCommand(source_, facts_.grey), source_ + ": movies are read by", "ffmpeg"),
        image_(facts_.width, facts_.height),
        colour_(facts_.grey ? 0 : image_.pixels.size() * 3) {
    if (!(fps > 0)) {
      readTable();
      return;
    }
    facts_.fps = fps;
    for (std::size_t i = 0; i < facts_.utimes.size(); ++i) {
      facts_.utimes[i] = std::llround(static_cast<double>(i) * 1e6 / fps);
    }
  }

  [[nodiscard]] bool next(CameraFrame& frame) override {
    if (over_) return false;
    const std::span<std::uint8_t> bytes =
        facts_.grey ? std::span(image_.pixels) : std::span(colour_);
    if (decoder_.read(bytes) < bytes.size()) {
      over_ = true;
      problem_ = whatWentWrong(decoder_.finish());
      return false;
    }
    if (!facts_.grey) greyFromRgb(colour_.data(), image_.pixels);
    frame.number = count_;
    frame.utime = utime(count_);
    frame.grey = image_.view();
    ++count_;
    return true;
  }

  [[nodiscard]] std::int64_t length() const override {
    return static_cast<std::int64_t>(facts_.utimes.size());
  }
  [[nodiscard]] CameraFormat format() const override {
    CameraFormat format;
    format.width = facts_.width;
    format.height = facts_.height;
    format.fps = usualRate();
    format.pixels = facts_.pixels;
    format.compressed = facts_.compressed;
    return format;
  }
  [[nodiscard]] std::string table() const override { return table_; }
  [[nodiscard]] std::string mark() const override {
    return facts_.rotation == 0 ? "" : "rotation " + std::to_string(facts_.rotation);
  }
  [[nodiscard]] std::int64_t dropped() const override { return 0; }
  [[nodiscard]] std::string problem() const override { return problem_; }

 private:
  /// A film of a run has the exact times of its frames in a table; containers round them.
  void readTable() {
    const std::filesystem::path table = filmTableOf(source_);
    if (isCameraAddress(source_) || !std::filesystem::exists(table)) {
      requireTimes();
      return;
    }
    const std::vector<FilmFrame> frames = readFilmTable(table);
    const std::size_t known = std::min(frames.size(), facts_.utimes.size());
    for (std::size_t i = 0; i < known; ++i) {
      facts_.utimes[i] = frames[i].camera_utime - frames.front().camera_utime;
    }
    table_ = table.filename().string();
    if (known < facts_.utimes.size()) requireTimes();
  }

  void requireTimes() const {
    if (facts_.time_problem.empty()) return;
    throw CameraError(source_ + ": " + facts_.time_problem +
                      ": give the rate of its frames instead (lab track --fps, camera.fps)");
  }

  [[nodiscard]] std::int64_t utime(std::int64_t number) const {
    if (number < length()) return facts_.utimes[static_cast<std::size_t>(number)];
    // More frames than packets: extrapolates at the usual rate.
    const std::int64_t last = facts_.utimes.empty() ? 0 : facts_.utimes.back();
    const auto more = static_cast<double>(number - length() + 1);
    return last + std::llround(more * 1e6 / (facts_.fps > 0 ? facts_.fps : 30));
  }

  /// From the median period; or the mean rate of the file if they agree, since MKV stores whole
  /// milliseconds.
  [[nodiscard]] double usualRate() const {
    std::vector<std::int64_t> steps;
    for (std::size_t i = 1; i < facts_.utimes.size(); ++i) {
      steps.push_back(facts_.utimes[i] - facts_.utimes[i - 1]);
    }
    if (steps.empty()) return facts_.fps;
    const auto median = static_cast<double>(medianOf(steps));
    constexpr double kRounding_us = 1000;
    const bool agree = facts_.fps > 0 && std::abs(median - 1e6 / facts_.fps) <= kRounding_us;
    return agree || median <= 0 ? facts_.fps : 1e6 / median;
  }

  [[nodiscard]] std::string whatWentWrong(int status) const {
    const std::int64_t expected = std::max(length(), facts_.claimed - facts_.never_shown);
    const std::string error_line =
        decoder_.lastErrorLine().empty() ? facts_.warning : decoder_.lastErrorLine();
    const std::string why = error_line.empty() ? "" : " (ffmpeg: " + error_line + ")";
    if (count_ < expected) {
      return source_ + ": ends early or is damaged: " + std::to_string(count_) + " of " +
             shownNumber(expected, "frame") +
             " could be read; if one is missing inside, the frames " +
             "after it have its number and time" + why;
    }
    if (status != 0 || !facts_.warning.empty()) {
      return source_ + ": " + shownNumber(count_, "frame") + " could be read, then it broke off" +
             why;
    }
    if (!error_line.empty()) {
      return source_ +
             ": all frames could be read, but ffmpeg reported errors in some, in which caps " +
             "may be shown at earlier places" + why;
    }
    return {};
  }

  std::string source_;
  MovieInfo facts_;
  MediaProcess decoder_;
  optics::GreyImage image_;
  std::vector<std::uint8_t> colour_;
  std::int64_t count_ = 0;
  bool over_ = false;
  std::string problem_;
  std::string table_;
};

[[noreturn]] void noMovie(const std::string& source, std::string why, const char* hint = "") {
  const std::size_t itself = why.find(source + ": ");
  if (itself != std::string::npos) why = why.substr(itself + source.size() + 2);
  throw CameraError(source + ": is not a movie that ffmpeg can read" +
                    (why.empty() ? "" : " (" + why + ")") + hint);
}

/// Advice for an MP4 whose recording was interrupted.
const char* hintFor(const std::string& errors) {
  return errors.find("moov atom not found") == std::string::npos
             ? ""
             : ": an MP4 that was not closed has no index; record MKV";
}

/// Starts ffprobe.
/// @param entries, form as for its options -show_entries and -of
MediaProcess probeOf(const std::string& source, const char* entries, const char* form) {
  std::vector<std::string> command{
      "ffprobe", "-v", "error", "-select_streams", "v:0", "-of", form, "-show_entries", entries};
  for (const std::string& word : inputOf(source)) command.push_back(word);
  return MediaProcess(command, source + ": movies are read by", "ffmpeg");
}

/// Waits for the end of ffprobe.
/// @throws CameraError if it could not read the movie
void requireRead(const std::string& source, MediaProcess& probe) {
  const int status = probe.finish();
  if (probe.errors().find("Format not on whitelist") != std::string::npos) {
    noMovie(source, "it is a playlist, or of a kind that is not used for movies",
            ": convert it to MKV with ffmpeg");
  }
  if (status != 0) noMovie(source, probe.lastErrorLine(), hintFor(probe.errors()));
}

/// Reads the times of the frames.
void readPackets(const std::string& source, std::size_t most, MovieInfo& found) {
  MediaProcess probe = probeOf(source, PacketTimes::kEntries, PacketTimes::kForm);
  PacketTimes times(most);
  bool few = true;
  probe.readLines([&](std::string_view line) { return few = times.add(line); });
  if (!few) {
    throw CameraError(source + ": found more than " + std::to_string(most) +
                      " frames, expected at most that many: cut it with ffmpeg (-ss, -t)");
  }
  requireRead(source, probe);
  found.utimes = times.take();
  found.time_problem = times.problem();
  found.never_shown = times.neverShown();
  if (const std::string warning = probe.lastErrorLine(); !warning.empty()) found.warning = warning;
}

}  // namespace

std::vector<std::string> inputOfMovie(const std::string& file) {
  const std::string problem = regularFileProblem(file, file_kinds::kMovie);
  if (!problem.empty()) throw CameraError(file + ": " + problem);
  return {"-protocol_whitelist", "file", "-format_whitelist", kMovieFormats, "-i", "file:" + file};
}

MovieInfo probeMovie(const std::string& source, std::size_t most_packets) {
  if (!isCameraAddress(source) && !std::filesystem::exists(source)) {
    throw CameraError(source + ": no such file");
  }
  MediaProcess probe = probeOf(source,
                               "stream=codec_name,pix_fmt,width,height,avg_frame_rate,nb_frames"
                               ":stream_side_data=rotation",
                               "json=compact=1");
  const std::string answer = probe.readAll();
  requireRead(source, probe);
  const json facts = json::parse(answer, nullptr, false);
  if (!facts.is_object()) noMovie(source, probe.lastErrorLine(), hintFor(probe.errors()));
  const auto streams = facts.find("streams");
  if (streams == facts.end() || streams->empty()) noMovie(source, "it has no pictures");
  const json& stream = streams->front();
  MovieInfo found;
  found.width = stream.value("width", 0);
  found.height = stream.value("height", 0);
  found.fps = rateOf(textOf(stream, "avg_frame_rate"));
  const std::string codec = textOf(stream, "codec_name");
  const std::string pixels = textOf(stream, "pix_fmt");
  if (codec == "ansi" || codec == "bintext") noMovie(source, "it is a text file");
  if (found.width <= 0 || found.height <= 0) noMovie(source, "its pictures have no size");
  if (const std::string problem = pictureSizeProblem(found.width, found.height); !problem.empty()) {
    throw CameraError(source + ": " + problem);
  }
  found.pixels = pixels + " (" + codec + ")";
  found.compressed = !losesNothing(codec);
  found.grey = pixels.starts_with("gray");
  found.claimed = std::atoll(textOf(stream, "nb_frames").c_str());
  for (const json& side : stream.value("side_data_list", json::array())) {
    found.rotation = side.value("rotation", found.rotation);
  }
  found.warning = probe.lastErrorLine();
  if (most_packets > 0) readPackets(source, most_packets, found);
  return found;
}

std::vector<std::string> decodeCommand(const std::string& source, bool grey) {
  std::vector<std::string> command = {"ffmpeg", "-nostdin", "-v", "error", "-noautorotate"};
  for (const std::string& word : inputOf(source)) command.push_back(word);
  for (const char* word :
       {"-map", "0:v:0", "-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt"}) {
    command.emplace_back(word);
  }
  command.emplace_back(grey ? "gray" : "rgb24");
  command.emplace_back("pipe:1");
  return command;
}

std::unique_ptr<FilmReader> openMovie(const std::string& source, double fps) {
  return std::make_unique<MovieReader>(source, fps);
}

}  // namespace lab::cameras
