#include "tracker_svc/cameras/film_recorder.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <ctime>
#include <initializer_list>
#include <span>
#include <utility>

namespace lab::cameras {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFewestWaiting = 4;
constexpr int kNiceness = 5;  // above that of the lab: robots and tracker come first
constexpr auto kClosingTimeout = std::chrono::seconds(1);
constexpr std::int64_t kFactsEvery = 128;            // frames
constexpr std::int64_t kDiskEvery = 16;              // frames
constexpr std::int64_t kTicksPerSecond = 1'000'000;  // of the IVF stream

const char* nameOf(FilmCodec codec) {
  switch (codec) {
    case FilmCodec::kFfvhuff:
      return "ffvhuff";
    case FilmCodec::kH264:
      return "h264";
    default:
      return "ffv1";
  }
}

template <std::size_t N>
void put(std::span<std::uint8_t> into, std::uint64_t value) {
  for (std::size_t i = 0; i < N; ++i) into[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

/// The header of an IVF file (wiki.multimedia.cx/index.php/IVF), little-endian.
std::array<std::uint8_t, 32> ivfHeader(int width, int height) {
  std::array<std::uint8_t, 32> header{'D', 'K', 'I', 'F', 0, 0, 32, 0, 'Y', '8', '0', '0'};
  const std::span all(header);
  put<2>(all.subspan(12), static_cast<std::uint64_t>(width));
  put<2>(all.subspan(14), static_cast<std::uint64_t>(height));
  put<4>(all.subspan(16), kTicksPerSecond);
  put<4>(all.subspan(20), 1);
  return header;
}

std::array<std::uint8_t, 12> ivfFrameHeader(std::size_t bytes, std::int64_t ticks) {
  std::array<std::uint8_t, 12> header{};
  const std::span all(header);
  put<4>(all, bytes);
  put<8>(all.subspan(4), static_cast<std::uint64_t>(ticks));
  return header;
}

double threadCpu() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

std::vector<std::string> encodeCommand(const FilmSpec& film, double fps, const fs::path& movie) {
  std::vector<std::string> command{"ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-y",
                                   "-f", "ivf", "-i", "pipe:0", "-map", "0:v:0",
                                   // Every frame once, at its own time.
                                   "-fps_mode", "passthrough", "-enc_time_base", "1:1000000",
                                   "-threads", std::to_string(film.threads)};
  const auto add = [&](std::initializer_list<std::string> words) {
    command.insert(command.end(), words);
  };
  switch (film.codec) {
    case FilmCodec::kFfv1:
      // Checksums show damage. Golomb codes take half of the time of range codes, for 0.1 % more
      // bytes. Each frame can be read without the others.
      add({"-c:v", "ffv1", "-level", "3", "-coder", "0", "-context", "0", "-g", "1", "-slices", "4",
           "-slicecrc", "1"});
      break;
    case FilmCodec::kFfvhuff:
      add({"-c:v", "ffvhuff", "-pred", "left"});
      break;
    case FilmCodec::kH264:
      // A frame a second that can be read without the others.
      add({"-c:v", "libx264", "-preset", "ultrafast", "-crf", std::to_string(film.crf), "-g",
           std::to_string(std::max(1, static_cast<int>(std::lround(fps)))), "-color_range", "pc"});
      break;
  }
  // Short clusters: little is lost if ffmpeg is killed.
  add({"-cluster_time_limit", "1000", "-f", "matroska", "file:" + movie.string()});
  return command;
}

FilmRecorder::FilmRecorder(FilmRecording recording)
    : recording_(std::move(recording)), movie_(recording_.folder / film_files::kMovie) {
  const CameraFormat& format = recording_.format;
  const std::size_t bytes =
      static_cast<std::size_t>(format.width) * static_cast<std::size_t>(format.height);
  capacity_ = recording_.may_wait
                  ? kFewestWaiting
                  : std::max(kFewestWaiting, kQueueBytes / recording_.bounds->films /
                                                 std::max<std::size_t>(bytes, 1));
  facts_.camera = recording_.camera;
  facts_.codec = nameOf(recording_.film.codec);
  facts_.crf = recording_.film.codec == FilmCodec::kH264 ? recording_.film.crf : 0;
  facts_.format = format;
  facts_.start_utime = recording_.start_utime;
  table_.open(filmTableOf(movie_), std::ios::binary);
  table_ << filmTableHeader(columns()) << std::flush;
  if (!table_ || !writeFilmFacts(recording_.folder / film_files::kFacts, facts_)) {
    throw CameraError(recording_.folder.string() + ": cannot be written: is the disk full?");
  }
  thread_ = std::thread([this] { run(); });
}

FilmRecorder::~FilmRecorder() {
  {
    std::unique_lock lock(mutex_);
    closing_ = true;
    changed_.notify_all();
    if (!recording_.may_wait) {
      changed_.wait_for(lock, kClosingTimeout, [this] { return items_.empty(); });
      facts_.lost += static_cast<std::int64_t>(items_.size());
      items_.clear();
      changed_.notify_all();
      changed_.wait_for(lock, kClosingTimeout, [this] { return done_; });
      if (!done_ && encoder_) encoder_->kill();
    }
  }
  changed_.notify_all();
  thread_.join();
  // Frames that came after the end of the film are counted as well.
  static_cast<void>(writeFilmFacts(recording_.folder / film_files::kFacts, facts_));
}

void FilmRecorder::add(FilmFrame frame, std::int64_t utime, const optics::GreyView& picture) {
  std::unique_lock lock(mutex_);
  if (recording_.may_wait) {
    changed_.wait(lock, [this] { return ended_ || items_.size() < capacity_; });
  }
  if (ended_) {
    ++facts_.after_end;
    return;
  }
  if (items_.size() >= capacity_) {
    ++facts_.lost;
    if (!std::exchange(loss_said_, true)) {
      news_ = fmt::format(
          "{}: frames are lost: {} with {} takes longer for a frame than the camera; frames that "
          "are lost are counted in film.json; ffvhuff and h264 are faster, record_threads adds "
          "threads",
          name(), facts_.codec,
          recording_.film.threads == 1 ? "one thread"
                                       : fmt::format("{} threads", recording_.film.threads));
    }
    return;
  }
  Item item{frame, utime, {}};
  if (!spare_.empty()) {
    item.picture = std::move(spare_.back());
    spare_.pop_back();
  }
  lock.unlock();
  if (item.picture.width != picture.width || item.picture.height != picture.height) {
    item.picture = optics::GreyImage(picture.width, picture.height);
  }
  for (int y = 0; y < picture.height; ++y) {
    std::memcpy(item.picture.row(y), picture.row(y), static_cast<std::size_t>(picture.width));
  }
  lock.lock();
  if (ended_) {  // while the picture was copied
    ++facts_.after_end;
    return;
  }
  items_.push_back(std::move(item));
  changed_.notify_all();
}

std::string FilmRecorder::news() {
  const std::lock_guard lock(mutex_);
  return std::exchange(news_, {});
}

std::string FilmRecorder::name() const {
  return recording_.camera.empty() ? "film" : "film of camera " + recording_.camera;
}

FilmTable FilmRecorder::columns() const {
  return recording_.camera.empty() ? FilmTable::kOneCamera : FilmTable::kSeveralCameras;
}

FilmFacts FilmRecorder::facts() {
  const std::lock_guard lock(mutex_);
  return facts_;
}

void FilmRecorder::run() {
  // Of this thread; the encoder inherits it.
  setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + kNiceness);
  // An encoder that has ended is noticed by the error of write().
  sigset_t pipe_signal;
  sigemptyset(&pipe_signal);
  sigaddset(&pipe_signal, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipe_signal, nullptr);
  try {
    {
      const std::lock_guard lock(mutex_);
      encoder_.emplace(encodeCommand(recording_.film, recording_.format.fps, movie_));
    }
    if (!encoder_->write(ivfHeader(recording_.format.width, recording_.format.height))) {
      end("ffmpeg ended: " + encoder_->errorLine());
    }
  } catch (const CameraError& error) {
    end(error.what());
  }
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return closing_ || !items_.empty(); });
    if (items_.empty() || ended_) break;
    Item item = std::move(items_.front());
    items_.pop_front();
    lock.unlock();
    changed_.notify_all();
    const bool written = write(item) && checkSize();
    lock.lock();
    if (!written) break;
    if (spare_.size() < capacity_) spare_.push_back(std::move(item.picture));
  }
  lock.unlock();
  complete();
}

/// @return false if the film has ended
bool FilmRecorder::write(Item& item) {
  if (position_ == 0) first_camera_ = item.frame.camera_utime;
  const std::int64_t ticks = item.frame.camera_utime - first_camera_;
  item.frame.frame = position_;
  item.frame.time = static_cast<double>(ticks) / kTicksPerSecond;
  // The row first: a movie without its last frames is readable, a frame without its row is not.
  table_ << filmTableLine(item.frame, columns()) << std::flush;
  const bool written = table_.good() &&
                       encoder_->write(ivfFrameHeader(item.picture.pixels.size(), ticks)) &&
                       encoder_->write(item.picture.pixels);
  if (!written) {
    end(table_.good() ? "ffmpeg ended: " + encoder_->errorLine()
                      : "the table of its frames cannot be written: is the disk full?");
    const std::lock_guard lock(mutex_);
    ++facts_.after_end;
    return false;
  }
  ++position_;
  const std::lock_guard lock(mutex_);
  if (facts_.frames == 0) facts_.first_utime = item.utime;
  facts_.last_utime = item.utime;
  facts_.frames = position_;
  return true;
}

/// Looks at the disk now and then. @return false if the film has ended
bool FilmRecorder::checkSize() {
  if (position_ < next_check_) return true;
  next_check_ = position_ + kDiskEvery;
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(movie_, error);
  if (!error) {
    const std::lock_guard lock(mutex_);
    facts_.bytes = static_cast<std::int64_t>(bytes);
  }
  if (!error) {
    SharedBounds& bounds = *recording_.bounds;
    const std::int64_t grown = static_cast<std::int64_t>(bytes) - shared_bytes_;
    shared_bytes_ += grown;
    if (static_cast<double>(bounds.bytes += grown) >= recording_.film.most_GB * 1e9) {
      end(fmt::format("{} reached {:g} GB (camera.record_most_GB)",
                      bounds.films == 1 ? "it has" : "the films of all cameras have",
                      recording_.film.most_GB));
      return false;
    }
  }
  const fs::space_info space = fs::space(recording_.folder, error);
  if (!error && space.available < kReserve) {
    end(fmt::format("its disk is nearly full: {} MB are free, and {} MB are kept for the log",
                    space.available / 1'000'000, kReserve / 1'000'000));
    return false;
  }
  if (position_ % kFactsEvery < kDiskEvery) saveFacts();
  return true;
}

void FilmRecorder::end(const std::string& problem) {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  facts_.problem = problem;
  facts_.after_end += static_cast<std::int64_t>(items_.size());
  items_.clear();
  news_ =
      fmt::format("{}: ends after {} frames: {}; the run goes on", name(), facts_.frames, problem);
  changed_.notify_all();
}

/// Completes the movie, and its facts.
void FilmRecorder::complete() {
  saveFacts();  // the processor time of the encoder cannot be read after its end
  if (encoder_) {
    const int code = encoder_->finish();
    const std::string error = encoder_->errorLine();
    if (facts().problem.empty() && (code != 0 || !error.empty())) {
      end(error.empty() ? fmt::format("ffmpeg ended with {}", code) : "ffmpeg: " + error);
    }
  }
  {
    const std::lock_guard lock(mutex_);
    facts_.complete = true;
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(movie_, error);
    if (!error) facts_.bytes = static_cast<std::int64_t>(bytes);
  }
  const FilmFacts last = facts();
  static_cast<void>(writeFilmFacts(recording_.folder / film_files::kFacts, last));
  const std::lock_guard lock(mutex_);
  done_ = true;
  changed_.notify_all();
}

/// The facts so far are on the disk if this process is killed.
void FilmRecorder::saveFacts() {
  const double cpu = threadCpu() + (encoder_ ? encoder_->cpu() : 0);
  FilmFacts now;
  {
    const std::lock_guard lock(mutex_);
    facts_.cpu = cpu;
    now = facts_;
  }
  static_cast<void>(writeFilmFacts(recording_.folder / film_files::kFacts, now));
}

}  // namespace lab::cameras
