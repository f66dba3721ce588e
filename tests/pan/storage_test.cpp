// Meshes stored as streams: what comes back, what the file says of the error, and damage.
#include "pan/storage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "pan/diff.h"
#include "pan/model.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::storage_test {
namespace {

using layout::SectionKind;

StorageForm form(const char* text) { return storage_form(text).value(); }

Contents stored(Contents contents, const char* text) {
  for (PackedMesh& mesh : contents.meshes) {
    snap(mesh, form(text).bits, normal_bits(form(text)), {});
    encode(mesh, form(text));
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

Model load(const std::vector<std::byte>& bytes) {
  DiagnosticLog log;
  auto model = Model::from_bytes(bytes, "x.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return *std::move(model);
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

constexpr const char* kForms[] = {"quantised", "quantised:11", "quantised:20",
                                  "meshopt",   "meshopt:16",   "meshopt:18",
                                  "draco:11",  "draco:14",     "draco:16"};

TEST(Storage, FormsByName) {
  for (const char* text : kForms) {
    const StorageForm it = form(text);
    EXPECT_EQ(storage_form(storage_name(it))->bits, it.bits) << text;
    EXPECT_TRUE(it.streams());
  }
  EXPECT_EQ(form("draco").bits, 14u);
  EXPECT_FALSE(form("none").streams());
  for (const char* text : {"", "drako", "draco:", "draco:7", "draco:25", "draco:14x", "none:14",
                           "lossless:16", "draco:-1", "Draco"})
    EXPECT_FALSE(storage_form(text)) << text;
}

TEST(Storage, WhatIsReadIsWhatWasStored) {
  for (const char* text : kForms) {
    SCOPED_TRACE(text);
    const Contents contents = stored(wavy(), text);
    const std::vector<std::byte> bytes = write_to_memory(contents);
    EXPECT_EQ(bytes, write_to_memory(stored(wavy(), text)));
    const Model model = load(bytes);
    EXPECT_TRUE(model.header().required_features & layout::kFeatureMeshStreams);
    ASSERT_EQ(model.mesh_streams().size(), contents.meshes.size());
    std::size_t vertex = 0;
    for (std::size_t m = 0; m < contents.meshes.size(); ++m) {
      const PackedMesh& mesh = contents.meshes[m];
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
  for (const char* text : kForms) {
    SCOPED_TRACE(text);
    Contents snapped = before;
    for (std::size_t m = 0; m < before.meshes.size(); ++m) {
      PackedMesh& mesh = snapped.meshes[m];
      snap(mesh, form(text).bits, normal_bits(form(text)), {});
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
      if (!form(text).lossy() || mesh.vertex_count() < 100) {
        encode(mesh, form(text));
        continue;  // few vertices may lie on the grid
      }
      // floats near 1 do not tell angles below 3e-4 by their cosine
      EXPECT_GE(mesh.stream.normal_error, std::acos(std::min(1.0, least)) - 5e-4);
      {
        EXPECT_GT(worst, 0);
        // half a step along each axis, and the rounding to float
        EXPECT_LE(worst, mesh.stream.step * std::sqrt(0.75) * 1.001 + 1e-7);
        // the same table, max of octahedral normals in degrees: 10 bits .233, 12 .0586, 14 .0146
        const double table[] = {0, 0.2340, 0, 0.0590, 0, 0.0148, 0, 0.0040};
        const double most = table[normal_bits(form(text)) - 9];
        EXPECT_LE(mesh.stream.normal_error / kDegree, most);
        EXPECT_GE(mesh.stream.normal_error / kDegree, most / 10);
      }
      const auto whole = corners(mesh, mesh.positions);
      encode(mesh, form(text));
      EXPECT_TRUE(corners(mesh, mesh.positions) == whole);
    }
  }
}

TEST(Storage, ExactVerticesStayToTheBit) {
  for (const char* text : {"quantised", "meshopt:11", "draco:11"}) {
    Contents contents = wavy();
    PackedMesh& mesh = contents.meshes[0];
    const PackedMesh before = mesh;
    std::vector<char> exact(mesh.vertex_count());
    for (std::size_t v = 0; v < exact.size(); v += 3) exact[v] = 1;
    snap(mesh, form(text).bits, normal_bits(form(text)), exact);
    std::size_t moved = 0;
    for (std::size_t v = 0; v < exact.size(); ++v) {
      const bool same =
          std::equal(&mesh.positions[3 * v], &mesh.positions[3 * v] + 3, &before.positions[3 * v]);
      EXPECT_TRUE(same || !exact[v]);
      moved += !same;
    }
    EXPECT_GT(moved, exact.size() / 4);
    for (PackedMesh& each : contents.meshes) encode(each, form(text));
    const Model model = load(write_to_memory(contents));
    EXPECT_GT(model.mesh_streams()[0].exact_positions, 0u) << text;
    EXPECT_TRUE(std::ranges::equal(std::as_bytes(model.mesh(0).positions),
                                   std::as_bytes(std::span(mesh.positions))));
  }
}

TEST(Storage, DracoIsSmallerThanCodes) {
  std::size_t sizes[3] = {};
  std::size_t i = 0;
  for (const char* text : {"quantised:14", "meshopt:14", "draco:14"}) {
    for (const PackedMesh& mesh : stored(wavy(), text).meshes) sizes[i] += mesh.stream.length;
    ++i;
  }
  EXPECT_LT(sizes[1], sizes[0]);
  EXPECT_LT(sizes[2], sizes[1]);
}

TEST(Storage, AReaderThatDoesNotKnowStreamsRefuses) {
  support::OpenPan file(write_to_memory(stored(wavy(), "draco:14")));
  const std::uint64_t features = file.header().required_features;
  file.header().required_features |= 1ull << 40;
  DiagnosticLog log;
  EXPECT_FALSE(Model::from_bytes(file.seal().bytes(), "x.pan", log));
  EXPECT_TRUE(log.contains(Code::E4004));
  file.header().required_features = features & ~std::uint64_t{layout::kFeatureMeshStreams};
  DiagnosticLog other;
  EXPECT_FALSE(Model::from_bytes(file.seal().bytes(), "x.pan", other));
  EXPECT_TRUE(other.contains(Code::E4008));
}

// Bytes of the streams and of their records become others, and the checksums are made right again:
// the codecs see them. What they make is sound or refused.
TEST(Storage, DamageIsRefusedOrHarmless) {
  std::mt19937 random(7);
  std::size_t refused = 0, accepted = 0;
  for (const char* text : {"quantised", "meshopt:16", "draco:14", "draco:11"}) {
    Contents contents = stored(wavy(), text);
    if (text == std::string_view("draco:11"))  // no triangle of a vertex: sequential
      for (PackedMesh& mesh : contents.meshes) {
        mesh.indices.insert(mesh.indices.end(), {0, 1, 1});
        encode(mesh, form(text));
      }
    const std::vector<std::byte> bytes = write_to_memory(contents);
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
