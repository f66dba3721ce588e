// The layout against what OpenGL and the words of docs/pan-format.md demand.
#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "base/hash.h"
#include "pan/model.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan {
namespace {

using layout::SectionKind;

// The offset that std430 gives the next member: sizes and alignments of OpenGL 4.5, 7.6.2.2.
class Std430 {
 public:
  std::size_t scalar() { return place(4, 4); }
  std::size_t vec4() { return place(16, 16); }
  std::size_t size() const { return (at_ + 15) / 16 * 16; }

 private:
  std::size_t place(std::size_t alignment, std::size_t size) {
    at_ = (at_ + alignment - 1) / alignment * alignment;
    const std::size_t found = at_;
    at_ += size;
    return found;
  }
  std::size_t at_ = 0;
};

// struct Material { vec4 diffuse, specular, emissive, refract, cook, hapke; float oren;
//                   uint diffuse_law, specular_law, flags, name;
//                   int albedo_map, normal_map, roughness_map, cutout_map;
//                   float cutout_threshold, map_repeat[2]; uint reserved[4]; };
TEST(Layout, MaterialIsStd430) {
  using layout::Material;
  Std430 gpu;
  EXPECT_EQ(gpu.vec4(), offsetof(Material, diffuse));
  EXPECT_EQ(gpu.vec4(), offsetof(Material, specular));
  EXPECT_EQ(gpu.vec4(), offsetof(Material, emissive));
  EXPECT_EQ(gpu.vec4(), offsetof(Material, refract));
  EXPECT_EQ(gpu.vec4(), offsetof(Material, cook));
  EXPECT_EQ(gpu.vec4(), offsetof(Material, hapke));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, oren));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, diffuse_law));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, specular_law));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, flags));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, name));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, albedo_map));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, normal_map));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, roughness_map));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, cutout_map));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, cutout_threshold));
  // note: an array of float in std430 is packed by 4
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_EQ(gpu.scalar(), offsetof(Material, map_repeat) + 4 * k);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(gpu.scalar(), offsetof(Material, reserved) + 4 * k);
  EXPECT_EQ(gpu.size(), sizeof(Material));
  // the fourth component of a vec4 is the scalar that stands behind three others
  EXPECT_EQ(offsetof(Material, weight_d), offsetof(Material, diffuse) + 12);
  EXPECT_EQ(offsetof(Material, weight_s), offsetof(Material, specular) + 12);
  EXPECT_EQ(offsetof(Material, weight_e), offsetof(Material, emissive) + 12);
  EXPECT_EQ(offsetof(Material, shine), offsetof(Material, refract) + 12);
}

TEST(Layout, LawsAreNumberedAsInMaterials) {
  using materials::DiffuseLaw;
  using materials::SpecularLaw;
  const auto number = [](auto law) { return static_cast<std::uint32_t>(law); };
  EXPECT_EQ(number(DiffuseLaw::lambert), number(layout::DiffuseLaw::lambert));
  EXPECT_EQ(number(DiffuseLaw::oren_nayar), number(layout::DiffuseLaw::oren_nayar));
  EXPECT_EQ(number(DiffuseLaw::hapke), number(layout::DiffuseLaw::hapke));
  EXPECT_EQ(number(SpecularLaw::none), number(layout::SpecularLaw::none));
  EXPECT_EQ(number(SpecularLaw::blinn_phong), number(layout::SpecularLaw::blinn_phong));
  EXPECT_EQ(number(SpecularLaw::cook_torrance), number(layout::SpecularLaw::cook_torrance));
}

// Reads a number as another language would: byte by byte, at the offsets of docs/pan-format.md.
std::uint64_t little(std::span<const std::byte> bytes, std::size_t at, std::size_t width) {
  std::uint64_t value = 0;
  for (std::size_t k = width; k-- > 0;) value = value << 8 | static_cast<unsigned>(bytes[at + k]);
  return value;
}

TEST(Layout, StrangersCanReadTheFrameOfTheFile) {
  const std::vector<std::byte> file = support::small_pan();
  const unsigned char magic[] = {0x89, 'P', 'A', 'N', '\r', '\n', 0x1a, '\n', 1, 2, 3, 4};
  EXPECT_EQ(std::memcmp(file.data(), magic, sizeof magic), 0);
  EXPECT_EQ(little(file, 12, 2), 1u);
  EXPECT_EQ(little(file, 14, 2), 0u);
  EXPECT_EQ(little(file, 16, 8), 0u);
  EXPECT_EQ(little(file, 32, 8), file.size());
  EXPECT_EQ(little(file, 52, 4), 0x454e4f44u);
  const std::size_t directory = little(file, 40, 8), count = little(file, 48, 4);
  EXPECT_EQ(directory + 64 * count, file.size());
  EXPECT_EQ(little(file, 120, 8), hash64(std::span(file).first(120)));

  // each byte of the file lies in the header, in one section or in the directory
  std::size_t end = 128;
  std::set<std::uint64_t> kinds;
  for (std::size_t e = directory; e < file.size(); e += 64) {
    const std::size_t offset = little(file, e + 8, 8), stored = little(file, e + 16, 8),
                      raw = little(file, e + 24, 8);
    EXPECT_EQ(offset, end);
    EXPECT_EQ(stored % 64, 0u);
    EXPECT_EQ(raw, little(file, e + 32, 8) * little(file, e + 40, 4));
    EXPECT_LT(stored - raw, 64u);
    // all of these are shorter than a block, so their hash is the hash of one hash, or of nothing
    const std::uint64_t inner = hash64(std::span(file).subspan(offset, stored));
    const auto inner_bytes = std::as_bytes(std::span(&inner, stored == 0 ? 0 : 1));
    EXPECT_EQ(little(file, e + 48, 8), hash64(inner_bytes));
    kinds.insert(little(file, e, 4));
    end += stored;
  }
  EXPECT_EQ(end, directory);
  EXPECT_EQ(kinds.size(), layout::kSectionKinds);
}

TEST(Layout, HashOfManyBlocksIsTheHashOfTheirHashes) {
  // one sheet is ten blocks of positions and more
  DiagnosticLog log;
  const auto bytes = write_to_memory(support::large_contents(1));
  const auto model = Model::from_bytes(bytes, "large", log);
  ASSERT_TRUE(model);
  const layout::DirectoryEntry* entry = model->entry(SectionKind::positions);
  ASSERT_GT(entry->stored_length, 3 * layout::kHashBlock);
  std::vector<std::uint64_t> hashes;
  for (std::uint64_t at = 0; at < entry->stored_length; at += 786432)
    hashes.push_back(hash64(std::span(bytes).subspan(
        entry->offset + at, std::min<std::uint64_t>(786432, entry->stored_length - at))));
  EXPECT_EQ(entry->hash, hash64(std::as_bytes(std::span(hashes))));
}

}  // namespace
}  // namespace panwright::pan
