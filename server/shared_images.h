// Images in POSIX shared memory, for clients on the same machine (docs/json-lines.md).
//
// A segment is a header, and slots of one size, which image n = 1, 2, … takes in turn. Numbers have
// the order of bytes of the machine. The sequence of a slot is 2n - 1 while image n is written and
// 2n when it is whole: a reader that finds 2n before and after its copy has image n and no other.
// A segment stays locked by flock() while its server lives; its name goes with the object, or with
// remove_left_over() of a later server where this one was killed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"

namespace panwright::server {

namespace shared {

constexpr char kMagic[8] = {'P', 'W', 'I', 'M', 'A', 'G', 'E', '1'};
constexpr std::uint32_t kSlots = 2;
constexpr std::size_t kMostLayers = 16;
constexpr std::size_t kAlignment = 64;  // of slots and of layers, bytes

enum class NumberType : std::uint32_t { float32 = 0, uint32 = 1, uint16 = 2 };

struct Header {
  char magic[8];
  std::uint32_t slots;
  std::uint32_t spare;
  std::uint64_t slot_bytes;
  std::uint64_t first_slot;  // bytes from the begin of the segment
  std::uint64_t newest;      // number of the newest whole image; 0: none
};

struct Layer {
  char name[24];  // ends with zeros
  std::uint32_t type;
  std::uint32_t channels;
  std::uint64_t offset;  // bytes from the begin of its slot
  std::uint64_t bytes;
};

struct Slot {
  std::uint64_t sequence;
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t layers;
  std::uint32_t spare;
  Layer layer[kMostLayers];
};

}  // namespace shared

// Layer of an image to be shared: rows from the top, channels of a pixel beside each other.
struct SharedLayer {
  std::string_view name;
  shared::NumberType type = shared::NumberType::float32;
  std::uint32_t channels = 1;
  std::span<const std::byte> bytes;
};

class SharedImages {
 public:
  // Place of a written image.
  struct Place {
    std::string name;          // of the segment, as "/panwright-12-1"
    std::uint64_t number = 0;  // of the image there, from 1
    std::uint32_t slot = 0;
    std::vector<std::uint64_t> offsets;  // of each layer, bytes from the begin of the segment
  };

  SharedImages();
  ~SharedImages();
  SharedImages(const SharedImages&) = delete;
  SharedImages& operator=(const SharedImages&) = delete;

  // Copies an image into the next slot. One that is larger than the slots begins a new segment, of
  // another name; the old one goes when its readers close it.
  // Expects: at most kMostLayers layers, names below 24 bytes.
  // Fails: E0103 where the memory is not given.
  Result<Place> write(std::uint32_t width, std::uint32_t height,
                      std::span<const SharedLayer> layers, DiagnosticLog& log);

  // Removes segments of this user whose servers are gone. Returns how many.
  static std::size_t remove_left_over();

 private:
  struct Segment;
  std::unique_ptr<Segment> segment_;
};

}  // namespace panwright::server
