// SPDX-License-Identifier: MIT
#include "video/frame_sink.h"

#include <fstream>

#include "core/digest.h"
#include "core/file.h"
#include "video/png.h"

namespace swallowclip::video {
namespace {
namespace fs = std::filesystem;

/// Frames wait under hidden names until all of them are there.
class PngSink : public FrameSink {
 public:
  PngSink(fs::path folder, std::string stem) : folder_(std::move(folder)), stem_(std::move(stem)) {}

  ~PngSink() override {
    std::error_code ignored;
    for (int i = published_; i < written_; ++i) fs::remove(asidePath(name(i)), ignored);
  }

  Result<void> push(const Image& image) override {
    const fs::path path = name(written_);
    Result<std::string> bytes = encodePng(image);
    if (!bytes) return std::unexpected(bytes.error());
    ++written_;
    std::ofstream out(asidePath(path), std::ios::binary);
    out.write(bytes->data(), static_cast<std::streamsize>(bytes->size()));
    out.close();
    if (!out)
      return failure(path.string(), "can't be written",
                     "Check that the folder is writable and has space.");
    return {};
  }

  Result<void> finish() override {
    if (written_ == 0)
      return failure(folder_.string(), "no frames were drawn, at least one expected",
                     "Check the clip's time range.");
    for (; published_ < written_; ++published_)
      if (auto done = publishFile(asidePath(name(published_)), name(published_)); !done)
        return done;
    return {};
  }

 private:
  fs::path name(int index) const { return folder_ / fmt::format("{}_{:05}.png", stem_, index); }

  fs::path folder_;
  std::string stem_;
  int written_ = 0, published_ = 0;
};
}  // namespace

Result<std::unique_ptr<FrameSink>> makePngSink(const fs::path& folder, const std::string& stem) {
  if (auto ready = prepareFolder(folder); !ready) return std::unexpected(ready.error());
  return std::make_unique<PngSink>(folder, stem);
}

Result<void> HashSink::push(const Image& image) {
  const int size[2] = {image.width, image.height};
  const std::uint64_t frame =
      stateDigest(image.rgba.data(), image.rgba.size(), stateDigest(size, sizeof size));
  frames_.push_back(frame);
  digest_ = stateDigest(&frame, sizeof frame, digest_);
  return {};
}

Result<void> HashSink::finish() {
  return {};
}
}  // namespace swallowclip::video
