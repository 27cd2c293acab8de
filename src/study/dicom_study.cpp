// SPDX-License-Identifier: MIT
#include "study/dicom_study.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>

#include "study/dicom_decoder.h"
#include "study/wire.h"

namespace swallowclip::study {
namespace {
// Memory beyond the file's own size for one frame in all its forms; assumed, range 0.5 to 4 GB.
constexpr std::uint64_t kRoom_bytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kLargestFile_bytes = std::uint64_t{2} << 30;  // assumed, range 1 to 8 GB
constexpr int kPatience_ms = 30000;  // for one frame, or the header; assumed, range 10 to 300 s
constexpr std::uint64_t kLargestMessage_bytes = std::uint64_t{300} << 20;  // 8192 x 8192 RGBA

bool sendAll(int socket, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t n = ::send(socket, data, size, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    data += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

bool receiveAll(int socket, char* data, std::size_t size, int patience_ms) {
  while (size > 0) {
    pollfd wait{socket, POLLIN, 0};
    const int ready = ::poll(&wait, 1, patience_ms);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    const ssize_t n = ::recv(socket, data, size, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    data += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

bool sendMessage(int socket, const std::string& bytes) {
  const std::uint64_t size = bytes.size();
  return sendAll(socket, reinterpret_cast<const char*>(&size), sizeof size) &&
         sendAll(socket, bytes.data(), bytes.size());
}

bool receiveMessage(int socket, std::string& bytes, int patience_ms) {
  std::uint64_t size = 0;
  if (!receiveAll(socket, reinterpret_cast<char*>(&size), sizeof size, patience_ms) ||
      size > kLargestMessage_bytes)
    return false;
  bytes.resize(size);
  return receiveAll(socket, bytes.data(), size, patience_ms);
}

// A message is a byte (1: value follows, 0: an error's problem and remedy follow), then its parts.
std::string packed(const Error& error) {
  WireWriter w;
  w.put(std::uint8_t{0});
  w.put(error.problem);
  w.put(error.remedy);
  return w.bytes();
}

std::string packed(const StudyInfo& info) {
  WireWriter w;
  w.put(std::uint8_t{1});
  w.put(info.width);
  w.put(info.height);
  w.put(info.time_s);
  w.put(info.kind);
  w.put(info.timing);
  w.put(info.burnedIn);
  w.put(info.warnings);
  return w.bytes();
}

std::string packed(const Image& image) {
  WireWriter w;
  w.put(std::uint8_t{1});
  w.put(std::string(image.rgba.begin(), image.rgba.end()));
  return w.bytes();
}

/// A decoder prints and crashes as it likes, but nothing of it reaches a log or a dump.
void fallSilent() {
  if (const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC); nowhere >= 0) {
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    ::close(nowhere);
  }
  ::prctl(PR_SET_DUMPABLE, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a decoder that hangs does not outlive us
}

void limitMemory(std::uint64_t file_bytes) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they reserve terabytes
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;  // what the parent had mapped stays mapped
  const rlim_t limit =
      pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + 3 * file_bytes + kRoom_bytes;
  const rlimit space{limit, limit};
  ::setrlimit(RLIMIT_AS, &space);
#else
  (void)file_bytes;
#endif
}

/// The child's whole life: the header, then one frame per request until the parent goes away.
void serve(int socket, const StudyDef& def, std::uint64_t file_bytes) {
  fallSilent();
  limitMemory(file_bytes);
  try {
    auto decoder = DicomDecoder::open(def);
    if (!sendMessage(socket, decoder ? packed((*decoder)->info()) : packed(decoder.error())) ||
        !decoder)
      return;
    int k = 0;
    while (receiveAll(socket, reinterpret_cast<char*>(&k), sizeof k, -1)) {
      auto image = (*decoder)->frame(k);
      if (!sendMessage(socket, image ? packed(*image) : packed(image.error()))) return;
    }
  } catch (const std::exception&) {  // out of memory: the parent sees that we are gone
  }
}

class DicomStudy : public Study {
 public:
  ~DicomStudy() override {
    if (socket_ >= 0) ::close(socket_);
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
  }

  Result<void> start(const StudyDef& def, std::uint64_t file_bytes) {
    int sockets[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0)
      return failure(kPlace, "no decoder can be started", "Close other programs.");
    child_ = ::fork();
    if (child_ == 0) {
      ::close(sockets[0]);
      serve(sockets[1], def, file_bytes);
      ::_exit(0);  // a copy of our process: it must not tidy up what is the parent's
    }
    ::close(sockets[1]);
    socket_ = sockets[0];
    if (child_ < 0) return failure(kPlace, "no decoder can be started", "Close other programs.");
    return readInfo();
  }

  Result<Image> frame(int k) override {
    std::string message;
    if (!sendAll(socket_, reinterpret_cast<const char*>(&k), sizeof k) ||
        !receiveMessage(socket_, message, kPatience_ms))
      return refuse(fmt::format("frame {} breaks its decoder", k),
                    "It is damaged: export it again.");
    WireReader r(message);
    if (auto value = isValue(r); !value) return std::unexpected(value.error());
    std::string pixels;
    r.get(pixels);
    Image image(info_.width, info_.height);
    if (!r.complete() || pixels.size() != image.rgba.size())
      return refuse(fmt::format("frame {} breaks its decoder", k),
                    "It is damaged: export it again.");
    std::ranges::copy(pixels, image.rgba.begin());
    return image;
  }

 private:
  Result<void> isValue(WireReader& r) const {
    std::uint8_t value = 0;
    r.get(value);
    if (value == 1) return {};
    Error error{ErrorKind::usage, kPlace, {}, {}};
    r.get(error.problem);
    r.get(error.remedy);
    return std::unexpected(error);
  }

  Result<void> readInfo() {
    std::string message;
    if (!receiveMessage(socket_, message, kPatience_ms))
      return refuse("breaks its decoder", "It is damaged: export it again.");
    WireReader r(message);
    if (auto value = isValue(r); !value) return value;
    r.get(info_.width);
    r.get(info_.height);
    r.get(info_.time_s);
    r.get(info_.kind);
    r.get(info_.timing);
    r.get(info_.burnedIn);
    r.get(info_.warnings);
    constexpr int kLongestSide = 8192;  // as in dicom_header.cpp
    if (!r.complete() || info_.width < 1 || info_.height < 1 || info_.width > kLongestSide ||
        info_.height > kLongestSide)
      return refuse("breaks its decoder", "It is damaged: export it again.");
    return {};
  }

  int socket_ = -1;
  pid_t child_ = -1;
};
}  // namespace

Result<std::unique_ptr<Study>> openDicom(const StudyDef& def) {
  std::error_code ec;
  const std::uint64_t file_bytes = std::filesystem::file_size(def.path, ec);
  if (ec) return refuse("can't be read", "Check its permissions.");
  if (file_bytes > kLargestFile_bytes)
    return refuse(
        fmt::format("is {} MB, at most {} expected", file_bytes >> 20, kLargestFile_bytes >> 20),
        "Cut out the swallow first.");
  auto study = std::make_unique<DicomStudy>();
  if (auto started = study->start(def, file_bytes); !started)
    return std::unexpected(started.error());
  // all frames once, as for video: a file that breaks later breaks now
  for (int k = 0; k < study->info().frames(); ++k)
    if (auto image = study->frame(k); !image) return std::unexpected(image.error());
  return std::unique_ptr<Study>(std::move(study));
}
}  // namespace swallowclip::study
