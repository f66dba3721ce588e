// Meshes stored as streams: what comes back, what the file says of the error, and damage.
#include "pan/storage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>

#include "base/file.h"
#include "pan/diff.h"
#include "pan/model.h"
#include "tests/pan/load.h"
#include "tests/support/pan_sample.h"
#include "tests/support/paths.h"

namespace panwright::pan::storage_test {
namespace {

using layout::SectionKind;

Contents stored(Contents contents, std::uint32_t bits) {
  for (PackedMesh& mesh : contents.meshes) {
    snap(mesh, bits, normal_bits(bits), {});
    encode(mesh);
  }
  return contents;
}

Contents wavy() {
  Contents out = support::regular_contents();
  for (PackedMesh& mesh : out.meshes)
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      mesh.positions[3 * v + 2] += 0.01f * std::sin(7 * mesh.positions[3 * v]);
      const float x = std::sin(static_cast<float>(v)), y = 0.5f, z = -0.3f;
      const float length = std::sqrt(x * x + y * y + z * z);
      mesh.normals[3 * v] = x / length;
      mesh.normals[3 * v + 1] = y / length;
      mesh.normals[3 * v + 2] = z / length;
    }
  return out;
}

// Triangles as corners of positions, each from its least corner, sorted.
std::vector<std::array<std::array<float, 3>, 3>> corners(const PackedMesh& mesh,
                                                         const std::vector<float>& positions) {
  std::vector<std::array<std::array<float, 3>, 3>> out;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    auto& t = out.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      std::copy_n(&positions[3 * mesh.indices[i + k]], 3, t[k].begin());
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  }
  std::sort(out.begin(), out.end());
  return out;
}

constexpr std::uint32_t kBits[] = {0, 11, 14, 16, 18, 20};  // 0: floats

TEST(Storage, FormsByName) {
  for (const char* text : {"lossy", "lossy:8", "lossy:24"}) {
    const StorageForm it = storage_form(text).value();
    EXPECT_EQ(storage_form(storage_name(it))->bits, it.bits) << text;
    EXPECT_TRUE(it.streams());
  }
  EXPECT_EQ(storage_form("lossy")->bits, 16u);
  EXPECT_FALSE(storage_form("none")->streams());
  EXPECT_FALSE(storage_form("lossless")->streams());
  for (const char* text : {"", "losy", "lossy:", "lossy:7", "lossy:25", "lossy:14x", "none:14",
                           "lossless:16", "lossy:-1", "Lossy", "draco:14", "meshopt", "quantised"})
    EXPECT_FALSE(storage_form(text)) << text;
}

TEST(Storage, WhatIsReadIsWhatWasStored) {
  for (const std::uint32_t bits : kBits) {
    SCOPED_TRACE(bits);
    const Contents contents = stored(wavy(), bits);
    const std::vector<std::byte> bytes = write_to_memory(contents);
    EXPECT_EQ(bytes, write_to_memory(stored(wavy(), bits)));
    const Model model = load(bytes);
    EXPECT_TRUE(model.header().required_features & layout::kFeatureMeshStreams);
    ASSERT_EQ(model.mesh_streams().size(), contents.meshes.size());
    std::size_t vertex = 0;
    for (std::size_t m = 0; m < contents.meshes.size(); ++m) {
      const PackedMesh& mesh = contents.meshes[m];
      if (bits == 0) {
        EXPECT_EQ(mesh.positions, wavy().meshes[m].positions);
        EXPECT_EQ(mesh.normals, wavy().meshes[m].normals);
      }
      const MeshView view = model.mesh(m);
      ASSERT_EQ(view.positions.size(), mesh.vertex_count());
      EXPECT_EQ(
          std::memcmp(view.positions.data(), mesh.positions.data(), mesh.positions.size() * 4), 0);
      EXPECT_EQ(std::memcmp(view.normals.data(), mesh.normals.data(), mesh.normals.size() * 4), 0);
      ASSERT_EQ(view.indices.size(), mesh.indices.size());
      for (std::size_t i = 0; i < mesh.indices.size(); ++i)
        ASSERT_EQ(view.indices[i], mesh.indices[i]);
      vertex += mesh.vertex_count();
    }
    EXPECT_EQ(model.positions().size(), vertex);
  }
}

// The oracle measures by itself, by triangles as they lie, whatever their order has become.
TEST(Storage, ErrorsHoldAndAreNotTooLarge) {
  const Contents before = wavy();
  for (const std::uint32_t bits : kBits) {
    SCOPED_TRACE(bits);
    Contents snapped = before;
    for (std::size_t m = 0; m < before.meshes.size(); ++m) {
      PackedMesh& mesh = snapped.meshes[m];
      snap(mesh, bits, normal_bits(bits), {});
      double worst = 0, least = 1;
      for (std::size_t i = 0; i < mesh.positions.size(); i += 3) {
        double squared = 0, dot = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          squared += std::pow(double{mesh.positions[i + k]} - before.meshes[m].positions[i + k], 2);
          dot += double{mesh.normals[i + k]} * before.meshes[m].normals[i + k];
        }
        worst = std::max(worst, std::sqrt(squared));
        least = std::min(least, dot);
      }
      EXPECT_GE(mesh.stream.position_error, worst * (1 - 1e-12));
      EXPECT_LE(mesh.stream.position_error, worst * (1 + 1e-12));
      EXPECT_DOUBLE_EQ(mesh.error, before.meshes[m].error + mesh.stream.position_error);
      if (bits == 0 || mesh.vertex_count() < 100) {
        encode(mesh);
        continue;  // few vertices may lie on the grid
      }
      // floats near 1 do not tell angles below 3e-4 by their cosine
      EXPECT_GE(mesh.stream.normal_error, std::acos(std::min(1.0, least)) - 5e-4);
      {
        EXPECT_GT(worst, 0);
        // half a step along each axis, and the rounding to float
        EXPECT_LE(worst, mesh.stream.step * std::sqrt(0.75) * 1.001 + 1e-7);
        // the same table, max of octahedral normals in degrees: 10 bits .233, 12 .0586, 14 .0146
        const double table[] = {0, 0.2340, 0, 0.0590, 0, 0.0148};
        const double most = table[normal_bits(bits) - 9];
        EXPECT_LE(mesh.stream.normal_error / kDegree, most);
        EXPECT_GE(mesh.stream.normal_error / kDegree, most / 10);
      }
      const auto whole = corners(mesh, mesh.positions);
      encode(mesh);
      EXPECT_TRUE(corners(mesh, mesh.positions) == whole);
    }
  }
}

TEST(Storage, ExactVerticesStayToTheBit) {
  for (const std::uint32_t bits : {11u, 16u}) {
    Contents contents = wavy();
    PackedMesh& mesh = contents.meshes[0];
    const PackedMesh before = mesh;
    std::vector<char> exact(mesh.vertex_count());
    for (std::size_t v = 0; v < exact.size(); v += 3) exact[v] = 1;
    snap(mesh, bits, normal_bits(bits), exact);
    std::size_t moved = 0;
    for (std::size_t v = 0; v < exact.size(); ++v) {
      const bool same =
          std::equal(&mesh.positions[3 * v], &mesh.positions[3 * v] + 3, &before.positions[3 * v]);
      EXPECT_TRUE(same || !exact[v]);
      moved += !same;
    }
    EXPECT_GT(moved, exact.size() / 4);
    for (PackedMesh& each : contents.meshes) encode(each);
    const Model model = load(write_to_memory(contents));
    EXPECT_GT(model.mesh_streams()[0].exact_positions, 0u) << bits;
    EXPECT_TRUE(std::ranges::equal(std::as_bytes(model.mesh(0).positions),
                                   std::as_bytes(std::span(mesh.positions))));
  }
}

TEST(Storage, StreamsAreSmallerThanCodes) {
  std::size_t streams = 0, codes = 0;
  for (const PackedMesh& mesh : stored(wavy(), 14).meshes) {
    streams += mesh.stream.length;
    codes += 10 * mesh.vertex_count() + 2 * mesh.indices.size();
  }
  EXPECT_LT(streams, codes);
}

TEST(Storage, AReaderThatDoesNotKnowStreamsRefuses) {
  support::OpenPan file(write_to_memory(stored(wavy(), 14)));
  const std::uint64_t features = file.header().required_features;
  file.header().required_features |= 1ull << 40;
  DiagnosticLog log;
  EXPECT_FALSE(Model::from_bytes(file.seal().bytes(), "x.pan", log));
  EXPECT_TRUE(log.contains(Code("E4004")));
  file.header().required_features = features & ~std::uint64_t{layout::kFeatureMeshStreams};
  DiagnosticLog other;
  EXPECT_FALSE(Model::from_bytes(file.seal().bytes(), "x.pan", other));
  EXPECT_TRUE(other.contains(Code("E4008")));
}

// Bytes of the streams and of their records become others, and the checksums are made right again:
// the codecs see them. What they make is sound or refused.
TEST(Storage, DamageIsRefusedOrHarmless) {
  std::mt19937 random(7);
  std::size_t refused = 0, accepted = 0;
  std::vector<std::vector<std::byte>> files{write_to_memory(stored(wavy(), 16))};
  // those of older programs: plain, and both methods of Draco
  for (const char* name : {"quantised", "draco_14", "draco_sequential"}) {
    const auto path = std::filesystem::path(PANWRIGHT_SOURCE_DIR "/tests/pan/data/1.1") /
                      (std::string(name) + ".pan");
    DiagnosticLog log;
    const auto file = MappedFile::open(path, log);
    ASSERT_TRUE(file) << to_text(log);
    files.emplace_back(file->bytes().begin(), file->bytes().end());
  }
  for (const std::vector<std::byte>& bytes : files) {
    for (int i = 0; i < 600; ++i) {
      support::OpenPan file(bytes);
      const SectionKind kind = i % 8 == 0 ? SectionKind::mesh_streams : SectionKind::stream_bytes;
      const auto length = static_cast<std::size_t>(file.entry(kind).raw_length);
      const int changes = 1 + i % 5;
      for (int k = 0; k < changes; ++k) {
        // early bytes decide most: half of the changes are among them
        const std::size_t at = random() % (i % 2 ? length : std::min<std::size_t>(length, 96));
        file.at<std::uint8_t>(kind, at) = static_cast<std::uint8_t>(random());
      }
      DiagnosticLog log;
      auto model = Model::from_bytes(file.seal().bytes(), "x.pan", log);
      const bool sound = model && model->check(log);
      EXPECT_EQ(sound, !log.has_errors());
      if (!sound) {
        EXPECT_EQ(exit_code(log), 4) << to_text(log);
      }
      ++(sound ? accepted : refused);
    }
  }
  EXPECT_GT(refused, 1000u);
  EXPECT_GT(accepted, 10u);
}

}  // namespace
}  // namespace panwright::pan::storage_test
