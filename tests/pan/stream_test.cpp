// Models whose meshes a producer gives one at a time, and counts beyond 32 bits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "pan/diff.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "tests/pan/load.h"
#include "tests/support/pan_sample.h"
#include "tests/support/process.h"

namespace panwright::pan::stream_test {
namespace {

using layout::SectionKind;
using testing::HasSubstr;

// The meshes of a model, as a producer makes them.
MeshProducer producer_of(const std::vector<PackedMesh>& meshes) {
  MeshProducer out;
  for (const PackedMesh& mesh : meshes)
    out.shapes.push_back({mesh.vertex_count(), mesh.triangle_count(), !mesh.texcoords.empty(),
                          !mesh.colors.empty()});
  out.make = [&meshes](std::size_t i, PackedMesh& mesh) {
    mesh = meshes[i];
    return true;
  };
  return out;
}

TEST(Stream, HoldsTheModelThatIsWrittenWhole) {
  const support::TemporaryFolder folder;
  for (const Contents& contents : {support::small_contents(), support::regular_contents()}) {
    const Model whole = load(write_to_memory(contents));
    Contents rest = contents;
    const std::vector<PackedMesh> meshes = std::move(rest.meshes);
    rest.meshes.clear();
    DiagnosticLog log;
    const std::string path = folder / "streamed.pan";
    const auto report = write(rest, producer_of(meshes), path, log);
    ASSERT_TRUE(report) << to_text(log);
    EXPECT_EQ(report->bytes, std::filesystem::file_size(path));
    const auto streamed = Model::load(path, log);
    ASSERT_TRUE(streamed) << to_text(log);
    const Differences found = diff(whole, *streamed);
    ASSERT_EQ(found.model.size(), 1u) << found.model[0].where << found.model[0].what;
    EXPECT_EQ(found.model[0].where, "file");  // in another order
    EXPECT_TRUE(found.provenance.empty() && found.storage.empty());
    EXPECT_EQ(streamed->build_id(), whole.build_id());
    for (const SectionKind kind :
         {SectionKind::positions, SectionKind::normals, SectionKind::texcoords, SectionKind::colors,
          SectionKind::indices, SectionKind::texels})
      EXPECT_TRUE(std::ranges::equal(streamed->section(kind), whole.section(kind)));
  }
}

TEST(Stream, BlocksOfSeveralSectionsInTurn) {
  // pieces of 1, 2, 3… kB against the sections written whole: borders of blocks fall anywhere
  std::vector<float> numbers(600'000);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<float>(i);
  const auto bytes = std::as_bytes(std::span(numbers));
  DiagnosticLog log;
  Writer turns = Writer::in_memory(), whole = Writer::in_memory();
  ASSERT_TRUE(turns.reserve(SectionKind::positions, numbers.size() / 3, log));
  ASSERT_TRUE(turns.reserve(SectionKind::indices, bytes.size() - 40, log));
  for (std::size_t at = 0, piece = 1000; at < bytes.size(); at += piece, piece += 1000) {
    const auto part = bytes.subspan(at, std::min(piece, bytes.size() - at));
    ASSERT_TRUE(turns.fill(SectionKind::positions, part, log));
    const std::size_t left = bytes.size() - 40 - std::min(at, bytes.size() - 40);
    ASSERT_TRUE(turns.fill(SectionKind::indices, part.first(std::min(part.size(), left)), log));
  }
  ASSERT_TRUE(whole.section(SectionKind::positions, bytes, log) &&
              whole.section(SectionKind::indices, bytes.first(bytes.size() - 40), log));
  ASSERT_TRUE(turns.finish({1, 2}, log) && whole.finish({1, 2}, log));
  EXPECT_EQ(std::move(turns).take(), std::move(whole).take());
}

// What a producer's fault is called; the old file stays.
std::string fault(const std::function<void(std::vector<PackedMesh>&, MeshProducer&)>& change) {
  const support::TemporaryFolder folder;
  const std::string path = folder.write("old.pan", "old");
  Contents contents = support::regular_contents();
  std::vector<PackedMesh> meshes = std::move(contents.meshes);
  contents.meshes.clear();
  MeshProducer producer = producer_of(meshes);
  change(meshes, producer);
  DiagnosticLog log;
  EXPECT_FALSE(write(contents, producer, path, log));
  EXPECT_EQ(support::contents(path), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  return to_text(log);
}

TEST(Stream, FaultsOfAProducerAreSaid) {
  using Meshes = std::vector<PackedMesh>;
  EXPECT_THAT(fault([](Meshes& meshes, MeshProducer& producer) {
                producer.make = [&](std::size_t i, PackedMesh& mesh) {
                  mesh = meshes[i];
                  return i < 2;
                };
              }),
              HasSubstr("the producer broke off before mesh 2 of 3 [E0103]"));
  EXPECT_THAT(fault([](Meshes&, MeshProducer& producer) { ++producer.shapes[1].vertices; }),
              HasSubstr("mesh 1 has 4 vertices, 1 triangle, texcoords and colours, but was "
                        "announced with 5 vertices, 1 triangle"));
  EXPECT_THAT(
      fault([](Meshes&, MeshProducer& producer) { producer.shapes[0].colors = true; }),
      HasSubstr("but was announced with 4 vertices, 4 triangles, no texcoords and colours"));
  EXPECT_THAT(fault([](Meshes& meshes, MeshProducer&) { meshes[2].normals.pop_back(); }),
              HasSubstr("mesh 2 has arrays of different lengths"));
  EXPECT_THAT(fault([](Meshes&, MeshProducer& producer) { producer.shapes[2].vertices = 2; }),
              HasSubstr("mesh 2 has 2 vertices and 1152 triangles, expected at least 3 and 1"));
  EXPECT_THAT(fault([](Meshes& meshes, MeshProducer&) { meshes[0].indices[5] = 4; }),
              HasSubstr("index 5 of meshes[0] 'hull' is 4, but the mesh has 4 vertices [E4010]"));
}

TEST(Stream, CountsBeyondTheFormatAreSaidBeforeAnythingIsWritten) {
  using Meshes = std::vector<PackedMesh>;
  EXPECT_THAT(
      fault([](Meshes&, MeshProducer& producer) { producer.shapes[0].vertices = 1ull << 32; }),
      HasSubstr("mesh 0 has 4294967296 vertices and 4 triangles, expected at most "
                "4294967295 of each"));
  EXPECT_THAT(
      fault([](Meshes&, MeshProducer& producer) { producer.shapes[2].triangles = 1ull << 40; }),
      HasSubstr("mesh 2 has 625 vertices and 1099511627776 triangles"));
  EXPECT_THAT(fault([](Meshes&, MeshProducer& producer) {
                producer.shapes.assign(100'000, {0xffffffffu, 1, false, false});
              }),
              HasSubstr("more than a file holds"));
  // 2 PB, which no disk of these has: nothing is filled to find that out
  EXPECT_THAT(fault([](Meshes&, MeshProducer& producer) {
                producer.shapes.assign(40'000, {0xffffffffu, 1, false, false});
              }),
              HasSubstr("No space left on device [E0103]"));
}

// What a file is told when lengths of its header or directory are claimed to be huge.
TEST(Stream, HugeClaimsAreRefused) {
  using layout::DirectoryEntry;
  using support::OpenPan;
  for (const std::uint64_t claim : {1ull << 40, 1ull << 63, ~0ull}) {
    const std::function<void(OpenPan&, DirectoryEntry&)> of_the_header[] = {
        [&](OpenPan& file, DirectoryEntry&) { file.header().total_length = claim; },
        [&](OpenPan& file, DirectoryEntry&) { file.header().directory_offset = claim; },
    };
    const std::function<void(OpenPan&, DirectoryEntry&)> of_an_entry[] = {
        [&](OpenPan&, DirectoryEntry& entry) { entry.offset = claim; },
        [&](OpenPan&, DirectoryEntry& entry) { entry.stored_length = claim; },
        [&](OpenPan&, DirectoryEntry& entry) { entry.raw_length = claim; },
        [&](OpenPan&, DirectoryEntry& entry) { entry.count = claim; },
        [&](OpenPan&, DirectoryEntry& entry) { entry.packed_length = claim; },
        [&](OpenPan& file, DirectoryEntry& entry) {
          entry.codec = static_cast<std::uint32_t>(layout::Codec::chunks);
          entry.count = claim / 12;
          entry.raw_length = entry.count * 12;
          file.header().required_features |= layout::kFeatureCompressed;
        },
        [&](OpenPan& file, DirectoryEntry& entry) {
          entry.codec = static_cast<std::uint32_t>(layout::Codec::streams);
          entry.count = claim / 12;
          entry.raw_length = entry.count * 12;
          file.header().required_features |= layout::kFeatureMeshStreams;
        },
    };
    const auto refused = [](const OpenPan& file) {
      DiagnosticLog log;
      EXPECT_FALSE(Model::from_bytes(file.bytes(), "x.pan", log));
      return log.errors() == 1;
    };
    for (const auto& change : of_the_header) {
      OpenPan file(support::small_pan());
      change(file, file.entry(SectionKind::positions));
      EXPECT_TRUE(refused(file.seal_header()));
    }
    for (const auto& change : of_an_entry) {
      OpenPan file(support::small_pan());
      change(file, file.entry(SectionKind::positions));
      EXPECT_TRUE(refused(file.seal_directory()));
    }
  }
}

TEST(Stream, PlacesOfLongRunsAreModulo32Bits) {
  // three meshes of 2^31 vertices by the tables: the third run begins at 2^32
  Contents contents = support::small_contents();
  contents.meshes.push_back(contents.meshes[0]);
  contents.mesh_tolerances.clear();
  for (const bool declared : {false, true}) {
    support::OpenPan file(write_to_memory(contents));
    std::uint64_t offset = 0;
    for (std::size_t m = 0; m < 3; ++m) {
      auto& mesh = file.at<layout::Mesh>(SectionKind::meshes, m);
      mesh.vertex_count = 1u << 31;
      mesh.first_vertex = static_cast<std::uint32_t>(m) << 31;
      mesh.index_size = 4;
      mesh.index_offset = offset;
      offset += std::uint64_t{12} * mesh.triangle_count;
    }
    if (declared) file.header().required_features |= layout::kFeatureLongRuns;
    DiagnosticLog log;
    auto model = Model::from_bytes(file.seal().bytes(), "x.pan", log);
    ASSERT_TRUE(model) << to_text(log);
    EXPECT_FALSE(model->check(log));
    EXPECT_THAT(to_text(log),
                HasSubstr(declared ? "but the meshes need 6442450944"
                                   : "meshes[2].first_vertex is 0, expected 4294967296"));
  }
}

TEST(Stream, LongRunsOfAShortFileAreFound) {
  support::OpenPan file(write_to_memory(support::regular_contents()));
  const Model plain = load(file.bytes());
  file.header().required_features |= layout::kFeatureLongRuns;
  const Model model = load(file.seal().bytes());
  for (std::size_t m = 0; m < plain.meshes().size(); ++m) {
    EXPECT_EQ(model.first_vertex(m), plain.meshes()[m].first_vertex);
    EXPECT_EQ(model.first_texcoord(m), plain.meshes()[m].first_texcoord);
    EXPECT_EQ(model.first_color(m), plain.meshes()[m].first_color);
    EXPECT_EQ(model.mesh(m).colors.size(), plain.mesh(m).colors.size());
  }
}

TEST(Stream, NamesThatFillTheirOffsetsAreSaid) {
  StringTable strings(10);
  EXPECT_EQ(strings.id("short"), 1u);
  EXPECT_EQ(strings.id("other"), 2u);
  EXPECT_FALSE(strings.full());
  EXPECT_EQ(strings.id("x"), 0u);
  EXPECT_TRUE(strings.full());
  EXPECT_EQ(strings.id("short"), 1u);
  EXPECT_EQ(strings.offsets().back(), 10u);
}

}  // namespace
}  // namespace panwright::pan::stream_test
