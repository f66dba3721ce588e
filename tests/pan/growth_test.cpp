// Records of other sizes than this program's: tails are ignored, what is lacking has its default.
#include <gtest/gtest.h>

#include <cstring>

#include "pan/diff.h"
#include "pan/internal/unpack.h"
#include "pan/model.h"
#include "tests/pan/load.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::growth_test {
namespace {

using layout::FieldDefault;
using layout::FieldType;
using layout::SectionKind;

TEST(Growth, TailsOfLongerRecordsAreIgnored) {
  const Model known = load(support::small_pan());
  for (const layout::SectionInfo& info : layout::kSections) {
    if (!info.table || !known.entry(info.kind)) continue;
    for (const std::uint32_t more :
         {info.alignment, 64u, 4096u / info.alignment * info.alignment - info.stride}) {
      support::OpenPan file(support::small_pan());
      file.restride_section(info.kind, info.stride + more);
      const Model model = load(file.seal().bytes());
      SCOPED_TRACE(info.name);
      EXPECT_EQ(model.entry(info.kind)->stride, info.stride + more);
      EXPECT_TRUE(std::ranges::equal(model.section(info.kind), known.section(info.kind)));
      EXPECT_EQ(model.unpacked_bytes(), known.section(info.kind).size());
      const Differences differences = diff(known, model);
      EXPECT_TRUE(differences.same_model() && differences.provenance.empty());
      EXPECT_EQ(differences.storage.size(), 2u);  // the section, and the format's version
    }
  }
}

TEST(Growth, AllTablesAtOnce) {
  const Model known = load(support::small_pan());
  support::OpenPan file(support::small_pan());
  for (const layout::SectionInfo& info : layout::kSections)
    if (info.table && known.entry(info.kind))
      file.restride_section(info.kind, info.stride + 8 * info.alignment);
  const Model model = load(file.seal().bytes());
  EXPECT_TRUE(diff(known, model).same_model());
  EXPECT_EQ(model.mesh(1).colors[1].y, 1.0f);
}

TEST(Growth, LongerRecordsAreCompressedToo) {
  support::OpenPan plain(write_to_memory(support::regular_contents()));
  plain.restride_section(SectionKind::nodes, 120);
  DiagnosticLog log;
  // the same records through the writer, which does not know what they mean
  Writer writer = Writer::in_memory({.compress = true});
  for (std::size_t i = 0; i < plain.header().section_count; ++i) {
    const layout::DirectoryEntry& entry = plain.entry(i);
    const auto bytes = std::span(plain.bytes()).subspan(entry.offset, entry.raw_length);
    ASSERT_TRUE(writer.begin(entry.kind, entry.stride, false, log) && writer.append(bytes, log) &&
                writer.end(log));
  }
  ASSERT_TRUE(writer.finish({plain.header().build_id[0], plain.header().build_id[1]}, log));
  const Model model = load(std::move(writer).take());
  EXPECT_EQ(model.header().required_features,
            layout::kFeatureCompressed | layout::kFeatureRecordSizes);
  EXPECT_NE(model.entry(SectionKind::nodes)->codec, 0u);
  EXPECT_TRUE(diff(load(write_to_memory(support::regular_contents())), model).same_model());
}

TEST(Growth, DefaultsStandWhereRecordsAreShort) {
  // three records of 8 bytes, read as 24: u32 a, b; u32 c = 7 [8], f32 d[2] = 0.5 [12], u16 e = 3
  // [20]
  const FieldDefault defaults[] = {{SectionKind::nodes, 8, FieldType::u32, 1, 7},
                                   {SectionKind::nodes, 12, FieldType::f32, 2, 0.5},
                                   {SectionKind::nodes, 20, FieldType::u16, 1, 3}};
  const std::uint32_t words[] = {1, 2, 3, 4, 5, 6};
  const auto from = std::as_bytes(std::span(words));
  std::vector<std::byte> to(72, std::byte{0xee});
  internal::resize_records(from, 8, to, 24, defaults);
  for (std::size_t i = 0; i < 3; ++i) {
    std::uint32_t head[3];
    float d[2];
    std::uint16_t tail[2];
    std::memcpy(head, &to[24 * i], 12);
    std::memcpy(d, &to[24 * i + 12], 8);
    std::memcpy(tail, &to[24 * i + 20], 4);
    EXPECT_EQ(head[0], 2 * i + 1);
    EXPECT_EQ(head[1], 2 * i + 2);
    EXPECT_EQ(head[2], 7u);
    EXPECT_EQ(d[0], 0.5f);
    EXPECT_EQ(d[1], 0.5f);
    EXPECT_EQ(tail[0], 3u);
    EXPECT_EQ(tail[1], 0u);
  }
}

TEST(Growth, AFieldThatIsThereInPartIsLacking) {
  const FieldDefault defaults[] = {{SectionKind::nodes, 4, FieldType::f64, 1, 2}};
  const std::vector<std::byte> from(8, std::byte{1});
  std::vector<std::byte> to(12);
  internal::resize_records(from, 8, to, 12, defaults);
  double value = 0;
  std::memcpy(&value, &to[4], 8);
  EXPECT_EQ(value, 2);
  EXPECT_EQ(to[3], std::byte{1});
}

// What a file needs of its reader, by its materials' BRDFs.
layout::Header header_with(const std::vector<materials::SpecularBrdf>& brdfs) {
  Contents contents = support::regular_contents();
  for (const materials::SpecularBrdf& brdf : brdfs) {
    contents.materials.emplace_back(contents.materials.front());
    contents.materials.back().specular_brdf = brdf;
  }
  return load(write_to_memory(contents)).header();
}

TEST(Growth, BrdfsOfLaterFormatsAreRequiredFeatures) {
  const layout::Header first = header_with({materials::Ggx{}, materials::Mirror{}});
  EXPECT_EQ(first.required_features, 0u);
  EXPECT_EQ(first.minor, 0);
  const layout::Header later = header_with({materials::Ggx{}, materials::Retroreflector{}});
  EXPECT_EQ(later.required_features, 4u);
  EXPECT_EQ(later.minor, 1);
  // a reader of 1.0 knows five diffuse and six specular models: no other may come without a bit
  for (std::size_t i = 0; i < std::variant_size_v<materials::SpecularBrdf>; ++i) {
    const auto brdf = materials::default_brdf(static_cast<materials::SpecularModel>(i));
    EXPECT_EQ(header_with({brdf}).required_features != 0, i > 5) << i;
  }
  static_assert(std::variant_size_v<materials::DiffuseBrdf> == 5, "test the features of more");
}

// A file of a BRDF without its bit, as programs wrote it before there was one.
TEST(Growth, TheBitOfAKnownBrdfMayBeMissing) {
  Contents contents = support::regular_contents();
  contents.materials.front().specular_brdf = materials::Retroreflector{};
  support::OpenPan file(write_to_memory(contents));
  file.header().required_features = 0;
  file.header().minor = 0;
  const Model model = load(file.seal().bytes());
  EXPECT_EQ(model.materials().front().specular_brdf, 6u);
}

// What a reader does with a BRDF that is newer than it.
TEST(Growth, AFileWithANewerBrdfNeedsMoreThanIsKnown) {
  support::OpenPan file(support::small_pan());
  file.header().required_features =
      (layout::kKnownRequiredFeatures << 1) & ~layout::kKnownRequiredFeatures;
  file.header().minor = layout::kMinor + 1;
  DiagnosticLog log;
  EXPECT_FALSE(Model::from_bytes(file.seal().bytes(), "x", log));
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].code, Code("E4004"));
}

TEST(Growth, ReservedKindsAreIgnoredOrRefused) {
  for (const layout::ReservedKind& kind : layout::kReservedKinds) {
    support::OpenPan file(support::small_pan());
    file.add_section(kind.value, true, 64, std::vector<std::byte>(64, std::byte{9}));
    const Model model = load(file.seal().bytes());
    EXPECT_FALSE(model.reads(model.directory().back()));
    EXPECT_EQ(kind_name(model.directory().back().kind), kind.name);
    file.entry(support::kSampleSections).flags = 0;
    DiagnosticLog log;
    EXPECT_FALSE(Model::from_bytes(file.seal().bytes(), "x", log));
    ASSERT_EQ(log.entries().size(), 1u);
    EXPECT_EQ(log.entries()[0].code, Code("E4004"));
    EXPECT_NE(log.entries()[0].message.find("'" + std::string(kind.name) + "'"), std::string::npos);
  }
}

TEST(Growth, MessagesSayWhatIsRead) {
  support::OpenPan file(support::small_pan());
  file.restride_section(SectionKind::nodes, 92);
  DiagnosticLog log;
  EXPECT_FALSE(Model::from_bytes(file.seal().bytes(), "x", log));
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].message,
            "section 'nodes' has records of 92 bytes, expected a multiple of 8 from 88 to 4096");
}

}  // namespace
}  // namespace panwright::pan::growth_test
