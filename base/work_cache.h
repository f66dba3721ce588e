// Cache of long compilation work between runs, keyed by all inputs of a result.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/file_cache.h"
#include "base/hash.h"

namespace panwright {

// Kinds of cached work.
enum class Work : std::uint8_t {
  meshes,      // triangles for exact shapes
  levels,      // levels of detail of meshes
  simplified,  // meshes that a budget lets be coarser
  foil,        // sheets and blankets, with their levels
  cleaned,     // meshes of CAD files
  // not counted:
  hidden,     // searches for hidden triangles
  fits,       // of materials
  imports,    // CAD files, compiled
  transport,  // light between surfaces
};
inline constexpr std::size_t kWorks = 5;  // counted
std::string_view work_name(Work work);    // "meshes"

// Numbers of results read from a cache and computed. Work faster than its reading is not cached and
// not counted.
struct WorkCounts {
  struct Count {
    std::uint64_t reused = 0;
    std::uint64_t made = 0;
  };
  std::array<Count, kWorks> of{};

  const Count& operator[](Work work) const { return of[static_cast<std::size_t>(work)]; }
  void add(const WorkCounts& other);
  Count all() const;
};

// Returns the identities that the linker gave to the program and to the libraries that decide
// numbers. Nothing: they have none.
std::optional<Hash128> program_identity();

// A FileCache of results. Keys include the kind of work and program_identity(): another build
// computes its own results, and without an identity nothing is kept. No result depends on the
// cache: an entry is the same program's result for the same numbers.
class WorkCache {
 public:
  static constexpr std::uint64_t kMostBytes = 1ull << 30;

  // max_bytes: of the folder (FileCache). One WorkCache keeps half of it at most, so that a larger
  // model does not drive out everything, itself included.
  explicit WorkCache(std::filesystem::path folder, std::uint64_t max_bytes = kMostBytes);

  std::optional<std::vector<std::byte>> find(Work work, const Hash128& key) const;
  void keep(Work work, const Hash128& key, std::span<const std::byte> bytes) const;

  // Returns a result. Nothing: absent or not valid.
  //
  //   read  (ByteReader&) → T, unverified; fail() marks it invalid
  template <class T, class Read>
  std::optional<T> recall(Work work, const Hash128& key, Read&& read) const {
    const auto bytes = find(work, key);
    if (!bytes) return std::nullopt;
    ByteReader reader(*bytes);
    std::optional<T> found(std::in_place, read(reader));
    if (!reader.at_end()) found.reset();
    return found;
  }

  // Stores a result.
  //
  //   write  (const T&, ByteWriter&) → nothing, or false to store nothing
  template <class T, class Write>
  void store(Work work, const Hash128& key, const T& result, Write&& write) const {
    ByteWriter writer;
    if constexpr (std::is_void_v<std::invoke_result_t<Write&, const T&, ByteWriter&>>)
      write(result, writer);
    else if (!write(result, writer))
      return;
    keep(work, key, writer.bytes());
  }

  void count(Work work, bool reused) const;
  WorkCounts counts() const;

 private:
  Hash128 whole_key(Work work, const Hash128& key) const;
  FileCache files_;
  std::uint64_t most_;
  std::optional<Hash128> program_;
  mutable std::atomic<std::uint64_t> kept_ = 0;
  mutable std::array<std::atomic<std::uint64_t>, kWorks> reused_{}, made_{};
};

// Returns a result from the cache; else computes and stores it.
//
//   cache  null: none
//   key    () → Hash128, of all that the result depends on
//   make   () → std::optional<T>; nothing: it failed, which is not kept
//   write, read  as of WorkCache
template <class T, class Key, class Make, class Write, class Read>
std::optional<T> remember(const WorkCache* cache, Work work, Key&& key, Make&& make, Write&& write,
                          Read&& read) {
  if (cache == nullptr) return make();
  const Hash128 name = key();
  std::optional<T> result = cache->recall<T>(work, name, read);
  cache->count(work, result.has_value());
  if (result) return result;
  result = make();
  if (result) cache->store(work, name, *result, write);
  return result;
}

}  // namespace panwright
