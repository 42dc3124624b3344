#include "tracker_svc/cameras/stream_source.hpp"

#include <wordexp.h>

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "common/camera/camera_source.hpp"
#include "common/camera/sim_camera.hpp"
#include "tracker_svc/cameras/film_source.hpp"
#include "tracker_svc/cameras/frame_queue.hpp"
#include "tracker_svc/cameras/grey.hpp"
#include "tracker_svc/cameras/media_process.hpp"
#include "tracker_svc/cameras/movie_reader.hpp"

namespace lab::cameras {
namespace {

using Kind = FrameQueue::Item::Kind;

constexpr std::int64_t kAgain_us = 1'000'000;

/// A program that writes frames, and their format.
struct StreamCommand {
  std::string source;
  std::vector<std::string> words;
  std::string package;
  CameraFormat format;
  int channels = 1;  ///< 1 or 3 bytes per pixel
  int stride = 0;    ///< [bytes] per row
};

StreamCommand networkCommand(const std::string& source, const CameraFormat& wanted) {
  const MovieInfo facts = probeMovie(source, 0);
  StreamCommand command{source, decodeCommand(source, facts.grey), "ffmpeg", {}, 1, facts.width};
  command.format.width = facts.width;
  command.format.height = facts.height;
  command.format.fps = facts.fps;
  command.format.pixels = facts.pixels;
  command.format.compressed = facts.compressed;
  if (!facts.grey) {
    command.channels = 3;
    command.stride = 3 * facts.width;
  }
  checkSize(source, wanted, command.format);
  return command;
}

/// Splits a pipeline into words as a shell would, without running anything.
std::vector<std::string> wordsOf(const std::string& source, const std::string& pipeline) {
  wordexp_t words{};
  if (wordexp(pipeline.c_str(), &words, WRDE_NOCMD | WRDE_UNDEF) != 0) {
    throw CameraError(source + ": invalid pipeline: quote characters that are special to a shell");
  }
  std::vector<std::string> found(words.we_wordv, words.we_wordv + words.we_wordc);
  wordfree(&words);
  if (found.empty()) throw CameraError(source + ": is empty, expected gst:ELEMENT ! ELEMENT ...");
  return found;
}

StreamCommand pipelineCommand(const std::string& source, const CameraFormat& wanted) {
  if (wanted.width <= 0 || wanted.height <= 0) {
    throw CameraError(source +
                      ": the size of a pipeline's pictures is unknown: set width_px and height_px");
  }
  StreamCommand command{source, {"gst-launch-1.0", "-q"}, "gstreamer1.0-tools", wanted, 1, 0};
  for (const std::string& word :
       wordsOf(source, source.substr(std::string(kPipelinePrefix).size()))) {
    command.words.push_back(word);
    // The names of decoder elements contain "dec": their input was compressed.
    if (word.find("dec") != std::string::npos) command.format.compressed = true;
  }
  // Colorimetry 1:4:0:0: full-range grey, 0 to 255.
  const std::string form = "video/x-raw,format=GRAY8,width=" + std::to_string(wanted.width) +
                           ",height=" + std::to_string(wanted.height) +
                           ",colorimetry=(string)1:4:0:0";
  for (const char* word : {"!", "videoconvert", "!", form.c_str(), "!", "fdsink", "fd=1"}) {
    command.words.emplace_back(word);
  }
  command.format.pixels = "GRAY8 (gstreamer)";
  command.format.locked = false;
  command.stride = (wanted.width + 3) / 4 * 4;  // GStreamer pads rows to multiples of 4 bytes
  return command;
}

/// The reading thread: runs the program, reads its frames, and restarts it when it ends.
class Stream {
 public:
  Stream(AsioLoop& loop, StreamCommand command)
      : loop_(loop),
        command_(std::move(command)),
        bytes_(static_cast<std::size_t>(command_.stride) *
               static_cast<std::size_t>(command_.format.height)),
        thread_([this] { work(); }) {}

  ~Stream() {
    feed_.close();
    {
      const std::lock_guard lock(mutex_);
      if (child_) child_->kill();
    }
    thread_.join();
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  [[nodiscard]] FrameQueue& feed() { return feed_; }
  [[nodiscard]] const CameraFormat& format() const { return command_.format; }

 private:
  void work() {
    while (feed_.isOpen()) {
      std::string reason = runOnce();
      if (!feed_.isOpen()) return;
      tell(command_.source + ": the camera is gone" + (reason.empty() ? "" : " (" + reason + ")") +
           "; retrying every second");
      if (!feed_.pause(kAgain_us)) return;
    }
  }

  /// @return why it ended
  std::string runOnce() {
    try {
      auto fresh = std::make_unique<MediaProcess>(
          command_.words, command_.source + ": it is read by", command_.package);
      const std::lock_guard lock(mutex_);
      child_ = std::move(fresh);
      if (!feed_.isOpen()) child_->kill();
    } catch (const CameraError& error) {
      return error.what();
    }
    while (child_->read(bytes_) == bytes_.size()) pass();
    child_->finish();
    const std::lock_guard lock(mutex_);
    std::string error = child_->lastErrorLine();
    child_.reset();
    return error;
  }

  void pass() {
    if (std::exchange(troubled_, false)) tell("");
    const CameraFormat& format = command_.format;
    FrameQueue::Item item;
    item.number = count_++;
    item.utime = loop_.now();
    item.image = feed_.blank(format.width, format.height);
    for (int y = 0; y < format.height; ++y) {
      const std::uint8_t* row = bytes_.data() + std::ptrdiff_t{y} * command_.stride;
      const std::span<std::uint8_t> grey(item.image.row(y), static_cast<std::size_t>(format.width));
      if (command_.channels == 3) {
        greyFromRgb(row, grey);
      } else {
        std::copy_n(row, format.width, grey.begin());
      }
    }
    feed_.pushDroppingOldest(std::move(item));
  }

  void tell(const std::string& trouble) {
    FrameQueue::Item item;
    item.kind = Kind::kTrouble;
    item.text = trouble;
    troubled_ = !trouble.empty();
    feed_.push(std::move(item));
  }

  AsioLoop& loop_;
  StreamCommand command_;
  std::vector<std::uint8_t> bytes_;
  FrameQueue feed_;
  std::mutex mutex_;  ///< guards child_, which the other thread may access
  std::unique_ptr<MediaProcess> child_;
  std::int64_t count_ = 0;
  bool troubled_ = false;
  std::thread thread_;  ///< last member: it uses all members above
};

/// Kept alive during a handler call, which may destroy the source.
class StreamReader : public std::enable_shared_from_this<StreamReader> {
 public:
  StreamReader(AsioLoop& loop, StreamCommand command, CameraHandlers handlers)
      : handlers_(std::move(handlers)), stream_(std::in_place, loop, std::move(command)) {}

  void start(AsioLoop& loop) {
    watch_ = loop.watch(stream_->feed().descriptor(), [this] {
      const std::shared_ptr<StreamReader> alive = shared_from_this();
      while (stream_) {
        std::optional<FrameQueue::Item> item = stream_->feed().pop();
        if (!item) return;
        hand(*item);
      }
    });
  }

  void close() {
    watch_.reset();
    stream_.reset();
  }

  [[nodiscard]] CameraFormat format() const { return stream_->format(); }
  [[nodiscard]] std::int64_t dropped() const { return gaps_.missing(); }

 private:
  void hand(FrameQueue::Item& item) {
    if (item.kind == Kind::kTrouble) {
      handlers_.trouble(item.text);
      return;
    }
    gaps_.add(item.number);
    handlers_.frame({item.number, item.utime, item.image.view()});
    if (stream_) stream_->feed().recycle(std::move(item.image));
  }

  CameraHandlers handlers_;
  std::optional<Stream> stream_;
  std::unique_ptr<AsioLoop::Watch> watch_;
  GapCounter gaps_;
};

class StreamSource final : public FrameSource {
 public:
  StreamSource(AsioLoop& loop, StreamCommand command, CameraHandlers handlers)
      : reader_(std::make_shared<StreamReader>(loop, std::move(command), std::move(handlers))) {
    reader_->start(loop);
  }
  ~StreamSource() override { reader_->close(); }

  [[nodiscard]] CameraFormat format() const override { return reader_->format(); }
  [[nodiscard]] std::int64_t dropped() const override { return reader_->dropped(); }

 private:
  std::shared_ptr<StreamReader> reader_;
};

}  // namespace

bool isStreamSource(const std::string& source) {
  return source.starts_with(kPipelinePrefix) || isCameraAddress(source);
}

std::unique_ptr<FrameSource> openStream(AsioLoop& loop, const std::string& source,
                                        const CameraFormat& wanted, CameraHandlers handlers) {
  StreamCommand command = source.starts_with(kPipelinePrefix) ? pipelineCommand(source, wanted)
                                                              : networkCommand(source, wanted);
  return std::make_unique<StreamSource>(loop, std::move(command), std::move(handlers));
}

}  // namespace lab::cameras
