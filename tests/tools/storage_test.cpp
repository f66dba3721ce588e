// How the program takes pan files of either format: the corpus of 1.0, compressed files, bombs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pan/model.h"
#include "pan/writer.h"
#include "tests/support/pan_sample.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tests/support/sanitizers.h"

namespace panwright::tools::storage_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using pan::layout::SectionKind;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;

// Whether everything that was said is still said: objects may have more members.
void expect_said(const json& then, const json& now, const std::string& where) {
  if (then.is_object()) {
    for (const auto& [then_key, value] : then.items()) {
      const std::string key = then_key == "need" ? "budget" : then_key;  // its name now
      ASSERT_TRUE(now.contains(key)) << where << "/" << key;
      expect_said(value, now[key], where + "/" + key);
    }
  } else if (then.is_array()) {
    ASSERT_EQ(then.size(), now.size()) << where;
    for (std::size_t i = 0; i < then.size(); ++i)
      expect_said(then[i], now[i], where + "/" + std::to_string(i));
  } else {
    EXPECT_EQ(then, now) << where;
  }
}

TEST(Storage, InfoSaysOfOldFilesWhatItSaid) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(PANWRIGHT_SOURCE_DIR "/tests/pan/data/1.0")) {
    if (entry.path().extension() != ".pan") continue;
    ++files;
    const json then = json::parse(std::ifstream(fs::path(entry.path()).replace_extension(".json")));
    const Outcome outcome = panwright({"info", entry.path().string(), "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.out;
    expect_said(then["info"], json::parse(outcome.out), entry.path().filename().string());
  }
  EXPECT_EQ(files, 9u);
}

TEST(Storage, InfoSaysHowOldFilesAreStored) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(PANWRIGHT_SOURCE_DIR "/tests/pan/data/1.1")) {
    if (entry.path().extension() != ".pan") continue;
    ++files;
    const json then = json::parse(std::ifstream(fs::path(entry.path()).replace_extension(".json")));
    const Outcome outcome = panwright({"info", entry.path().string(), "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.out;
    EXPECT_EQ(json::parse(outcome.out).value("storage", ""), then["storage"]) << entry.path();
  }
  EXPECT_EQ(files, 9u);
}

TEST(Storage, CompressedModelsAreEqualModels) {
  const TemporaryFolder folder;
  const std::string cubesat = PANWRIGHT_SOURCE_DIR "/examples/cubesat/cubesat.pxn";
  const std::string plain = folder / "a.pan", packed = folder / "b.pan";
  ASSERT_EQ(panwright({"compile", cubesat, "-o", plain}).code, 0);
  ASSERT_EQ(panwright({"compile", cubesat, "-o", packed, "--compress"}).code, 0);
  EXPECT_LT(fs::file_size(packed), fs::file_size(plain) / 2);

  const json a = json::parse(panwright({"info", plain, "--json"}).out);
  const json b = json::parse(panwright({"info", packed, "--json"}).out);
  EXPECT_EQ(a["format"], "1.0");
  EXPECT_EQ(b["format"], "1.1");
  EXPECT_EQ(a["compressed"], false);
  EXPECT_EQ(b["compressed"], true);
  EXPECT_EQ(a["build_id"], b["build_id"]);
  EXPECT_EQ(b["sections"][11]["name"], "positions");
  EXPECT_EQ(b["sections"][11]["compressed"], true);
  EXPECT_LT(b["sections"][11]["stored_bytes"], a["sections"][11]["stored_bytes"]);
  for (const char* key : {"bounds", "nodes", "instances", "meshes", "textures", "frames"})
    EXPECT_EQ(a[key], b[key]) << key;

  EXPECT_THAT(panwright({"check", plain}).out, testing::StartsWith(plain + ": ok, "));
  EXPECT_THAT(panwright({"check", packed}).out,
              testing::StartsWith(packed + ": ok (compressed), "));
  EXPECT_THAT(panwright({"info", packed}).out, HasSubstr("format    1.1, "));

  const Outcome same = panwright({"diff", plain, packed});
  EXPECT_EQ(same.code, 0);
  EXPECT_EQ(same.out, "the models are equal (their storage differs: --all shows it)\n");
  const Outcome all = panwright({"diff", plain, packed, "--all"});
  EXPECT_EQ(all.code, 1);
  EXPECT_THAT(all.out, HasSubstr("storage: format: 1.0 in a, 1.1 in b\n"));
  EXPECT_THAT(all.out,
              HasSubstr("storage: section 'positions': not compressed in a, compressed, "));
}

TEST(Storage, SectionsThatAreIgnoredAreNamed) {
  const TemporaryFolder folder;
  const auto written = [&](std::uint32_t kind) {
    support::OpenPan file(support::small_pan());
    file.add_section(kind, true, 64, std::vector<std::byte>(64));
    const auto& bytes = file.seal().bytes();
    return folder.write("m.pan",
                        std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  };
  EXPECT_THAT(panwright({"info", written(1000)}).out,
              HasSubstr("ignored   sections of this file: kind 1000\n"));
  // terrain is none of them, and has a form
  EXPECT_THAT(panwright({"info", written(pan::layout::kReservedKinds[0].value)}).err,
              HasSubstr("E9610"));
}

// A texture of 16384 x 16384 black texels in 4 MiB: the most that the format lets a file claim.
std::vector<std::byte> bomb() {
  constexpr std::uint64_t kRaw = 4ull * 16384 * 16384, kChunk = 786432;
  std::vector<std::byte> stored;
  std::vector<std::uint32_t> words;
  for (std::uint64_t at = 0; at < kRaw; at += kChunk) {
    const std::uint64_t length = std::min(kChunk, kRaw - at), begin = stored.size();
    const auto put = [&](std::uint64_t value, int bytes) {
      for (int k = 0; k < bytes; ++k) stored.push_back(static_cast<std::byte>(value >> 8 * k));
    };
    put(0xfd2fb528,
        4);  // RFC 8878: the magic, a content size of 4 bytes, blocks of one byte repeated
    put(0xa0, 1);
    put(length, 4);
    for (std::uint64_t done = 0; done < length; done += 131072) {
      const std::uint64_t block = std::min<std::uint64_t>(131072, length - done);
      put(block << 3 | 1u << 1 | (done + block == length ? 1 : 0), 3);
      put(0, 1);
    }
    words.push_back(static_cast<std::uint32_t>(1u << 30 | (stored.size() - begin)));
  }
  const auto list = std::as_bytes(std::span(words));
  stored.insert(stored.end(), list.begin(), list.end());
  const std::uint64_t packed = stored.size();
  stored.resize(kRaw / 256);
  support::OpenPan file(support::small_pan());
  file.replace_section(SectionKind::texels, stored);
  auto& entry = file.entry(SectionKind::texels);
  entry.codec = 1;
  entry.packed_length = packed;
  entry.raw_length = entry.count = kRaw;
  auto& texture = file.at<pan::layout::Texture>(SectionKind::textures, 0);
  texture.width = texture.height = 16384;
  texture.bytes = kRaw;
  file.header().required_features = 1;
  file.header().minor = 1;
  return file.seal().bytes();
}

TEST(Storage, BombsAreRefusedWhereThereIsNoMemory) {
#ifdef PANWRIGHT_SANITIZED
  GTEST_SKIP() << "sanitizers reserve more address space than the limit below";
#endif
  const TemporaryFolder folder;
  const auto bytes = bomb();
  const std::string path = folder.write(
      "bomb.pan", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  // less address space than the gibibyte, and enough for the program
  const Outcome outcome = support::run(
      {"/bin/sh", "-c", "ulimit -v 1000000; exec \"$0\" check \"$1\" --json --threads 1",
       PANWRIGHT_BIN_DIR "/panwright", path});
  EXPECT_EQ(outcome.code, 4) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("E4015"));
  EXPECT_THAT(outcome.out, HasSubstr("1073741824 bytes, which exceeds the available memory"));
}

TEST(Storage, FilesThatAreCutShortWhileTheyAreMappedAreNamed) {
  const TemporaryFolder folder;
  // the shell's open returns when the program has opened the pipe; the signal is what a touch of a
  // lost page sends
  const Outcome outcome = support::run(
      {"/bin/sh", "-c", "mkfifo \"$1\"; \"$0\" check \"$1\" & exec 3>\"$1\"; kill -BUS $!; wait $!",
       PANWRIGHT_BIN_DIR "/panwright", folder / "pipe.pxn"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("[E0102]"));
}

}  // namespace
}  // namespace panwright::tools::storage_test
