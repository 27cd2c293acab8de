// SPDX-License-Identifier: MIT
// Drawing and encoding side by side: push() hands a copy to the encoder's own thread through a
// short queue. One encoder, frames in order: the bytes do not depend on who waits for whom.
#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "core/file.h"
#include "video/h264_encoder.h"

namespace swallowclip::video {
namespace {
namespace fs = std::filesystem;

// H.264 level 6.2 allows 16384 x 8704 (table A-1); x264's own limit is the same side.
constexpr int kLongestSide = 16384;
// mp4 keeps the time scale (512 per frame) in 32 bits.
constexpr int kFastestRate = 1000000;
constexpr int kSlowestRate = 30;  // frames/s, Bonilha 2013

// x264's own words, fastest first; it would print to stderr about others.
const std::vector<std::string> kPresets = {"ultrafast", "superfast", "veryfast", "faster",  "fast",
                                           "medium",    "slow",      "slower",   "veryslow"};

class Mp4Sink : public FrameSink {
 public:
  explicit Mp4Sink(const Mp4Def& def) : def_(def), aside_(asidePath(def.path)) {}

  Result<void> start() {
    if (auto opened = encoder_.open(def_, aside_); !opened) return opened;
    worker_ = std::thread([this] { work(); });
    return {};
  }

  ~Mp4Sink() override {
    join(false);
    std::error_code ignored;
    fs::remove(aside_, ignored);  // gone already when published
  }

  Result<void> push(const Image& image) override {
    if (image.width != def_.width || image.height != def_.height ||
        image.rgba.size() != static_cast<std::size_t>(def_.width) * def_.height * 4)
      return failure(def_.path.string(),
                     fmt::format("frame {} is {} x {}, {} x {} expected", pushed_, image.width,
                                 image.height, def_.width, def_.height),
                     "Draw every frame of a clip at one size.");
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] {
      return error_ || ending_ || queue_.size() < static_cast<std::size_t>(def_.queuedFrames);
    });
    if (error_) return std::unexpected(*error_);
    if (ending_)
      return failure(def_.path.string(), "the clip is finished already", "Begin another clip.");
    Image copy;
    if (!spare_.empty()) {  // reuse a buffer that the encoder is done with
      copy = std::move(spare_.back());
      spare_.pop_back();
    }
    copy.width = image.width;
    copy.height = image.height;
    copy.rgba.assign(image.rgba.begin(), image.rgba.end());
    queue_.push_back(std::move(copy));
    ++pushed_;
    changed_.notify_all();
    return {};
  }

  Result<void> finish() override {
    if (!worker_.joinable())
      return failure(def_.path.string(), "the clip is finished already", "Begin another clip.");
    join(true);
    if (error_) return std::unexpected(*error_);
    if (pushed_ == 0)
      return failure(def_.path.string(), "no frames were drawn, at least one expected",
                     "Check the clip's time range.");
    if (auto closed = encoder_.close(); !closed) return closed;
    return publishFile(aside_, def_.path);
  }

 private:
  /// Ends the thread, with the queue encoded or thrown away.
  void join(bool encodeRest) {
    {
      std::lock_guard lock(mutex_);
      ending_ = true;
      if (!encodeRest) queue_.clear();
    }
    changed_.notify_all();
    if (worker_.joinable()) worker_.join();
  }

  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return ending_ || !queue_.empty(); });
      if (queue_.empty()) return;
      Image image = std::move(queue_.front());
      queue_.pop_front();
      lock.unlock();
      Result<void> done = encoder_.encode(image);
      lock.lock();
      spare_.push_back(std::move(image));
      if (!done) error_ = done.error();
      changed_.notify_all();
      if (error_) return;
    }
  }

  Mp4Def def_;
  fs::path aside_;
  H264Encoder encoder_;  ///< the worker's alone while it runs
  std::thread worker_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Image> queue_;
  std::vector<Image> spare_;
  std::optional<Error> error_;
  bool ending_ = false;
  int pushed_ = 0;
};

Result<void> check(const Mp4Def& d) {
  const auto refuse = [&](const std::string& problem, const std::string& remedy) {
    return usageError(d.path.string(), problem, remedy);
  };
  if (d.width < 2 || d.height < 2 || d.width % 2 || d.height % 2 || d.width > kLongestSide ||
      d.height > kLongestSide)
    return refuse(fmt::format("a clip of {} x {} pixels; even sizes from 2 to {} expected", d.width,
                              d.height, kLongestSide),
                  "Change width and height in the render preset.");
  if (d.rateDenominator < 1 || d.rateNumerator > kFastestRate ||
      d.rateNumerator / std::max(1, d.rateDenominator) < kSlowestRate)
    return refuse(fmt::format("{}/{} frames/s; at least {} expected", d.rateNumerator,
                              d.rateDenominator, kSlowestRate),
                  "Lower rates change MBSImP scores; use 30 or more.");
  if (std::find(kPresets.begin(), kPresets.end(), d.preset) == kPresets.end()) {
    const std::string near = nearestName(d.preset, kPresets);
    return refuse(fmt::format("\"{}\" is not an x264 preset", d.preset),
                  near.empty() ? "Use medium." : fmt::format("Did you mean {}?", near));
  }
  // High profile has no lossless mode, so crf 0 is out.
  if (d.crf < 1 || d.crf > 51 || d.keyframeEvery < 1 || d.queuedFrames < 1)
    return refuse(
        fmt::format("crf {}, keyframe every {}, queue {}; 1 to 51 and at least 1 expected", d.crf,
                    d.keyframeEvery, d.queuedFrames),
        "Change them in the render preset.");
  return {};
}
}  // namespace

Result<std::unique_ptr<FrameSink>> makeMp4Sink(const Mp4Def& def) {
  if (auto sound = check(def); !sound) return std::unexpected(sound.error());
  auto sink = std::make_unique<Mp4Sink>(def);
  if (auto started = sink->start(); !started) return std::unexpected(started.error());
  return sink;
}
}  // namespace swallowclip::video
