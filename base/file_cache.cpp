#include "base/file_cache.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <tuple>
#include <utility>

#include "base/file.h"

namespace panwright {

namespace {

namespace fs = std::filesystem;

// note: numbers as the processor has them; on another kind of processor an entry is not whole
struct Header {
  std::array<char, 8> magic{'P', 'W', 'C', 'A', 'C', 'H', 'E', '1'};
  std::uint64_t size = 0;
  Hash128 key;
  Hash128 checksum;
};
static_assert(sizeof(Header) == 48);

constexpr std::uint64_t kBlock = 4096;
constexpr std::size_t kNameLength = 32;

bool make_folder(const fs::path& folder) {
  std::error_code ignored;
  if (fs::is_directory(folder, ignored)) return true;
  const fs::path parent = folder.parent_path();
  if (!parent.empty() && parent != folder && !make_folder(parent)) return false;
  return mkdir(folder.c_str(), 0700) == 0 || errno == EEXIST;
}

bool read_all(int descriptor, std::span<std::byte> to) {
  while (!to.empty()) {
    const ssize_t got = ::read(descriptor, to.data(), to.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    to = to.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

// The file of an entry, and what a writer without unnamed files calls it meanwhile.
bool is_entry(const std::string& name) {
  return name.size() >= kNameLength &&
         name.find_first_not_of("0123456789abcdef") >= std::min(kNameLength, name.size());
}

}  // namespace

FileCache::FileCache(fs::path folder, std::uint64_t max_bytes)
    : folder_(std::move(folder)), max_bytes_(max_bytes), sum_(max_bytes) {}

std::optional<std::vector<std::byte>> FileCache::find(const Hash128& key) const {
  const fs::path path = folder_ / key.hex();
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
  if (file < 0) return std::nullopt;
  auto entry = [&]() -> std::optional<std::vector<std::byte>> {
    struct stat status {};
    if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode) || status.st_uid != geteuid())
      return std::nullopt;
    const auto bytes = static_cast<std::uint64_t>(status.st_size);
    Header header;
    if (bytes < sizeof header || bytes > max_bytes_ ||
        !read_all(file, std::as_writable_bytes(std::span(&header, 1))))
      return std::nullopt;
    if (header.magic != Header().magic || header.key != key || header.size != bytes - sizeof header)
      return std::nullopt;
    std::vector<std::byte> out(header.size);
    if (!read_all(file, out) || hash128(out) != header.checksum) return std::nullopt;
    // the time of its last use
    futimens(file, nullptr);
    return out;
  }();
  ::close(file);
  return entry;  // moved: a constant would be copied
}

void FileCache::keep(const Hash128& key, std::span<const std::byte> entry) const {
  if (sizeof(Header) + entry.size() > max_bytes_ / 2 || !make_folder(folder_)) return;
  Header header;
  header.size = entry.size();
  header.key = key;
  header.checksum = hash128(entry);
  DiagnosticLog ignored;
  auto file = AtomicFile::create(folder_ / key.hex(), ignored);
  if (!file || !file->write(std::as_bytes(std::span(&header, 1)), ignored) ||
      !file->write(entry, ignored) || !file->publish(ignored))
    return;
  const std::uint64_t size = std::max<std::uint64_t>(kBlock, sizeof header + entry.size());
  constexpr std::uint64_t kLookAfter = 64;
  if (sum_.fetch_add(size) + size > max_bytes_ || ++kept_ % kLookAfter == 0) make_room();
}

void FileCache::make_room() const {
  std::vector<std::tuple<fs::file_time_type, fs::path, std::uint64_t>> entries;
  std::uint64_t sum = 0;
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    std::error_code gone;  // another process may remove it
    if (!is_entry(at->path().filename().string()) || !at->is_regular_file(gone)) continue;
    const std::uint64_t size = std::max<std::uint64_t>(kBlock, at->file_size(gone));
    const fs::file_time_type used = at->last_write_time(gone);
    if (gone) continue;
    entries.emplace_back(used, at->path(), size);
    sum += size;
  }
  sum_ = sum;
  if (sum <= max_bytes_) return;
  std::sort(entries.begin(), entries.end());
  // so much that the next ones have room too
  for (const auto& [used, path, size] : entries) {
    if (sum <= max_bytes_ / 4 * 3) break;
    fs::remove(path, error);
    sum -= size;
  }
  sum_ = sum;
}

}  // namespace panwright
