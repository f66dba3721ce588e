#include "base/file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/file_uses.h"
#include "base/internal/write_target.h"
#include "base/text.h"

namespace panwright {

namespace {

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  int get() const { return fd_; }

 private:
  int fd_;
};

void report(Code code, const std::filesystem::path& path, const std::string& message,
            SourceSpan where, DiagnosticLog& log, const std::string& hint = {}) {
  if (where.file == kNoFile)
    log.report_file(code, path.string(), message, hint);
  else
    log.report(code, where, message, hint);
}

std::string reason(const char* what, const std::filesystem::path& path, int error) {
  return fmt::format("{} {}: {}", what, in_quotes(path.string()), std::strerror(error));
}

// Where a file that is not there may be: the folder that lacks, or a name that is near.
std::string hint_of_missing(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error))
    return fmt::format("there is no folder {}", in_quotes(folder.string()));
  constexpr std::size_t kMost = 2000;  // of the folder's files
  std::vector<std::string> names;
  for (fs::directory_iterator each(folder, error), end; !error && each != end;
       each.increment(error)) {
    if (names.size() == kMost) return {};
    names.push_back(each->path().filename().string());
  }
  std::ranges::sort(names);  // note: the order of a folder is the file system's
  const std::vector<std::string_view> known(names.begin(), names.end());
  const auto near = nearest_name(path.filename().string(), known);
  return near ? fmt::format("did you mean {}?",
                            in_quotes((path.parent_path() / fs::path(*near)).string()))
              : std::string();
}

void report_missing(const std::filesystem::path& path, int error, SourceSpan where,
                    DiagnosticLog& log) {
  report(Code("E0101"), path, reason("cannot open", path, error), where, log,
         error == ENOENT ? hint_of_missing(path) : std::string());
}

int open_for_reading(const std::filesystem::path& path) {
  // note: O_NONBLOCK because nothing cancels an open() that waits for the writer of a named pipe
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd >= 0 || errno != ENXIO) return fd;
  // a stream that is a socket has no name that opens it
  const int stream = internal::write_target(path).stream;
  errno = ENXIO;
  return stream < 0 ? -1 : fcntl(stream, F_DUPFD_CLOEXEC, 0);
}

// Waits for bytes or the end of a pipe, from its first writer on. False: cancelled.
bool wait_for_bytes(int fd, const FileUses* files) {
  constexpr int kMilliseconds = 100;  // signals do not always end poll(), and may come before it
  pollfd input{fd, POLLIN, 0};
  do {
    if (files && files->cancelled()) return false;
  } while (poll(&input, 1, kMilliseconds) <= 0);
  return true;
}

bool write_all(int fd, std::span<const std::byte> bytes, std::uint64_t offset, bool positioned,
               int* error) {
  while (!bytes.empty()) {
    const std::size_t piece = std::min<std::size_t>(bytes.size(), 1u << 30);
    const ssize_t done = positioned ? ::pwrite(fd, bytes.data(), piece, static_cast<off_t>(offset))
                                    : ::write(fd, bytes.data(), piece);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) {
      *error = done < 0 ? errno : ENOSPC;
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
  return true;
}

bool write_stream(int fd, const std::filesystem::path& path, std::span<const std::byte> bytes,
                  DiagnosticLog& log) {
  int error = 0;
  if (write_all(fd, bytes, 0, false, &error)) return true;
  log.report_file(Code("E0103"), path.string(), reason("cannot write", path, error));
  return false;
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

}  // namespace

bool require_file(const std::filesystem::path& path, DiagnosticLog& log) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_directory(status)) return true;
  report_missing(path,
                 std::filesystem::is_directory(status) ? EISDIR
                 : error                               ? error.value()
                                                       : ENOENT,
                 {}, log);
  return false;
}

Result<std::string> read_file(const std::filesystem::path& path, std::uint64_t max_bytes,
                              DiagnosticLog& log, SourceSpan where) {
  const Descriptor fd(open_for_reading(path));
  struct stat status {};
  if (fd.get() < 0 || fstat(fd.get(), &status) != 0) {
    report_missing(path, errno, where, log);
    return failed;
  }
  if (S_ISDIR(status.st_mode)) {
    report(Code("E0101"), path, reason("cannot open", path, EISDIR), where, log);
    return failed;
  }
  if (log.files()) log.files()->was_opened(fd.get(), path);
  const auto too_large = [&](std::uint64_t size, const char* at_least) {
    report(Code("E0104"), path,
           fmt::format("{} is {}{} bytes long, expected at most {}", in_quotes(path.string()),
                       at_least, size, max_bytes),
           where, log);
  };
  if (S_ISREG(status.st_mode) && static_cast<std::uint64_t>(status.st_size) > max_bytes) {
    too_large(static_cast<std::uint64_t>(status.st_size), "");
    return failed;
  }
  std::string text;
  constexpr std::size_t kPiece = 1u << 20;
  constexpr std::size_t kLeastRoom = 4096;
  // note: with room for the reading that finds the end, so that the text need not move for it
  if (S_ISREG(status.st_mode)) text.reserve(static_cast<std::size_t>(status.st_size) + kLeastRoom);
  for (;;) {
    if (!S_ISREG(status.st_mode) && !wait_for_bytes(fd.get(), log.files().get())) {
      report_cancelled(log);
      return failed;
    }
    const std::size_t before = text.size();
    const std::size_t room = std::max(text.capacity() - before, kLeastRoom);
    text.resize(before + std::min(room, kPiece));
    const ssize_t got = ::read(fd.get(), text.data() + before, text.size() - before);
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) {
      text.resize(before);
      continue;
    }
    if (got < 0) {
      report(Code("E0102"), path, reason("cannot read", path, errno), where, log);
      return failed;
    }
    text.resize(before + static_cast<std::size_t>(got));
    if (got == 0) break;
    if (text.size() > max_bytes) {
      too_large(text.size(), "more than ");
      return failed;
    }
  }
  return text;
}

Result<MappedFile> MappedFile::open(const std::filesystem::path& path, DiagnosticLog& log) {
  const Descriptor fd(open_for_reading(path));
  struct stat status {};
  if (fd.get() < 0 || fstat(fd.get(), &status) != 0) {
    report_missing(path, errno, {}, log);
    return failed;
  }
  if (!S_ISREG(status.st_mode)) {
    log.report_file(
        Code("E0101"), path.string(),
        S_ISDIR(status.st_mode)
            ? reason("cannot open", path, EISDIR)
            : fmt::format("{} is a pipe or a device, expected a file", in_quotes(path.string())));
    return failed;
  }
  if (log.files()) log.files()->was_opened(fd.get(), path);
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return MappedFile(nullptr, 0);
  void* data = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd.get(), 0);
  if (data == MAP_FAILED) {
    log.report_file(Code("E0102"), path.string(), reason("cannot map", path, errno));
    return failed;
  }
  return MappedFile(static_cast<const std::byte*>(data), size);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

MappedFile::~MappedFile() {
  if (data_) munmap(const_cast<std::byte*>(data_), size_);
}

void MappedFile::release(std::span<const std::byte> part) const {
  static const auto kPage = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto from = reinterpret_cast<std::uintptr_t>(part.data());
  const std::uintptr_t begin = (from + kPage - 1) / kPage * kPage;
  const std::uintptr_t end = (from + part.size()) / kPage * kPage;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
}

Result<AtomicFile> AtomicFile::create(const std::filesystem::path& path, DiagnosticLog& log) {
  if (log.files() && !log.files()->may_write(path, log)) return failed;
  AtomicFile file;
  // a symbolic link keeps pointing: its target is what gets replaced
  file.path_ = internal::write_target(path).path;
  // rename would put a plain file into the place of a device or a pipe
  struct stat target {};
  if (stat(file.path_.c_str(), &target) == 0 && !S_ISREG(target.st_mode)) {
    const int error = S_ISDIR(target.st_mode) ? EISDIR : EINVAL;
    log.report_file(Code("E0103"), path.string(),
                    reason("not a regular file, cannot replace", path, error));
    return failed;
  }
  // a file without a name is gone with the process that writes it, however that ends
  const std::string folder = folder_of(file.path_).string();
  if (access("/proc/self/fd", X_OK) == 0)
    file.descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (file.descriptor_ < 0 && !file.create_named()) {
    log.report_file(Code("E0103"), path.string(), reason("cannot write", path, errno));
    return failed;
  }
  if (target.st_nlink > 0) fchmod(file.descriptor_, target.st_mode & 07777);
  return file;
}

// Where the file system, or the lack of /proc, allows no file without a name.
bool AtomicFile::create_named() {
  std::string name = path_.string() + ".XXXXXX";
  descriptor_ = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) return false;
  temporary_ = name;
  // mkostemp makes private files; give the mode that a plain open would have given
  const mode_t mask = umask(0);
  umask(mask);
  fchmod(descriptor_, 0666 & ~mask);
  return true;
}

// A name for what has none: rename, unlike a link, replaces a file.
bool AtomicFile::give_name() {
  const std::string unnamed = fmt::format("/proc/self/fd/{}", descriptor_);
  static std::atomic<unsigned> counter{0};
  constexpr int kMostTries = 100;
  for (int i = 0; i < kMostTries; ++i) {
    const std::string name = fmt::format("{}.{}-{}", path_.string(), getpid(), counter++);
    if (linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      temporary_ = name;
      return true;
    }
    if (errno != EEXIST) return false;
  }
  return false;
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_),
      path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, {})) {}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

bool AtomicFile::fail(const char* action, int error, DiagnosticLog& log) {
  log.report_file(Code("E0103"), path_.string(), reason(action, path_, error));
  return false;
}

bool AtomicFile::write(std::span<const std::byte> bytes, DiagnosticLog& log) {
  int error = 0;
  if (!write_all(descriptor_, bytes, 0, false, &error)) return fail("cannot write", error, log);
  size_ += bytes.size();
  return true;
}

bool AtomicFile::extend(std::uint64_t length, DiagnosticLog& log) {
  constexpr std::uint64_t kMost = std::numeric_limits<off_t>::max();
  if (length > kMost - size_) return fail("cannot write", EFBIG, log);
  // note: a file system may fill itself up before it says that there is no room
  struct statvfs room {};
  if (fstatvfs(descriptor_, &room) == 0 && length / room.f_frsize > room.f_bavail)
    return fail("cannot write", ENOSPC, log);
  const auto begin = static_cast<off_t>(size_), end = static_cast<off_t>(size_ + length);
  const bool taken =
      length == 0 || fallocate(descriptor_, 0, begin, static_cast<off_t>(length)) == 0;
  if (!taken && errno != EOPNOTSUPP && errno != ENOSYS) return fail("cannot write", errno, log);
  if ((!taken && ftruncate(descriptor_, end) != 0) || lseek(descriptor_, end, SEEK_SET) != end)
    return fail("cannot write", errno, log);
  size_ += length;
  return true;
}

bool AtomicFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes,
                          DiagnosticLog& log) {
  int error = 0;
  if (!write_all(descriptor_, bytes, offset, true, &error)) return fail("cannot write", error, log);
  return true;
}

Result<MappedFile> AtomicFile::map(DiagnosticLog& log) const {
  const auto size = static_cast<std::size_t>(size_);
  if (size == 0) return MappedFile(nullptr, 0);
  void* data = mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor_, 0);
  if (data == MAP_FAILED) {
    log.report_file(Code("E0102"), path_.string(), reason("cannot map", path_, errno));
    return failed;
  }
  return MappedFile(static_cast<const std::byte*>(data), size);
}

bool AtomicFile::commit(DiagnosticLog& log, double* sync_seconds) {
  const auto start = std::chrono::steady_clock::now();
  if (fsync(descriptor_) != 0) return fail("cannot sync", errno, log);
  if (!publish(log)) return false;
  // the folder's entry is durable only when the folder is synced; some file systems cannot
  const Descriptor fd(::open(folder_of(path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0) fsync(fd.get());
  if (sync_seconds) *sync_seconds += seconds_since(start);
  return true;
}

bool AtomicFile::publish(DiagnosticLog& log) {
  if (temporary_.empty() && !give_name()) return fail("cannot link", errno, log);
  if (close(std::exchange(descriptor_, -1)) != 0) return fail("cannot close", errno, log);
  if (rename(temporary_.c_str(), path_.c_str()) != 0) return fail("cannot rename to", errno, log);
  temporary_.clear();
  return true;
}

bool write_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                DiagnosticLog& log, double* sync_seconds) {
  if (path == "-") return write_stream(STDOUT_FILENO, path, bytes, log);
  const internal::WriteTarget target = internal::write_target(path);
  if (target.stream >= 0) return write_stream(target.stream, path, bytes, log);
  struct stat status {};
  if (stat(target.path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) &&
      !S_ISDIR(status.st_mode)) {
    const Descriptor fd(::open(target.path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    if (fd.get() >= 0) return write_stream(fd.get(), path, bytes, log);
    log.report_file(Code("E0103"), path.string(), reason("cannot open", path, errno));
    return false;
  }
  auto file = AtomicFile::create(path, log);
  return file && file->write(bytes, log) && file->commit(log, sync_seconds);
}

}  // namespace panwright
