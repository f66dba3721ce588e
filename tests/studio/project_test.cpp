// Models that are read again when their files change.
#include "studio/project.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "tests/support/process.h"

namespace panwright::studio {
namespace {

std::string project_model(const std::string& size) {
  return "<pangu_model ver=\"1\"><include file=\"part.pxn\"/><box size=\"" + size +
         "\"/></pangu_model>\n";
}
const std::string kProjectPart = "<pangu_model ver=\"1\"><sphere radius=\"1\"/></pangu_model>\n";

bool reaches(const Project& project, const std::function<bool(const Project::State&)>& what) {
  for (int i = 0; i < 3000; ++i) {
    if (what(project.state())) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

TEST(Project, FollowsItsFilesAndWhatTheyInclude) {
  const support::TemporaryFolder folder;
  folder.write("part.pxn", kProjectPart);
  const std::string top = folder.write("model.pxn", project_model("1"));
  Project project({top}, {});
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.world && !s.reading; }));
  const auto first = project.state();
  EXPECT_FALSE(first.failed);
  EXPECT_EQ(first.watched.size(), 2u);

  folder.write("part.pxn", "<pangu_model ver=\"1\"><sphere radius=\"2\"/></pangu_model>\n");
  ASSERT_TRUE(reaches(project, [&](const auto& s) { return s.world != first.world; }));
  EXPECT_NE((*project.state().world)[0].model()->build_id(), (*first.world)[0].model()->build_id());
}

// Where one of several targets cannot be read at first, the others are shown.
TEST(Project, ShowsThoseThatCanBeRead) {
  const support::TemporaryFolder folder;
  folder.write("part.pxn", kProjectPart);
  const std::string good = folder.write("good.pxn", project_model("1"));
  const std::string bad = folder.write("bad.pxn", "<pangu_model ver=\"1\"><boxx/></pangu_model>\n");
  Project project({bad, good}, {});
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.world && !s.reading; }));
  const auto state = project.state();
  EXPECT_TRUE(state.failed);
  EXPECT_TRUE(state.partial);
  ASSERT_EQ(state.world->size(), 1u);
  EXPECT_EQ((*state.world)[0].name(), "good");
  EXPECT_EQ(state.watched.size(), 3u);
  EXPECT_FALSE(state.messages.empty());
  folder.write("bad.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>\n");
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.world && s.world->size() == 2; }));
  EXPECT_FALSE(project.state().failed);
  EXPECT_FALSE(project.state().partial);
}

// A CAD file with an error is drawn where possible, until a version without an error.
TEST(Project, ShowsCadFilesInSpiteOfErrors) {
  const support::TemporaryFolder folder;
  const auto gltf = [](const std::string& index) {
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
      "materials": [{"extensions": {"KHR_materials_ior": {"ior": )" +
           index +
           R"(}}}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
        "min": [0, 0, 0], "max": [1, 1, 0]}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
      "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
  };
  const std::string path = folder.write("a.gltf", gltf("0.5"));
  Project project({path}, {});
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.readings == 1; }));
  EXPECT_TRUE(project.state().failed);
  EXPECT_TRUE(project.state().partial);
  const auto first = project.state().world;
  ASSERT_TRUE(first);
  folder.write("a.gltf", gltf("0.25"));
  ASSERT_TRUE(reaches(project, [&](const auto& s) { return s.world != first; }));
  EXPECT_TRUE(project.state().partial);
  folder.write("a.gltf", gltf("1.5"));
  ASSERT_TRUE(reaches(project, [](const auto& s) { return !s.failed; }));
  EXPECT_FALSE(project.state().partial);
}

// An error keeps the last version and its messages, until it is corrected.
TEST(Project, KeepsTheLastGoodOne) {
  const support::TemporaryFolder folder;
  folder.write("part.pxn", kProjectPart);
  const std::string top = folder.write("model.pxn", project_model("1"));
  Project project({top}, {});
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.world != nullptr; }));
  const auto good = project.state().world;

  folder.write("model.pxn", "<pangu_model ver=\"1\">\n<boxx/>\n</pangu_model>\n");
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.failed; }));
  auto state = project.state();
  EXPECT_EQ(state.world, good);
  ASSERT_FALSE(state.messages.empty());
  EXPECT_EQ(state.messages[0].code, "E1101");
  EXPECT_EQ(state.messages[0].file, top);
  EXPECT_EQ(state.messages[0].line, 2u);

  std::filesystem::remove(top);
  ASSERT_TRUE(reaches(project, [&](const auto& s) {
    return !s.messages.empty() && s.messages[0].code == "E0101";
  }));
  EXPECT_EQ(project.state().world, good);

  folder.write("model.pxn", "<pangu_model ver=\"1\"><inc");
  ASSERT_TRUE(reaches(project, [&](const auto& s) {
    return !s.messages.empty() && s.messages[0].code != "E0101";
  }));
  folder.write("model.pxn", project_model("3"));
  ASSERT_TRUE(reaches(project, [&](const auto& s) { return !s.failed && s.world != good; }));

  // an include that includes what includes it
  folder.write("part.pxn", "<pangu_model ver=\"1\"><include file=\"model.pxn\"/></pangu_model>\n");
  ASSERT_TRUE(reaches(project, [&](const auto& s) { return s.failed; }));
  EXPECT_TRUE(project.state().world);
  folder.write("part.pxn", kProjectPart);
  ASSERT_TRUE(reaches(project, [&](const auto& s) { return !s.failed; }));
}

TEST(Project, NoFileAtFirst) {
  const support::TemporaryFolder folder;
  Project project({folder / "later.pxn"}, {});
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.failed && s.readings == 1; }));
  EXPECT_FALSE(project.state().world);
  folder.write("later.pxn", kProjectPart);
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.world != nullptr; }));
}

// A file written in two quick steps is not reported as broken in between; a file that stays
// incomplete is.
TEST(Project, HalfWrittenFiles) {
  const support::TemporaryFolder folder;
  folder.write("part.pxn", kProjectPart);
  const std::string top = folder.write("model.pxn", project_model("1"));
  Project project({top}, {});
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.world && !s.reading; }));
  const std::string half = project_model("2").substr(0, 30);
  bool broken = false;
  for (int i = 2; i < 12; ++i) {
    const auto before = project.state();
    folder.write("model.pxn", half);
    folder.write("model.pxn", project_model(std::to_string(i)));
    ASSERT_TRUE(reaches(project, [&](const auto& s) {
      return broken = broken || s.failed, s.world != before.world;
    }));
  }
  EXPECT_FALSE(broken);
  folder.write("model.pxn", half);
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.failed; }));
  EXPECT_TRUE(project.state().world);
}

// A change is measured from when the file was written.
TEST(Project, ReportsTheTimeOfTheChange) {
  const support::TemporaryFolder folder;
  folder.write("part.pxn", kProjectPart);
  const std::string top = folder.write("model.pxn", project_model("1"));
  Project project({top}, {});
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.world && !s.reading; }));
  EXPECT_EQ(project.state().saved, 0);
  folder.write("part.pxn", "<pangu_model ver=\"1\"><sphere radius=\"2\"/></pangu_model>\n");
  const auto time = workspace::stamp_of(folder / "part.pxn").time;
  ASSERT_TRUE(reaches(project, [&](const auto& s) { return s.saved == time; }));
  EXPECT_GE(project.state().noticed, 0);
  EXPECT_GE(project.state().read, project.state().noticed);
}

// Two projects of one file follow the same change; a replaced file counts as changed.
TEST(Project, TwoOfOneFile) {
  const support::TemporaryFolder folder;
  folder.write("part.pxn", kProjectPart);
  const std::string top = folder.write("model.pxn", project_model("1"));
  Project one({top}, {}), other({top}, {});
  for (Project* each : {&one, &other})
    ASSERT_TRUE(reaches(*each, [](const auto& s) { return s.world && !s.reading; }));
  std::filesystem::rename(folder.write("model.pxn~", project_model("2")), top);
  for (Project* each : {&one, &other})
    ASSERT_TRUE(
        reaches(*each, [](const auto& s) { return s.readings > 1 && !s.reading && !s.failed; }));
  EXPECT_EQ((*one.state().world)[0].model()->build_id(),
            (*other.state().world)[0].model()->build_id());
}

// Files beyond the limit of bytes are reported; they are sparse.
TEST(Project, ModelOfManyGigabytes) {
  const support::TemporaryFolder folder;
  for (const char* name : {"large.pxn", "large.wrl", "large.glb"}) {
    const std::string path = folder.write(name, "");
    std::error_code error;
    std::filesystem::resize_file(path, 9ull << 30, error);
    if (error) GTEST_SKIP() << error.message();
    Project project({path}, {});
    ASSERT_TRUE(reaches(project, [](const auto& s) { return s.readings == 1; })) << name;
    EXPECT_TRUE(project.state().failed) << name;
    ASSERT_FALSE(project.state().messages.empty()) << name;
    EXPECT_EQ(project.state().messages[0].severity, Severity::error) << name;
  }
}

// Ends while it reads; the number of errors is bounded.
TEST(Project, ManyErrorsAndEarlyEnds) {
  const support::TemporaryFolder folder;
  std::string text = "<pangu_model ver=\"1\">\n";
  for (int i = 0; i < 5000; ++i) text += "<boxx/>\n";
  const std::string top = folder.write("bad.pxn", text + "</pangu_model>\n");
  {
    Project project({top}, {});
    ASSERT_TRUE(reaches(project, [](const auto& s) { return s.failed; }));
    EXPECT_LE(project.state().messages.size(), 401u);
    EXPECT_GE(project.state().messages.size(), 200u);
  }
  for (int i = 0; i < 20; ++i) Project project({top}, {});
}

}  // namespace
}  // namespace panwright::studio
