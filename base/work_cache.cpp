#include "base/work_cache.h"

#include <elf.h>
#include <link.h>

#include <algorithm>
#include <cstring>

namespace panwright {

namespace {

// Libraries beside the program that have a say in numbers.
constexpr std::string_view kLibraries[] = {"libpanwright", "libmeshoptimizer", "libembree",
                                           "libOpenMesh",  "libsleef",         "libm.so"};

struct Search {
  KeyHasher hasher;
  bool found = false;  // that of this code
};

bool holds(const dl_phdr_info& object, const void* address) {
  const auto at = reinterpret_cast<std::uintptr_t>(address);
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const auto& part = object.dlpi_phdr[i];
    const std::uintptr_t begin = object.dlpi_addr + part.p_vaddr;
    if (part.p_type == PT_LOAD && at >= begin && at - begin < part.p_memsz) return true;
  }
  return false;
}

// The build id of an object (the linker's note of type NT_GNU_BUILD_ID); empty: none.
std::span<const std::byte> build_id(const dl_phdr_info& object) {
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const auto& part = object.dlpi_phdr[i];
    if (part.p_type != PT_NOTE) continue;
    const auto* at = reinterpret_cast<const std::byte*>(object.dlpi_addr + part.p_vaddr);
    std::span<const std::byte> left(at, part.p_memsz);
    const std::size_t alignment = part.p_align == 8 ? 8 : 4;
    const auto aligned = [&](std::size_t n) { return (n + alignment - 1) / alignment * alignment; };
    ElfW(Nhdr) note;
    while (left.size() >= sizeof note) {
      std::memcpy(&note, left.data(), sizeof note);
      const std::size_t name = sizeof note, content = aligned(name + note.n_namesz);
      const std::size_t end = content + note.n_descsz;
      if (end > left.size()) break;
      if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 &&
          std::memcmp(left.data() + name, "GNU", 4) == 0)
        return left.subspan(content, note.n_descsz);
      left = left.subspan(std::min(aligned(end), left.size()));
    }
  }
  return {};
}

int visit(dl_phdr_info* object, std::size_t, void* data) {
  Search& search = *static_cast<Search*>(data);
  const std::string_view path(object->dlpi_name ? object->dlpi_name : "");
  const std::string_view name = path.substr(path.rfind('/') + 1);
  const bool own = holds(*object, reinterpret_cast<const void*>(&program_identity));
  const bool counts = std::any_of(std::begin(kLibraries), std::end(kLibraries),
                                  [&](std::string_view each) { return name.starts_with(each); });
  if (!own && !counts) return 0;
  const auto id = build_id(*object);
  search.hasher.list(id);
  search.found = search.found || (own && !id.empty());
  return 0;
}

}  // namespace

std::string_view work_name(Work work) {
  constexpr std::string_view kNames[kWorks] = {"meshes", "levels", "simplified", "foil", "cleaned"};
  return kNames[static_cast<std::size_t>(work)];
}

void WorkCounts::add(const WorkCounts& other) {
  for (std::size_t i = 0; i < kWorks; ++i) {
    of[i].reused += other.of[i].reused;
    of[i].made += other.of[i].made;
  }
}

WorkCounts::Count WorkCounts::all() const {
  Count sum;
  for (const Count& each : of) {
    sum.reused += each.reused;
    sum.made += each.made;
  }
  return sum;
}

std::optional<Hash128> program_identity() {
  static const std::optional<Hash128> identity = [] {
    Search search;
    dl_iterate_phdr(visit, &search);
    return search.found ? std::optional(search.hasher.key()) : std::nullopt;
  }();
  return identity;
}

WorkCache::WorkCache(std::filesystem::path folder, std::uint64_t max_bytes)
    : files_(std::move(folder), max_bytes), most_(max_bytes / 2), program_(program_identity()) {}

Hash128 WorkCache::whole_key(Work work, const Hash128& key) const {
  KeyHasher hasher;
  hasher.hash(*program_);
  hasher.number(static_cast<std::uint64_t>(work));
  hasher.hash(key);
  return hasher.key();
}

std::optional<std::vector<std::byte>> WorkCache::find(Work work, const Hash128& key) const {
  return program_ ? files_.find(whole_key(work, key)) : std::nullopt;
}

void WorkCache::keep(Work work, const Hash128& key, std::span<const std::byte> bytes) const {
  if (!program_) return;
  if (kept_.fetch_add(bytes.size()) + bytes.size() > most_) {
    kept_ -= bytes.size();  // a smaller one may have room
    return;
  }
  files_.keep(whole_key(work, key), bytes);
}

void WorkCache::count(Work work, bool reused) const {
  if (const auto i = static_cast<std::size_t>(work); i < kWorks) ++(reused ? reused_ : made_)[i];
}

WorkCounts WorkCache::counts() const {
  WorkCounts out;
  for (std::size_t i = 0; i < kWorks; ++i) out.of[i] = {reused_[i], made_[i]};
  return out;
}

}  // namespace panwright
