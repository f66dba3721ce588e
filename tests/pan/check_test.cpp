// Damage and nonsense: always a named error, never a crash. Most useful under AddressSanitizer:
// a model copies its bytes into a heap block of their exact size.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>

#include "base/parallel.h"
#include "pan/model.h"
#include "tests/support/pan_damage.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::check_test {
namespace {

// The codes that reading some bytes gives; none: a sound file.
std::set<std::string_view> codes(std::span<const std::byte> bytes) {
  DiagnosticLog log;
  auto model = Model::from_bytes(bytes, "x.pan", log);
  const bool sound = model && model->check(log);
  std::set<std::string_view> found;
  for (const Diagnostic& entry : log.entries()) found.insert(code_info(entry.code).name);
  EXPECT_EQ(sound, found.empty());
  EXPECT_TRUE(!model || model->checked() == sound);
  return found;
}

void expect_refused(std::span<const std::byte> bytes, const std::string& what) {
  const auto found = codes(bytes);
  EXPECT_FALSE(found.empty()) << what;
  for (const std::string_view name : found)
    EXPECT_TRUE(name.starts_with("E40")) << what << ": " << name;
}

TEST(Check, TheSampleIsSound) { EXPECT_EQ(codes(support::small_pan()).size(), 0u); }

TEST(Check, EveryTruncationIsRefused) {
  const std::vector<std::byte> file = support::small_pan();
  for (std::size_t length = 0; length < file.size(); ++length)
    expect_refused(std::span(file).first(length), "cut to " + std::to_string(length));
}

TEST(Check, EveryFlippedBitIsRefused) {
  std::vector<std::byte> file = support::small_pan();
  for (std::size_t at = 0; at < file.size(); ++at) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      file[at] ^= std::byte{1} << bit;
      expect_refused(file, "bit " + std::to_string(bit) + " of byte " + std::to_string(at));
      file[at] ^= std::byte{1} << bit;
    }
  }
}

TEST(Check, GrownFilesAreRefused) {
  std::vector<std::byte> file = support::small_pan();
  for (int more = 1; more < 200; ++more) {
    file.push_back(std::byte{0});
    expect_refused(file, std::to_string(more) + " bytes more");
  }
}

TEST(Check, NonsenseUnderRightChecksumsIsNamed) {
  for (const support::DamagedPan& damaged : support::damaged_pans()) {
    const auto found = codes(damaged.bytes);
    EXPECT_TRUE(found.contains(code_info(damaged.code).name))
        << damaged.what << ": " << (found.empty() ? "accepted" : *found.begin());
  }
}

TEST(Check, EveryCodeOfPanHasAnExample) {
  std::set<std::string_view> produced;
  for (const auto& [code, bytes] : support::damaged_examples()) {
    EXPECT_TRUE(codes(bytes).contains(code_info(code).name));
    produced.insert(code_info(code).name);
  }
  for (const CodeInfo& info : all_codes())
    EXPECT_EQ(info.name.substr(0, 3) == "E40", produced.contains(info.name)) << info.name;
}

// Every 4-byte word of the tables becomes each of some hostile values, checksums right. The file
// may stay sound; what must not happen is seen by the sanitizers, which run the accessors too.
TEST(Check, HostileWordsNeverBreakTheReader) {
  support::OpenPan pristine(support::small_pan());
  const std::size_t texts = pristine.entry(layout::SectionKind::string_bytes).offset;
  const std::size_t arrays_end = pristine.entry(layout::SectionKind::budget).offset;
  const std::size_t end = pristine.header().directory_offset;
  std::size_t sound = 0;
  for (std::size_t at = 128; at < end; at += 4) {
    if (at == texts) at = arrays_end;
    for (const std::uint32_t value : {0u, 1u, 0x7fffffffu, 0x80000000u, 0xffffffffu, 0x7fc00000u}) {
      std::vector<std::byte> bytes = support::small_pan();
      std::memcpy(bytes.data() + at, &value, 4);
      support::OpenPan file(std::move(bytes));
      file.seal();
      DiagnosticLog log;
      auto model = Model::from_bytes(file.bytes(), "x", log);
      ASSERT_TRUE(model);
      if (!model->check(log)) continue;
      ++sound;
      std::uint64_t sum = 0;
      for (std::size_t m = 0; m < model->meshes().size(); ++m) {
        const MeshView view = model->mesh(m);
        for (std::size_t i = 0; i < view.indices.size(); ++i)
          sum += static_cast<std::uint64_t>(view.positions[view.indices[i]].x != 0);
        sum += model->mesh_name(m).size() + view.texcoords.size() + view.colors.size();
      }
      for (std::size_t t = 0; t < model->textures().size(); ++t) sum += model->texels(t).size();
      for (std::size_t n = 0; n < model->nodes().size(); ++n) sum += model->node_path(n).size();
      for (const layout::MeshTolerance& budget : model->mesh_tolerances())
        sum += reason_name(layout::ToleranceReason{budget.reason}).size();
      for (std::size_t k = 0; k < model->keypoints().size(); ++k)
        sum += model->keypoint_name(k).size() + model->nodes()[model->keypoints()[k].node].name;
      for (std::size_t d = 0; d < model->decals().size(); ++d)
        sum += model->decal_name(d).size() + model->texels(model->decals()[d].texture).size() +
               model->instances()[model->decals()[d].instance].mesh;
      EXPECT_GT(sum, 0u);
      const auto bounds = model->world_bounds();
      ASSERT_TRUE(bounds);
      EXPECT_TRUE(is_finite(bounds->low) && is_finite(bounds->high)) << "word at " << at;
    }
  }
  // some changes are harmless (another translation, a weight of 1), most are not
  EXPECT_GT(sound, 100u);
}

TEST(Check, MessagesNameThePlaceAndWhatIsAccepted) {
  support::OpenPan file(support::small_pan());
  file.at<std::uint16_t>(layout::SectionKind::indices, 2) = 77;
  file.at<layout::Instance>(layout::SectionKind::instances, 1).material = 9;
  file.seal();
  DiagnosticLog log;
  auto model = Model::from_bytes(file.bytes(), "x", log);
  ASSERT_TRUE(model && !model->check(log));
  ASSERT_EQ(log.entries().size(),
            1u);  // the tables are wrong, so the arrays are not judged by them
  EXPECT_EQ(log.entries()[0].message, "instances[1].material is 9, but 'materials' has 2 elements");
  file.at<layout::Instance>(layout::SectionKind::instances, 1).material = 1;
  file.seal();
  DiagnosticLog second;
  model = Model::from_bytes(file.bytes(), "x", second);
  ASSERT_TRUE(model && !model->check(second));
  EXPECT_EQ(second.entries()[0].message,
            "index 2 of meshes[0] 'hull' is 77, but the mesh has 4 vertices");
}

TEST(Check, ReportsDoNotDependOnThreads) {
  support::OpenPan file(write_to_memory(support::large_contents(30'000'000)));
  const auto vertices = file.entry(layout::SectionKind::positions).count;
  for (const std::uint64_t i : {vertices - 1, vertices / 2, vertices / 3})
    file.at<layout::Float3>(layout::SectionKind::positions, i).x = 1e9f;
  file.at<std::uint32_t>(layout::SectionKind::indices, 1'000'000) = 0xffffffffu;
  file.at<layout::Float3>(layout::SectionKind::normals, 300'000).y = 2;
  file.seal();
  std::vector<std::string> texts;
  for (const std::size_t threads : {1u, 2u, 7u, 7u}) {
    DiagnosticLog log;
    auto model = Model::from_bytes(file.bytes(), "x", log);
    ASSERT_TRUE(model && !model->check(log, Job({threads, {}})));
    texts.push_back(to_text(log));
    EXPECT_EQ(log.entries().size(), 3u);
  }
  EXPECT_NE(texts[0].find(std::to_string(vertices / 3)), std::string::npos) << texts[0];
  EXPECT_NE(texts[0].find("(and 2 more)"), std::string::npos) << texts[0];
  for (const std::string& text : texts) EXPECT_EQ(text, texts[0]);
}

// The message of the one problem that a change of a file makes.
std::string message_after(support::OpenPan& file) {
  file.seal();
  DiagnosticLog log;
  auto model = Model::from_bytes(file.bytes(), "x", log);
  EXPECT_TRUE(model && !model->check(log));
  EXPECT_EQ(log.entries().size(), 1u);
  return log.entries().empty() ? std::string() : log.entries()[0].message;
}

TEST(Check, NothingHidesAtTheEdgesOfBlocksAndMeshes) {
  using layout::SectionKind;
  // two sheets of 263,169 vertices: blocks end at 65,536 k
  support::OpenPan file(write_to_memory(support::large_contents(26'000'000)));
  const std::uint64_t vertices = file.entry(SectionKind::positions).count;
  ASSERT_EQ(vertices, 2u * 263169u);
  for (const std::uint64_t i : {std::uint64_t{0}, std::uint64_t{65535}, std::uint64_t{65536},
                                std::uint64_t{263168}, std::uint64_t{263169}, vertices - 1}) {
    const std::string number = "[" + std::to_string(i) + "]";
    for (const SectionKind kind : {SectionKind::positions, SectionKind::normals}) {
      auto& z = file.at<layout::Float3>(kind, i).z;
      const float before = std::exchange(z, 1e9f);
      EXPECT_NE(message_after(file).find(number), std::string::npos) << i;
      z = before;
    }
  }
  const std::uint64_t indices = file.entry(SectionKind::indices).count / 4;
  const std::uint64_t in_block = layout::kHashBlock / 4;
  for (const std::uint64_t i :
       {std::uint64_t{0}, in_block - 1, in_block, indices / 2 - 1, indices / 2, indices - 1}) {
    auto& index = file.at<std::uint32_t>(SectionKind::indices, i);
    const std::uint32_t before = std::exchange(index, 263169u);
    const std::string place = "index " + std::to_string(i % (indices / 2)) + " of meshes[" +
                              std::to_string(i / (indices / 2)) + "]";
    EXPECT_NE(message_after(file).find(place), std::string::npos) << i;
    index = before;
  }
}

TEST(Check, MappedFilesThatAreCutAreRefused) {
  const auto path = std::filesystem::temp_directory_path() / "panwright_check_test.pan";
  const std::vector<std::byte> file = support::small_pan();
  for (const std::size_t length : {std::size_t{0}, std::size_t{50}, std::size_t{1000}}) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(length));
    DiagnosticLog log;
    EXPECT_FALSE(Model::open(path, log));
    EXPECT_EQ(exit_code(log), 4);
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace panwright::pan::check_test
