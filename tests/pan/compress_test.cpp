// Compressed sections: the same model in fewer bytes, and damage that is always found.
#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <thread>

#include "base/parallel.h"
#include "pan/diff.h"
#include "pan/internal/packing.h"
#include "pan/model.h"
#include "tests/pan/load.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::compress_test {
namespace {

using layout::SectionKind;

// Whether a file is refused, by errors of pan files alone.
bool refused(std::span<const std::byte> bytes) {
  DiagnosticLog log;
  auto model = Model::from_bytes(bytes, "x.pan", log);
  const bool sound = model && model->check(log);
  EXPECT_EQ(sound, !log.has_errors());
  if (!sound) {
    EXPECT_EQ(exit_code(log), 4) << to_text(log);
  }
  return !sound;
}

TEST(Compress, TheSameModelInFewerBytes) {
  const std::vector<std::byte> plain = write_to_memory(support::regular_contents());
  const std::vector<std::byte> packed = support::compressed_pan();
  EXPECT_LT(packed.size(), plain.size() / 3);
  const Model a = load(plain), b = load(packed);
  EXPECT_FALSE(a.compressed());
  EXPECT_TRUE(b.compressed());
  EXPECT_EQ(a.unpacked_bytes(), 0u);
  EXPECT_GT(b.unpacked_bytes(), plain.size() / 2);
  EXPECT_EQ(a.build_id(), b.build_id());
  for (const layout::SectionInfo& info : layout::kSections)
    EXPECT_TRUE(std::ranges::equal(a.section(info.kind), b.section(info.kind))) << info.name;
  const Differences differences = diff(a, b);
  EXPECT_TRUE(differences.same_model());
  EXPECT_TRUE(differences.provenance.empty());
  ASSERT_FALSE(differences.storage.empty());
  EXPECT_EQ(differences.storage[0].where, "format");
  EXPECT_EQ(differences.storage[0].what, "1.0 in a, 1.1 in b");
  EXPECT_TRUE(diff(b, load(packed)).empty());
}

TEST(Compress, HeadersSayWhatAReaderNeeds) {
  const Model plain = load(write_to_memory(support::regular_contents()));
  EXPECT_EQ(plain.header().minor, 0);
  EXPECT_EQ(plain.header().required_features, 0u);
  const Model packed = load(support::compressed_pan());
  EXPECT_EQ(packed.header().minor, 1);
  EXPECT_EQ(packed.header().required_features, layout::kFeatureCompressed);
  // short sections stay as they are, and so does the file of nothing else
  EXPECT_EQ(packed.entry(SectionKind::budget)->codec, 0u);
  EXPECT_NE(packed.entry(SectionKind::nodes)->codec, 0u);
  EXPECT_EQ(write_to_memory(support::small_contents(), {.compress = true}), support::small_pan());
}

TEST(Compress, BytesDoNotDependOnThreads) {
  const Contents contents = support::large_contents(30'000'000);
  std::vector<std::vector<std::byte>> files;
  for (const std::size_t threads : {1u, 2u, 5u}) {
    run_on_threads(Job({threads, {}}),
                   [&] { files.push_back(write_to_memory(contents, {.compress = true})); });
  }
  EXPECT_TRUE(files[0] == files[1] && files[0] == files[2]);
  const Model model = load(files[0]);
  EXPECT_TRUE(diff(load(write_to_memory(contents)), model).same_model());
  EXPECT_GT(internal::PackedChunks::of(
                model.bytes().subspan(model.entry(SectionKind::positions)->offset,
                                      model.entry(SectionKind::positions)->packed_length),
                12, model.entry(SectionKind::positions)->raw_length)
                ->count(),
            3u);
}

TEST(Compress, AnyBytesComeBack) {
  std::mt19937 random(7);
  for (const std::size_t size :
       {4096u, 4097u, 100'000u, 786'431u, 786'432u, 786'433u, 2'000'003u}) {
    for (const std::uint32_t planes : {1u, 4u, 6u, 12u, 88u, 4096u}) {
      // runs of equal differences, noise, and more of the former
      std::vector<std::byte> raw(size);
      for (std::size_t i = 0; i < size; ++i)
        raw[i] = static_cast<std::byte>(i / planes * (i % planes) +
                                        (i % 1024 < 64 ? random() % 256 : 0));
      const auto packed = internal::pack_section(raw, planes);
      if (packed.empty()) continue;
      const auto chunks = internal::PackedChunks::of(packed, planes, size);
      ASSERT_TRUE(chunks);
      std::vector<std::byte> back(size);
      for (std::size_t i = 0; i < chunks->count(); ++i) ASSERT_TRUE(chunks->unpack(i, back));
      EXPECT_EQ(raw, back) << size << " " << planes;
    }
  }
  // noise is left alone
  std::vector<std::byte> noise(1 << 20);
  for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
  EXPECT_TRUE(internal::pack_section(noise, 12).empty());
}

TEST(Compress, StoredBytesAreAtLeastA256thOfTheContent) {
  // 1,000,000 zeros come to some 60 bytes
  Contents contents;
  contents.nodes = {{"root"}};
  const std::vector<std::uint8_t> black(4'000'000);
  contents.textures = {{"black.png", 1000, 1000, false, black}};
  const auto file = write_to_memory(contents, {.compress = true});
  const Model model = load(file);
  EXPECT_EQ(model.entry(SectionKind::texels)->stored_length, 15'680u);  // 15,625 rounded up to 64
  EXPECT_TRUE(std::ranges::equal(model.texels(0), black));
}

TEST(Compress, EveryChangedByteIsRefused) {
  std::vector<std::byte> file = support::compressed_pan();
  for (std::size_t at = 0; at < file.size(); ++at) {
    const std::byte before = file[at];
    file[at] ^= std::byte{static_cast<unsigned char>(1u << at % 8)};
    EXPECT_TRUE(refused(file)) << at;
    file[at] = before;
  }
}

TEST(Compress, EveryTruncationIsRefused) {
  const std::vector<std::byte> file = support::compressed_pan();
  for (std::size_t length = 0; length < file.size(); ++length)
    EXPECT_TRUE(refused(std::span(file).first(length))) << length;
}

// Each stored byte of each compressed section becomes others, and the checksums are made right
// again: what remains is found by unpacking, or is another sound model.
TEST(Compress, HostileChunksNeverBreakTheReader) {
  support::OpenPan pristine(support::compressed_pan());
  std::size_t tried = 0, found = 0;
  for (std::size_t i = 0; i < pristine.header().section_count; ++i) {
    const layout::DirectoryEntry entry = pristine.entry(i);
    if (entry.codec == 0) continue;
    for (std::uint64_t at = 0; at < entry.packed_length; ++at) {
      for (const unsigned change : {1u, 0x80u, 0xffu}) {
        support::OpenPan file = pristine;
        const_cast<std::byte&>(file.bytes()[entry.offset + at]) ^= static_cast<std::byte>(change);
        file.seal();
        ++tried;
        found += refused(file.bytes()) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(tried, 2000u);
  EXPECT_GT(found, tried / 2);
}

TEST(Compress, ChecksAgainAndAgain) {
  Model model = load(support::compressed_pan());
  const layout::Node* nodes = model.nodes().data();
  const layout::Float3* positions = model.positions().data();
  DiagnosticLog log;
  EXPECT_TRUE(model.check(log));
  EXPECT_EQ(model.nodes().data(), nodes);
  EXPECT_EQ(model.positions().data(), positions);
  const Model moved = std::move(model);
  EXPECT_EQ(moved.nodes().data(), nodes);
  EXPECT_EQ(moved.node_name(3), "knot 0");
}

TEST(Compress, NothingIsUnpackedBeforeTheCheck) {
  DiagnosticLog log;
  const auto model = Model::from_bytes(support::compressed_pan(), "x", log);
  ASSERT_TRUE(model);
  EXPECT_TRUE(model->nodes().empty());
  EXPECT_EQ(model->entry(SectionKind::nodes)->count, 83u);
  EXPECT_EQ(model->builds().size(), 1u);
}

TEST(Compress, CopiesInMemoryKeepTheirLimit) {
  const auto path = std::filesystem::temp_directory_path() / "panwright_compress_test.pan";
  DiagnosticLog log;
  ASSERT_TRUE(write(support::regular_contents(), path, log, {.compress = true}));
  const std::uint64_t size = std::filesystem::file_size(path);
  DiagnosticLog refusing;
  EXPECT_FALSE(Model::read(path, size, refusing));
  EXPECT_TRUE(refusing.contains(Code("E0104")));
  EXPECT_TRUE(Model::read(path, 1 << 20, log)) << to_text(log);
  std::filesystem::remove(path);
}

// A model that several own outlives its file's name, and is read by all of them at once.
TEST(Shared, OwnersReadAModelWhoseFileIsGone) {
  for (const bool compress : {false, true}) {
    const auto path = std::filesystem::temp_directory_path() / "panwright_shared_test.pan";
    DiagnosticLog log;
    ASSERT_TRUE(write(support::regular_contents(), path, log, {.compress = compress}));
    auto loaded = Model::load(path, log);
    ASSERT_TRUE(loaded) << to_text(log);
    auto model = std::make_shared<const Model>(*std::move(loaded));
    // another model takes the name, then nothing does
    ASSERT_TRUE(write(support::small_contents(), path, log));
    std::filesystem::remove(path);
    const Model reference = load(write_to_memory(support::regular_contents()));
    const auto bounds = reference.world_bounds();
    std::vector<std::thread> threads;
    std::vector<int> same(4);
    for (std::size_t t = 0; t < same.size(); ++t)
      threads.emplace_back([&, t, mine = model] {
        const auto found = mine->world_bounds();
        same[t] = found && found->low == bounds->low && found->high == bounds->high &&
                  mine->node_path(5) == reference.node_path(5) &&
                  mine->find_frame("eye 7") == reference.find_frame("eye 7") &&
                  std::ranges::equal(mine->texels(1), reference.texels(1)) &&
                  diff(*mine, reference).same_model();
      });
    model.reset();  // the last owner is a thread
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(same, std::vector<int>(4, 1));
  }
}

// At any moment of its unpacking: the model says no, and can be checked again.
TEST(Compress, ACancelledCheckCanBeDoneAgain) {
  const std::vector<std::byte> packed = support::compressed_pan();
  const Model reference = load(packed);
  for (int i = 0; i < 20; ++i) {
    DiagnosticLog log;
    auto model = Model::from_bytes(packed, "x.pan", log);
    ASSERT_TRUE(model) << to_text(log);
    const Job job(JobOptions{});
    if (i == 0) job.cancel();
    std::thread other([&] {
      std::this_thread::sleep_for(std::chrono::microseconds(50 * i));
      job.cancel();
    });
    DiagnosticLog stopped;
    const bool done = model->check(stopped, job);
    other.join();
    EXPECT_EQ(done, !stopped.contains(Code("E0001")));
    EXPECT_EQ(done, model->checked());
    DiagnosticLog again;
    ASSERT_TRUE(model->check(again)) << to_text(again);
    EXPECT_TRUE(diff(*model, reference).same_model());
  }
}

}  // namespace
}  // namespace panwright::pan::compress_test
