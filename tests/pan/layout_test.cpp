// The layout against what OpenGL and the words of docs/pan-format.md demand.
#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "base/hash.h"
#include "pan/model.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::layout_test {
namespace {

using layout::SectionKind;

// The offset that std430 gives the next member: sizes and alignments of OpenGL 4.5, 7.6.2.2.
class Std430 {
 public:
  std::size_t scalar() { return place(4, 4); }
  std::size_t vec2() { return place(8, 8); }
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

// struct Material { vec4 diffuse, specular, emissive, refract, extinction, cook, hapke, grains;
//                   float porosity, oren, coat_index, coat_alpha;
//                   vec4 coat_depth, coat_return, compensation_scale, loss[2], hapke_h[2];
//                   uint diffuse_brdf, specular_brdf, compensation, variant, name; float fit_error;
//                   uint flags; float cutout_threshold;
//                   int albedo_map, normal_map, roughness_map, cutout_map;
//                   vec2 map_repeat, cell_count, cell_gap; float fingers, finger_width;
//                   vec4 gap_color, finger_color, reflectance; };
TEST(Layout, MaterialIsStd430) {
  using layout::Material;
  Std430 gpu;
  for (const std::size_t at :
       {offsetof(Material, diffuse), offsetof(Material, specular), offsetof(Material, emissive),
        offsetof(Material, refract), offsetof(Material, extinction), offsetof(Material, cook),
        offsetof(Material, hapke), offsetof(Material, grains)})
    EXPECT_EQ(gpu.vec4(), at);
  for (const std::size_t at : {offsetof(Material, porosity), offsetof(Material, oren),
                               offsetof(Material, coat_index), offsetof(Material, coat_alpha)})
    EXPECT_EQ(gpu.scalar(), at);
  for (const std::size_t at :
       {offsetof(Material, coat_depth), offsetof(Material, coat_return),
        offsetof(Material, compensation_scale), offsetof(Material, albedo_deficit),
        offsetof(Material, albedo_deficit) + 16, offsetof(Material, hapke_h),
        offsetof(Material, hapke_h) + 16})
    EXPECT_EQ(gpu.vec4(), at);
  for (const std::size_t at : {offsetof(Material, diffuse_brdf), offsetof(Material, specular_brdf),
                               offsetof(Material, compensation), offsetof(Material, variant),
                               offsetof(Material, name), offsetof(Material, fit_error),
                               offsetof(Material, flags), offsetof(Material, cutout_threshold),
                               offsetof(Material, albedo_map), offsetof(Material, normal_map),
                               offsetof(Material, roughness_map), offsetof(Material, cutout_map)})
    EXPECT_EQ(gpu.scalar(), at);
  for (const std::size_t at : {offsetof(Material, map_repeat), offsetof(Material, cell_count),
                               offsetof(Material, cell_gap)})
    EXPECT_EQ(gpu.vec2(), at);
  EXPECT_EQ(gpu.scalar(), offsetof(Material, fingers));
  EXPECT_EQ(gpu.scalar(), offsetof(Material, finger_width));
  EXPECT_EQ(gpu.vec4(), offsetof(Material, gap_color));
  EXPECT_EQ(gpu.vec4(), offsetof(Material, finger_color));
  EXPECT_EQ(gpu.vec4(), offsetof(Material, reflectance));
  EXPECT_EQ(gpu.size(), sizeof(Material));
  // the fourth component of a vec4 is the scalar that stands behind three others
  const std::pair<std::size_t, std::size_t> fourth[] = {
      {offsetof(Material, weight_d), offsetof(Material, diffuse)},
      {offsetof(Material, weight_s), offsetof(Material, specular)},
      {offsetof(Material, weight_e), offsetof(Material, emissive)},
      {offsetof(Material, shine), offsetof(Material, refract)},
      {offsetof(Material, alpha_y), offsetof(Material, extinction)},
      {offsetof(Material, hapke_k), offsetof(Material, coat_depth)},
      {offsetof(Material, tilt_u), offsetof(Material, coat_return)},
      {offsetof(Material, tilt_v), offsetof(Material, compensation_scale)},
      {offsetof(Material, reflectance_map), offsetof(Material, finger_color)}};
  for (const auto& [scalar, vector] : fourth) EXPECT_EQ(scalar, vector + 12);
}

// Files have these numbers.
TEST(Layout, ModelsKeepTheirNumbers) {
  using materials::DiffuseModel;
  using materials::SpecularModel;
  const auto number = [](auto law) { return static_cast<std::uint32_t>(law); };
  EXPECT_EQ(number(DiffuseModel::lambert), 0u);
  EXPECT_EQ(number(DiffuseModel::oren_nayar), 1u);
  EXPECT_EQ(number(DiffuseModel::hapke), 2u);
  EXPECT_EQ(number(DiffuseModel::eon), 3u);
  EXPECT_EQ(number(DiffuseModel::lommel_seeliger), 4u);
  EXPECT_EQ(number(SpecularModel::beckmann), 3u);
  EXPECT_EQ(number(SpecularModel::ggx), 4u);
  EXPECT_EQ(number(SpecularModel::mirror), 5u);
  EXPECT_EQ(number(SpecularModel::none), 0u);
  EXPECT_EQ(number(SpecularModel::blinn_phong), 1u);
  EXPECT_EQ(number(SpecularModel::cook_torrance), 2u);
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
  EXPECT_EQ(kinds.size(), support::kSampleSections);
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
}  // namespace panwright::pan::layout_test
