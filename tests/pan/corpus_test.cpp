// Files of older formats open for good, and hold what they held (tests/pan/data/README.md).
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "pan/model.h"
#include "tests/support/paths.h"

namespace panwright::pan::corpus_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<fs::path> old_files(const std::string& format = "1.0") {
  std::vector<fs::path> files;
  for (const auto& entry :
       fs::directory_iterator(fs::path(PANWRIGHT_SOURCE_DIR "/tests/pan/data") / format))
    if (entry.path().extension() == ".pan") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

json told(const fs::path& file) {
  return json::parse(std::ifstream(fs::path(file).replace_extension(".json")));
}

std::string fnv1a64(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::byte byte : bytes)
    hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
  return fmt::format("{:016x}", hash);
}

layout::SectionKind kind_named(const std::string& old_name) {
  static const std::map<std::string, std::string> kRenamed = {
      {"colours", "colors"}, {"need", "budget"}, {"mesh_needs", "mesh_tolerances"}};
  const auto renamed = kRenamed.find(old_name);
  const std::string& name = renamed == kRenamed.end() ? old_name : renamed->second;
  for (const layout::SectionInfo& info : layout::kSections)
    if (name == info.name) return info.kind;
  ADD_FAILURE() << name;
  return layout::SectionKind::build;
}

TEST(Corpus, NoFileIsLost) {
  EXPECT_EQ(old_files().size(), 9u);
  EXPECT_EQ(old_files("1.1").size(), 9u);
}

void expect_held(const Model& model, const json& sections) {
  EXPECT_GE(sections.size(), 20u);
  for (const auto& [name, section] : sections.items()) {
    const auto kind = kind_named(name);
    const auto bytes = model.section(kind);
    ASSERT_TRUE(model.entry(kind)) << name;
    EXPECT_EQ(model.entry(kind)->count, section["count"].get<std::uint64_t>()) << name;
    // the records of later formats are longer; what they had is at their beginning
    const std::uint64_t had = section["count"] == 0 ? 0
                                                    : section["bytes"].get<std::uint64_t>() /
                                                          section["count"].get<std::uint64_t>();
    const std::uint64_t have =
        layout::kSections[layout::place_of(static_cast<std::uint32_t>(kind))].stride;
    ASSERT_GE(have, had) << name;
    std::vector<std::byte> old;
    for (std::uint64_t i = 0; i < model.entry(kind)->count; ++i)
      old.insert(old.end(), &bytes[i * have], &bytes[i * have] + had);
    EXPECT_EQ(fnv1a64(old), section["fnv1a64"].get<std::string>()) << name;
  }
}

// Compressed sections, and mesh streams of every form.
TEST(Corpus, CompressedFilesHoldWhatTheyHeld) {
  std::set<std::uint32_t> forms;
  for (const fs::path& file : old_files("1.1")) {
    SCOPED_TRACE(file.filename().string());
    DiagnosticLog log;
    const auto model = Model::load(file, log);
    ASSERT_TRUE(model) << to_text(log);
    EXPECT_EQ(log.entries().size(), 0u);
    EXPECT_EQ(model->header().minor, 1);
    expect_held(*model, told(file)["sections"]);
    for (const layout::MeshStream& stream : model->mesh_streams()) forms.insert(stream.form);
  }
  EXPECT_EQ(forms.size(), 3u);
}

TEST(Corpus, FilesHoldWhatTheyHeld) {
  for (const fs::path& file : old_files()) {
    SCOPED_TRACE(file.filename().string());
    DiagnosticLog log;
    const auto model = Model::load(file, log);
    ASSERT_TRUE(model) << to_text(log);
    EXPECT_EQ(log.entries().size(), 0u);
    EXPECT_EQ(model->header().minor, 0);
    EXPECT_FALSE(model->compressed());
    expect_held(*model, told(file)["sections"]);
  }
}

TEST(Corpus, SectionsOfTheirSizeAreReadWhereTheyLie) {
  for (const fs::path& file : old_files()) {
    DiagnosticLog log;
    const auto model = Model::load(file, log);
    ASSERT_TRUE(model) << to_text(log);
    if (model->unpacked_bytes() > 0) continue;  // a later format has grown some record
    for (const layout::SectionInfo& info : layout::kSections) {
      const auto bytes = model->section(info.kind);
      if (bytes.empty()) continue;
      EXPECT_EQ(bytes.data(), model->bytes().data() + model->entry(info.kind)->offset);
    }
  }
}

TEST(Corpus, EveryKindOfThingIsInIt) {
  std::set<std::string> seen, diffuse, specular;
  for (const fs::path& file : old_files()) {
    DiagnosticLog log;
    const auto model = Model::load(file, log);
    ASSERT_TRUE(model) << to_text(log);
    for (const layout::SectionInfo& info : layout::kSections)
      if (!model->section(info.kind).empty()) seen.insert(info.name);
    for (const layout::Mesh& mesh : model->meshes())
      seen.insert("indices of " + std::to_string(mesh.index_size));
    for (const layout::Material& material : model->materials()) {
      diffuse.insert(std::to_string(material.diffuse_brdf));
      specular.insert(std::to_string(material.specular_brdf));
    }
  }
  EXPECT_EQ(seen.size(), 21u + 2u);  // the kinds of 1.0, and indices of 2 and 4 bytes
  EXPECT_EQ(diffuse.size(), 5u);
  EXPECT_EQ(specular.size(), 6u);
}

}  // namespace
}  // namespace panwright::pan::corpus_test
