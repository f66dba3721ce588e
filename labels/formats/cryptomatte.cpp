// Cryptomatte 1.2, as of Psyop/Cryptomatte: three layers of two identities with their coverage.
#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>

#include "image/exr.h"
#include "labels/internal/format.h"

namespace panwright::labels {
namespace {

constexpr std::size_t kRanks = 6;

// MurmurHash3_x86_32 by Austin Appleby, seed 0.
std::uint32_t murmur3(std::string_view text) {
  const auto mixed = [](std::uint32_t k) { return std::rotl(k * 0xcc9e2d51u, 15) * 0x1b873593u; };
  const auto byte = [&](std::size_t at) {
    return std::uint32_t{static_cast<unsigned char>(text[at])};
  };
  std::uint32_t hash = 0;
  std::size_t at = 0;
  for (; at + 4 <= text.size(); at += 4) {
    const std::uint32_t k = byte(at) | byte(at + 1) << 8 | byte(at + 2) << 16 | byte(at + 3) << 24;
    hash = std::rotl(hash ^ mixed(k), 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t tail = 0;
  for (std::size_t k = text.size(); k > at; --k) tail = tail << 8 | byte(k - 1);
  hash ^= mixed(tail);
  hash ^= static_cast<std::uint32_t>(text.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

// Bits of a float that is no zero, denormal, infinity or NaN.
std::uint32_t identity_of(std::string_view name) {
  const std::uint32_t hash = murmur3(name), exponent = hash >> 23 & 0xff;
  return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

class CryptomatteWriter final : public LabelWriter {
 public:
  explicit CryptomatteWriter(Output& output) : output_(output) {}

  bool add(const FrameLabels& frame) override {
    std::vector<image::ExrChannel> channels;
    std::vector<std::pair<std::string, std::string>> attributes;
    add_matte(frame, "CryptoObject", true, channels, attributes);
    add_matte(frame, "CryptoPart", false, channels, attributes);
    return image::write_exr_file(output_.folder() / (frame.name + ".cryptomatte.exr"),
                                 frame.camera.width, frame.camera.height, channels, attributes,
                                 output_.log());
  }

  bool finish() override { return true; }

 private:
  using Attributes = std::vector<std::pair<std::string, std::string>>;

  // Of the targets, or of the parts where there are any.
  void add_matte(const FrameLabels& frame, const std::string& matte, bool of_targets,
                 std::vector<image::ExrChannel>& channels, Attributes& attributes) {
    std::vector<const Thing*> things;
    for (const Thing& thing : frame.things)
      if (thing.label.empty() == of_targets) things.push_back(&thing);
    if (things.empty() && !of_targets) return;
    const std::string key =
        "cryptomatte/" + fmt::format("{:08x}", murmur3(matte)).substr(0, 7) + "/";
    nlohmann::ordered_json manifest = nlohmann::ordered_json::object();
    for (const Thing* thing : things) {
      const std::string name = output_.class_of(*thing).name();
      manifest[name] = fmt::format("{:08x}", identity_of(name));
    }
    attributes.insert(attributes.end(), {{key + "name", matte},
                                         {key + "hash", "MurmurHash3_32"},
                                         {key + "conversion", "uint32_to_float32"},
                                         {key + "manifest", manifest.dump()}});
    add_ranks(frame, matte, things, channels);
  }

  void add_ranks(const FrameLabels& frame, const std::string& matte,
                 const std::vector<const Thing*>& things,
                 std::vector<image::ExrChannel>& channels) {
    const std::size_t width = frame.camera.width, size = width * frame.camera.height;
    const std::size_t first = channels.size();
    for (std::size_t k = 0; k < 2 * kRanks; ++k)
      channels.push_back(
          {fmt::format("{}{:02}.{}", matte, k / 4, "rgba"[k % 4]), std::vector<float>(size)});
    std::vector<std::uint8_t> used(size);
    bool too_many = false;
    for (const Thing* thing : things) {
      const auto identity = std::bit_cast<float>(identity_of(output_.class_of(*thing).name()));
      const Mask& mask = thing->visible;
      for (std::size_t j = 0; j < mask.height; ++j)
        for (std::size_t i = 0; i < mask.width; ++i) {
          const std::uint8_t value = mask.coverage[j * mask.width + i];
          if (value == 0) continue;
          const std::size_t at = (mask.top + j) * width + mask.left + i;
          const float coverage = static_cast<float>(value) / 255;
          // by coverage, the largest first
          std::size_t rank = used[at];
          while (rank > 0 && channels[first + 2 * rank - 1].values[at] < coverage) --rank;
          if (used[at] == kRanks) too_many = true;
          if (rank == kRanks) continue;
          for (std::size_t k = std::min<std::size_t>(used[at], kRanks - 1); k > rank; --k)
            for (const std::size_t part : {0, 1})
              channels[first + 2 * k + part].values[at] =
                  channels[first + 2 * k - 2 + part].values[at];
          channels[first + 2 * rank].values[at] = identity;
          channels[first + 2 * rank + 1].values[at] = coverage;
          used[at] = static_cast<std::uint8_t>(std::min<std::size_t>(used[at] + 1u, kRanks));
        }
    }
    if (too_many)
      output_.lost(frame,
                   "of over 6 targets or parts in a pixel those that cover least are left "
                   "out");
  }

  Output& output_;
};

}  // namespace

std::span<const Format> cryptomatte_formats() {
  static const Format kFormats[] = {
      {{"cryptomatte", "NAME.cryptomatte.exr: identities and coverage of each pixel"},
       {true, false},
       make_writer<CryptomatteWriter>}};
  return kFormats;
}

}  // namespace panwright::labels
