#include "tracker_svc/cameras/film_source.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>

#include "tracker_svc/cameras/frame_queue.hpp"
#include "tracker_svc/film_reader.hpp"

namespace lab::cameras {
namespace {

using Kind = FrameQueue::Item::Kind;

constexpr std::int64_t kMostLate_us = 1'000'000;

/// Decodes until the end or until the feed is closed.
void decodeAll(FilmReader& film, FrameQueue& feed) {
  CameraFrame frame;
  while (film.next(frame)) {
    FrameQueue::Item item;
    item.number = frame.number;
    item.utime = frame.utime;
    item.dropped = film.dropped();
    item.image = feed.blank(frame.grey.width, frame.grey.height);
    for (int y = 0; y < frame.grey.height; ++y) {
      std::copy_n(frame.grey.row(y), frame.grey.width, item.image.row(y));
    }
    if (!feed.push(std::move(item))) return;
  }
  FrameQueue::Item end;
  end.kind = Kind::kEnd;
  end.dropped = film.dropped();
  end.text = film.problem();
  feed.push(std::move(end));
}

/// Shared with its timers and with a running handler, which may destroy the source.
class Player : public std::enable_shared_from_this<Player> {
 public:
  /// @param pace factor on the recording's durations, 0: as fast as possible
  Player(AsioLoop& loop, CameraHandlers handlers, double pace)
      : loop_(loop), handlers_(std::move(handlers)), pace_(pace) {}

  void start(FilmReader& film) {
    thread_ = std::thread([this, &film] { decodeAll(film, feed_); });
    listen();
  }

  void close() {
    closed_ = true;
    watch_.reset();
    feed_.close();
    if (thread_.joinable()) thread_.join();
  }

  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  /// Waits for the next item to arrive. Not active while an item waits for its time.
  void listen() {
    watch_ = loop_.watch(feed_.descriptor(), [this] {
      const std::shared_ptr<Player> alive = shared_from_this();
      take();
    });
  }

  void take() {
    std::optional<FrameQueue::Item> item = feed_.pop();
    if (!item) return;
    const std::int64_t wait = dueAfter(*item);
    if (wait <= 0) {
      hand(*item);
      return;
    }
    watch_.reset();
    auto later = std::make_shared<FrameQueue::Item>(std::move(*item));
    loop_.at(loop_.now() + wait, [player = weak_from_this(), later] {
      const std::shared_ptr<Player> here = player.lock();
      if (!here || here->closed_) return;
      here->hand(*later);
      if (!here->closed_) here->listen();
    });
  }

  /// [us] until the item is due. A slightly late recording catches up; a very late one continues
  /// from now.
  std::int64_t dueAfter(const FrameQueue::Item& item) {
    if (pace_ <= 0 || item.kind != Kind::kFrame) return 0;
    const auto offset = std::llround(static_cast<double>(item.utime) * pace_);
    const std::int64_t now = loop_.now();
    if (!started_ || now > start_ + offset + kMostLate_us) start_ = now - offset;
    started_ = true;
    return start_ + offset - now;
  }

  void hand(FrameQueue::Item& item) {
    dropped_ = item.dropped;
    if (item.kind == Kind::kEnd) {
      watch_.reset();
      handlers_.end(item.text);
      return;
    }
    handlers_.frame({item.number, item.utime, item.image.view()});
    feed_.recycle(std::move(item.image));
  }

  AsioLoop& loop_;
  CameraHandlers handlers_;
  double pace_;
  FrameQueue feed_;
  std::thread thread_;
  std::unique_ptr<AsioLoop::Watch> watch_;
  bool closed_ = false;
  bool started_ = false;
  std::int64_t start_ = 0;
  std::int64_t dropped_ = 0;
};

double paceOf(const CameraFormat& wanted, const CameraFormat& film) {
  if (wanted.fps < 0) return 0;
  return wanted.fps > 0 && film.fps > 0 ? film.fps / wanted.fps : 1;
}

class FilmSource final : public FrameSource {
 public:
  FilmSource(AsioLoop& loop, const std::string& source, const CameraFormat& wanted,
             CameraHandlers handlers)
      : film_(FilmReader::open(source, std::max(wanted.fps, 0.0))),
        format_(film_->format()),
        length_(film_->length()) {
    checkSize(source, wanted, format_);
    player_ = std::make_shared<Player>(loop, std::move(handlers), paceOf(wanted, format_));
    player_->start(*film_);
  }
  ~FilmSource() override { player_->close(); }

  [[nodiscard]] CameraFormat format() const override { return format_; }
  [[nodiscard]] std::int64_t dropped() const override { return player_->dropped(); }
  [[nodiscard]] std::int64_t length() const override { return length_; }

 private:
  std::unique_ptr<FilmReader> film_;  ///< used by the player's thread while it runs
  CameraFormat format_;
  std::int64_t length_;
  std::shared_ptr<Player> player_;
};

}  // namespace

void checkSize(const std::string& source, const CameraFormat& wanted, const CameraFormat& found) {
  const bool fits = (wanted.width == 0 || wanted.width == found.width) &&
                    (wanted.height == 0 || wanted.height == found.height);
  if (fits) return;
  throw CameraError(source + ": found " + std::to_string(found.width) + " x " +
                    std::to_string(found.height) + " pixels, wanted " +
                    std::to_string(wanted.width) + " x " + std::to_string(wanted.height) +
                    "; set width_px and height_px of [camera] to its size");
}

std::unique_ptr<FrameSource> openFilm(AsioLoop& loop, const std::string& source,
                                      const CameraFormat& wanted, CameraHandlers handlers) {
  return std::make_unique<FilmSource>(loop, source, wanted, std::move(handlers));
}

}  // namespace lab::cameras
