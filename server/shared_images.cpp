#include "server/shared_images.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>

namespace panwright::server {

namespace {

using namespace shared;

constexpr const char* kFolder = "/dev/shm";
constexpr std::string_view kPrefix = "panwright-";

constexpr std::uint64_t aligned(std::uint64_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

std::uint64_t slot_bytes_of(std::span<const SharedLayer> layers) {
  std::uint64_t out = aligned(sizeof(Slot));
  for (const SharedLayer& layer : layers) out += aligned(layer.bytes.size());
  return out;
}

// Readers may see it at any time.
void publish(std::uint64_t& word, std::uint64_t value, std::memory_order order) {
  std::atomic_ref<std::uint64_t>(word).store(value, order);
}

}  // namespace

struct SharedImages::Segment {
  std::string name;
  int file = -1;
  std::byte* memory = nullptr;
  std::uint64_t bytes = 0;
  std::uint64_t slot_bytes = 0;
  std::uint64_t last = 0;  // image

  Header& header() { return *reinterpret_cast<Header*>(memory); }
  static constexpr std::uint64_t first_slot() { return aligned(sizeof(Header)); }

  ~Segment() {
    if (memory != nullptr) ::munmap(memory, bytes);
    if (file < 0) return;
    ::shm_unlink(name.c_str());
    ::close(file);
  }

  // False: errno says why.
  bool open(std::uint64_t bytes_of_slot) {
    static std::atomic<unsigned> count{0};
    slot_bytes = bytes_of_slot;
    bytes = first_slot() + kSlots * slot_bytes;
    constexpr mode_t kOwner = 0600;
    for (;;) {
      name = fmt::format("/{}{}-{}", kPrefix, ::getpid(), ++count);
      file = ::shm_open(name.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, kOwner);
      if (file < 0 && errno != EEXIST) return false;
      if (file < 0) continue;
      // remove_left_over() of another server may come before the lock
      struct stat info {};
      if (::flock(file, LOCK_EX | LOCK_NB) == 0 && ::fstat(file, &info) == 0 && info.st_nlink > 0)
        break;
      ::close(file);
    }
    // memory that is not there must fail here, not when it is written
    if (const int error = ::posix_fallocate(file, 0, static_cast<off_t>(bytes)); error != 0) {
      errno = error;
      return false;
    }
    void* const mapped =
        ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file, 0);
    if (mapped == MAP_FAILED) return false;
    memory = static_cast<std::byte*>(mapped);
    Header& head = header();
    head.slots = kSlots;
    head.slot_bytes = slot_bytes;
    head.first_slot = first_slot();
    std::memcpy(head.magic, kMagic, sizeof kMagic);
    return true;
  }
};

SharedImages::SharedImages() = default;
SharedImages::~SharedImages() = default;

Result<SharedImages::Place> SharedImages::write(std::uint32_t width, std::uint32_t height,
                                                std::span<const SharedLayer> layers,
                                                DiagnosticLog& log) {
  const std::uint64_t needed = slot_bytes_of(layers);
  if (segment_ == nullptr || segment_->slot_bytes < needed) {
    segment_.reset();
    auto made = std::make_unique<Segment>();
    if (!made->open(needed)) {
      log.report_file(Code("E0103"), made->name,
                      fmt::format("{} bytes of shared memory are not given: {}", made->bytes,
                                  std::strerror(errno)),
                      fmt::format("more room in {}, fewer layers or a smaller image", kFolder));
      return failed;
    }
    segment_ = std::move(made);
  }
  Segment& segment = *segment_;
  Place place{segment.name, ++segment.last, 0, {}};
  place.slot = static_cast<std::uint32_t>(place.number % kSlots);
  const std::uint64_t begin = segment.first_slot() + place.slot * segment.slot_bytes;
  std::byte* const at = segment.memory + begin;
  Slot& slot = *reinterpret_cast<Slot*>(at);
  publish(slot.sequence, 2 * place.number - 1, std::memory_order_relaxed);
  // no write below may be seen before this one
  std::atomic_thread_fence(std::memory_order_release);
  slot.width = width;
  slot.height = height;
  slot.layers = static_cast<std::uint32_t>(layers.size());
  std::uint64_t offset = aligned(sizeof(Slot));
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const SharedLayer& from = layers[i];
    Layer layer{
        {}, static_cast<std::uint32_t>(from.type), from.channels, offset, from.bytes.size()};
    from.name.copy(layer.name, sizeof layer.name - 1);
    slot.layer[i] = layer;
    std::memcpy(at + offset, from.bytes.data(), from.bytes.size());
    place.offsets.push_back(begin + offset);
    offset += aligned(from.bytes.size());
  }
  publish(slot.sequence, 2 * place.number, std::memory_order_release);
  publish(segment.header().newest, place.number, std::memory_order_release);
  return place;
}

std::size_t SharedImages::remove_left_over() {
  std::size_t removed = 0;
  DIR* const folder = ::opendir(kFolder);
  if (folder == nullptr) return 0;
  while (const dirent* entry = ::readdir(folder)) {
    const std::string_view name = entry->d_name;
    if (!name.starts_with(kPrefix)) continue;
    const std::string path = "/" + std::string(name);
    const int file = ::shm_open(path.c_str(), O_RDWR | O_CLOEXEC, 0);
    if (file < 0) continue;
    struct stat info {};
    const bool own = ::fstat(file, &info) == 0 && info.st_uid == ::geteuid();
    // the lock of a server goes with it
    if (own && ::flock(file, LOCK_EX | LOCK_NB) == 0 && ::shm_unlink(path.c_str()) == 0) ++removed;
    ::close(file);
  }
  ::closedir(folder);
  return removed;
}

}  // namespace panwright::server
