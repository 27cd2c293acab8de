// SPDX-License-Identifier: MIT
#include "video/png.h"

#include <png.h>

#include "core/file.h"

namespace swallowclip::video {
namespace {
// llvmpipe's largest picture, and a gigabyte of RGBA; assumed, range 8192 to 32768.
constexpr int kLongestSide = 16384;

bool opaque(const Image& image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4)
    if (image.rgba[i] != 255) return false;
  return true;
}
}  // namespace

Result<std::string> encodePng(const Image& image) {
  if (image.width < 1 || image.height < 1 || image.width > kLongestSide ||
      image.height > kLongestSide ||
      image.rgba.size() != static_cast<std::size_t>(image.width) * image.height * 4)
    return failure("picture",
                   fmt::format("{} x {} pixels in {} bytes can't be a PNG", image.width,
                               image.height, image.rgba.size()),
                   fmt::format("Ask for a size from 1 to {} pixels a side.", kLongestSide));
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> rgb;
  const void* pixels = image.rgba.data();
  if (opaque(image)) {  // a quarter fewer bytes
    png.format = PNG_FORMAT_RGB;
    rgb.reserve(image.rgba.size() / 4 * 3);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
      rgb.insert(rgb.end(), image.rgba.begin() + static_cast<std::ptrdiff_t>(i),
                 image.rgba.begin() + static_cast<std::ptrdiff_t>(i + 3));
    pixels = rgb.data();
  }
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, pixels, 0, nullptr)) {
    png_image_free(&png);
    return failure("picture", fmt::format("libpng: {}", png.message), "Free memory and try again.");
  }
  bytes.resize(size);
  return bytes;
}

Result<void> writePng(const Image& image, const std::filesystem::path& path) {
  Result<std::string> bytes = encodePng(image);
  if (!bytes) {
    bytes.error().place = path.string();
    return std::unexpected(bytes.error());
  }
  return writeFile(path, *bytes);
}

Result<Image> readPng(const std::filesystem::path& path) {
  const Result<std::string> bytes = readFile(path);
  if (!bytes) return std::unexpected(bytes.error());
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const auto refuse = [&](const std::string& problem) {
    png_image_free(&png);
    return usageError(path.string(), problem, "Write it again, or name a PNG picture.");
  };
  if (!png_image_begin_read_from_memory(&png, bytes->data(), bytes->size()))
    return refuse(fmt::format("is not a whole PNG picture ({})", png.message));
  if (png.width > kLongestSide || png.height > kLongestSide)
    return refuse(fmt::format("is {} x {} pixels, at most {} a side expected", png.width,
                              png.height, kLongestSide));
  png.format = PNG_FORMAT_RGBA;
  Image image(static_cast<int>(png.width), static_cast<int>(png.height));
  if (!png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr))
    return refuse(fmt::format("is a damaged PNG picture ({})", png.message));
  return image;
}
}  // namespace swallowclip::video
