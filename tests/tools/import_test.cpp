// CAD files through the program.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tools/mesh_report_page.h"

namespace panwright::import_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::TemporaryFolder;
using testing::HasSubstr;

const std::string kRelay = PANWRIGHT_SOURCE_DIR "/examples/cad/relay.wrl";

support::Outcome panwright(std::vector<std::string> words, const char* name = "panwright",
                           const std::vector<std::string>& environment = {}) {
  words.insert(words.begin(), std::string(PANWRIGHT_BIN_DIR "/") + name);
  return support::run(words, environment);
}

json result_of(std::vector<std::string> words, const std::vector<std::string>& environment = {}) {
  words.push_back("--json");
  const support::Outcome outcome = panwright(words, "panwright", environment);
  const json out = json::parse(outcome.out, nullptr, false);
  EXPECT_FALSE(out.is_discarded()) << outcome.out << outcome.err;
  return out;
}

TEST(Import, what_it_says_without_an_output) {
  const json r = result_of({"import", kRelay, "--units", "mm"});
  EXPECT_EQ(r["errors"], 0);
  EXPECT_EQ(r["format"], "VRML 97");
  EXPECT_EQ(r["instances"], 11);
  // 4600 mm across the wings, by the coordinates in the file
  EXPECT_NEAR(r["size"][0].get<double>(), 4.6, 1e-12);
  EXPECT_EQ(r["materials"].size(), 7u);
}

TEST(Import, the_same_model_straight_and_through_the_language) {
  const TemporaryFolder folder;
  fs::copy_file(kRelay, folder / "relay.wrl");
  const json straight = result_of(
      {"import", folder / "relay.wrl", "--units", "mm", "--keep-hidden", "-o", folder / "a.pan"});
  folder.write("b.pxn",
               "<pangu_model ver=\"1\"><import file=\"relay.wrl\" units=\"mm\" "
               "hidden=\"keep\"/></pangu_model>");
  const json through = result_of({"compile", folder / "b.pxn", "-o", folder / "b.pan"});
  EXPECT_EQ(straight["triangles"], through["triangles"]);
  EXPECT_EQ(straight["unique_triangles"], through["unique_triangles"]);
  const json a = result_of({"info", folder / "a.pan"});
  const json b = result_of({"info", folder / "b.pan"});
  EXPECT_EQ(a["bounds"], b["bounds"]);
}

TEST(Import, hidden_parts_go_unless_they_are_kept) {
  const TemporaryFolder folder;
  const json kept =
      result_of({"import", kRelay, "--units", "mm", "--keep-hidden", "-o", folder / "a.pan"});
  const json gone = result_of({"import", kRelay, "--units", "mm", "-o", folder / "b.pan"});
  // the tank and the box of electronics
  EXPECT_EQ(gone["removed"]["instances_before"].get<int>(),
            gone["removed"]["instances_after"].get<int>() + 2);
  EXPECT_LT(gone["triangles"], kept["triangles"]);
  EXPECT_FALSE(kept.contains("removed"));
}

// What a search found is kept for the next one: it changes no byte and no word.
TEST(Import, hidden_parts_are_searched_once) {
  const TemporaryFolder folder;
  const std::string cache = folder / "cache";
  const std::vector<std::string> words = {"import", kRelay, "--units",
                                          "mm",     "-o",   folder / "a.pan"};
  const auto run = [&](const std::string& environment, bool no_cache, bool cached) {
    std::vector<std::string> all = words;
    if (no_cache) all.push_back("--no-cache");
    const json out = result_of(all, {environment});
    EXPECT_EQ(out["removed"]["cached"], cached) << environment;
    json diagnostics = out["diagnostics"];
    diagnostics.push_back(support::contents(folder / "a.pan"));
    return diagnostics.dump(-1, ' ', false, json::error_handler_t::replace);
  };
  const auto entries = [&](const std::string& in) {
    std::size_t count = 0;
    if (fs::exists(in))
      for (const auto& entry : fs::recursive_directory_iterator(in))
        count += entry.is_regular_file();
    return count;
  };
  const std::string here = "PANWRIGHT_CACHE=" + cache;
  const std::string without = run("PANWRIGHT_CACHE=off", false, false);
  EXPECT_EQ(run(here, true, false), without);
  EXPECT_EQ(entries(cache + "/work"), 0u);
  EXPECT_EQ(run(here, false, false), without);
  EXPECT_EQ(entries(cache + "/work"), 1u);
  EXPECT_EQ(run(here, false, true), without);
  EXPECT_EQ(run(here, true, false), without);
  // what else opens the file finds it too, and another reading of the file is another model
  EXPECT_EQ(panwright({"info", kRelay, "--units", "mm"}, "panwright", {here}).code, 0);
  EXPECT_EQ(
      panwright({"export", kRelay, "--units", "mm", "-o", folder / "a.glb"}, "panwright", {here})
          .code,
      0);
  // beside it the compiled model, which they keep
  EXPECT_EQ(entries(cache + "/work"), 2u);
  EXPECT_EQ(panwright({"info", kRelay, "--units", "cm"}, "panwright", {here}).code, 0);
  EXPECT_EQ(entries(cache + "/work"), 4u);
  // where it cannot be kept
  EXPECT_EQ(run("PANWRIGHT_CACHE=/proc/none", false, false), without);
  EXPECT_EQ(run("PANWRIGHT_CACHE=" + kRelay, false, false), without);
  // the user's own
  const auto own = [&](std::vector<std::string> environment) {
    environment.push_back("PANWRIGHT_CACHE");
    EXPECT_EQ(panwright(words, "panwright", environment).code, 0);
  };
  fs::create_directory(folder / "home");
  own({"XDG_CACHE_HOME=" + folder / "xdg", "HOME=" + folder / "home"});
  EXPECT_EQ(entries(folder / "xdg/panwright/work"), 1u);
  own({"XDG_CACHE_HOME=relative", "HOME=" + folder / "home"});
  EXPECT_EQ(entries(folder / "home/.cache/panwright/work"), 1u);
  own({"XDG_CACHE_HOME=", "HOME=" + folder / "nowhere"});
  EXPECT_FALSE(fs::exists(folder / "nowhere"));
}

TEST(Import, a_text_around_a_file_compiles) {
  const TemporaryFolder folder;
  fs::copy_file(kRelay, folder / "relay.wrl");
  EXPECT_EQ(panwright({"import", folder / "relay.wrl", "--units", "mm", "--crease", "20", "-o",
                       folder / "relay.pxn"})
                .code,
            0);
  const std::string text = support::contents(folder / "relay.pxn");
  EXPECT_THAT(text, HasSubstr("file=\"relay.wrl\" units=\"mm\" crease=\"20deg\""));
  EXPECT_EQ(panwright({"fmt", "--check", folder / "relay.pxn"}).code, 0) << text;
  const json compiled = result_of({"compile", folder / "relay.pxn"});
  EXPECT_EQ(compiled["errors"], 0);
  // elsewhere the text could not name the file
  fs::create_directory(folder / "below");
  EXPECT_EQ(panwright({"import", folder / "relay.wrl", "-o", folder / "below/relay.pxn"}).code, 2);
}

// The text says the unit that was assumed, and is not asked again.
// It was refused whatever --root was.
TEST(Import, a_text_beside_the_folder_of_its_file_lies_with_it_in_root) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "x");
  fs::create_directories(folder / "y");
  fs::copy_file(kRelay, folder / "x/relay.wrl");
  const std::string text = folder / "y/here.pxn";
  const support::Outcome refused = panwright({"import", folder / "x/relay.wrl", "-o", text});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("give --root with a folder that holds both"));
  EXPECT_FALSE(fs::exists(text));
  const std::string root = folder / ".";
  const support::Outcome made =
      panwright({"import", folder / "x/relay.wrl", "--units", "mm", "--root", root, "-o", text});
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("read it with --root " + root));
  EXPECT_THAT(support::contents(text), HasSubstr("file=\"../x/relay.wrl\""));
  EXPECT_EQ(panwright({"compile", text, "--root", root, "-o", folder / "y/a.pan"}).code, 0);
  // and straight: the same triangles
  const json straight = result_of({"info", folder / "y/a.pan"});
  EXPECT_EQ(straight["errors"], 0);
}

// Every command that takes --root obeys it, for files of CAD files and of texts around them.
TEST(Import, files_are_taken_from_the_root_by_every_command) {
  const TemporaryFolder folder;
  for (const char* name : {"robots", "meshes", "texts"}) fs::create_directories(folder / name);
  folder.write("meshes/w.stl",
               "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
               "0\nendloop\nendfacet\nendsolid s\n");
  const std::string robot =
      folder.write("robots/m.urdf",
                   "<robot name='r'><link name='b'><visual><geometry><mesh "
                   "filename='package://sat/meshes/w.stl'/></geometry></visual></link></robot>");
  const std::string text = folder.write(
      "texts/m.pxn", "<pangu_model ver=\"1\"><import file=\"../robots/m.urdf\"/></pangu_model>");
  const std::vector<std::vector<std::string>> runs = {
      {"info"},
      {"check"},
      {"render", "-o", folder / "a.npy", "--size", "8x8"},
      {"export", "-o", folder / "a.glb"},
      {"joints"},
      {"compile", "-o", folder / "a.pan"},
      {"import", "-o", folder / "b.pan"}};
  for (const std::string& model : {robot, text})
    for (std::vector<std::string> words : runs) {
      const std::string command = words[0];
      if (command == (model == robot ? "compile" : "import")) continue;
      words.insert(words.begin() + 1, model);
      const support::Outcome refused = panwright(words);
      EXPECT_NE(refused.code, 0) << command << model;
      words.insert(words.end(), {"--root", folder / ""});
      const support::Outcome made = panwright(words);
      EXPECT_EQ(made.code, 0) << command << " " << model << "\n" << made.err;
      EXPECT_THAT(made.err, testing::Not(HasSubstr("E6010"))) << command << model;
    }
}

TEST(Import, a_text_around_a_file_without_a_unit_says_it) {
  const TemporaryFolder folder;
  const auto triangle = [](const std::string& size) {
    return "v 0 0 0\nv " + size + " 0 0\nv 0 " + size + " 0\nf 1 2 3\n";
  };
  for (const auto& [size, unit] : {std::pair{"2", "m"}, std::pair{"2000", "mm"}}) {
    folder.write("t.obj", triangle(size));
    const support::Outcome made = panwright({"import", folder / "t.obj", "-o", folder / "t.pxn"});
    EXPECT_EQ(made.code, 0);
    EXPECT_THAT(made.err, HasSubstr("[W6006]"));
    EXPECT_THAT(support::contents(folder / "t.pxn"),
                HasSubstr("units=\"" + std::string(unit) + "\""));
    const support::Outcome read = panwright({"info", folder / "t.pxn"});
    EXPECT_THAT(read.err, testing::Not(HasSubstr("[W6006]")));
  }
}

TEST(Import, other_formats_are_named_with_a_converter_by_every_command) {
  const TemporaryFolder folder;
  const std::string fbx = folder.write("a.fbx", "; FBX 7.3.0 project file\n");
  for (const std::vector<std::string>& words : {std::vector<std::string>{"import", fbx},
                                                {"check", fbx},
                                                {"info", fbx},
                                                {"render", fbx},
                                                {"export", fbx, "-o", folder / "a.glb"}}) {
    const support::Outcome outcome = panwright(words);
    EXPECT_NE(outcome.code, 0) << words[0];
    EXPECT_THAT(outcome.err, HasSubstr("FBX is not supported")) << words[0];
    EXPECT_THAT(outcome.err, HasSubstr("Blender")) << words[0];
  }
}

// docs/pan-format.md: equal identities mean equal models.
TEST(Import, what_decides_a_model_is_in_its_identity) {
  const TemporaryFolder folder;
  std::set<std::string> identities;
  const std::vector<std::vector<std::string>> ways = {{},
                                                      {"--units", "mm"},
                                                      {"--keep-hidden"},
                                                      {"--no-weld"},
                                                      {"--up-axis", "z"},
                                                      {"--recentre"},
                                                      {"--crease-normals"},
                                                      {"--primitives", "9"}};
  for (const auto& way : ways) {
    std::vector<std::string> words = {"import", kRelay, "-o", folder / "a.pan"};
    words.insert(words.end(), way.begin(), way.end());
    EXPECT_EQ(panwright(words).code, 0);
    identities.insert(result_of({"info", folder / "a.pan"})["build_id"].get<std::string>());
  }
  EXPECT_EQ(identities.size(), ways.size());
}

TEST(Import, reports_in_three_kinds) {
  const TemporaryFolder folder;
  const std::string bad = PANWRIGHT_SOURCE_DIR "/tests/importers/data/bad/W6302.wrl";
  for (const char* name : {"r.txt", "r.json", "r.html"})
    EXPECT_EQ(panwright({"import", bad, "--report", folder / name}).code, 0);
  EXPECT_THAT(support::contents(folder / "r.txt"), HasSubstr("edge"));
  const json report = json::parse(support::contents(folder / "r.json"));
  EXPECT_EQ(report["total"]["non_manifold_edges"], 1);
  const std::string page = support::contents(folder / "r.html");
  EXPECT_THAT(page, HasSubstr(R"("non_manifold_edges":1)"));
#ifdef PANWRIGHT_GL
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,"));
#endif
}

// Its images take long for large models.
TEST(Import, a_report_stops_when_it_is_asked_to) {
  DiagnosticLog log;
  workspace::OpenReport report;
  const std::string bad = PANWRIGHT_SOURCE_DIR "/tests/importers/data/bad/W6302.wrl";
  const auto imported = workspace::read_cad(bad, {}, log, {}, &report);
  ASSERT_TRUE(imported && report.mesh_report);
  const auto page = [&](const Job& job) {
    DiagnosticLog said;
    const auto text =
        tools::mesh_report_page(*report.mesh_report, imported->scene, bad, {}, said, job);
    EXPECT_EQ(static_cast<bool>(text), !job.cancelled());
    EXPECT_EQ(said.contains(Code("E0001")), job.cancelled());
  };
  std::size_t told = 0;
  page(Job({0, [&](const Progress&) { ++told; }}));
  EXPECT_GT(told, 0u) << "the job goes with the work";
  // wherever it is
  for (std::size_t stop = 0; stop < told; ++stop) {
    std::size_t count = 0;
    Job job;
    job = Job({1, [&](const Progress&) {
                 if (count++ == stop) job.cancel();
               }});
    page(job);
    EXPECT_TRUE(job.cancelled());
  }
}

TEST(Import, what_could_be_read_of_a_bad_file_is_written_and_the_exit_code_is_1) {
  const TemporaryFolder folder;
  const std::string bad = PANWRIGHT_SOURCE_DIR "/tests/importers/data/bad/E6113.wrl";
  const support::Outcome outcome = panwright({"import", bad, "-o", folder / "a.pan"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("[E6113]"));
  EXPECT_EQ(result_of({"check", folder / "a.pan"})["errors"], 0);
}

TEST(Import, a_model_without_any_surface_says_so) {
  const TemporaryFolder folder;
  folder.write("empty.wrl", "#VRML V2.0 utf8\nTransform { children [ ] }\n");
  const support::Outcome empty =
      panwright({"import", folder / "empty.wrl", "-o", folder / "empty.pan"});
  EXPECT_EQ(empty.code, 1);
  EXPECT_THAT(empty.err, HasSubstr("E6011"));
  EXPECT_THAT(empty.err, HasSubstr("no surface"));
  const support::Outcome full =
      panwright({"import", kRelay, "--units", "mm", "--keep-hidden", "-o", folder / "a.pan"});
  EXPECT_EQ(full.err.find("no surface"), std::string::npos);
}

TEST(Import, what_is_wrong_with_a_glb_says_where) {
  const TemporaryFolder folder;
  std::string text = R"({"asset":{"version":"2.0"},"nodes":[{"mesh":3}]})";
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::size_t value) {
    std::string out;
    for (int k = 0; k < 4; ++k) out += static_cast<char>(value >> (8 * k) & 255);
    return out;
  };
  const std::string file = folder.write(
      "a.glb", "glTF" + word(2) + word(20 + text.size()) + word(text.size()) + "JSON" + text);
  EXPECT_THAT(panwright({"import", file}).err, HasSubstr("(at /nodes/0/mesh) [E6205]"));
}

TEST(Import, options_without_effect_are_noted) {
  const TemporaryFolder folder;
  const support::Outcome other =
      panwright({"import", kRelay, "--units", "mm", "--scene", "a", "-o", folder / "a.pan"});
  EXPECT_EQ(other.code, 0);
  EXPECT_THAT(other.err, HasSubstr("--scene has no effect on a VRML file [N1405]"));
  const support::Outcome compiled = panwright({"info", folder / "a.pan", "--weld", "0.1"});
  EXPECT_EQ(compiled.code, 0);
  EXPECT_THAT(compiled.err, HasSubstr("--weld has no effect on a .pan file [N1405]"));
}

TEST(Import, a_model_over_the_limit_of_triangles_is_written_in_part_and_says_so) {
  const TemporaryFolder folder;
  fs::copy_file(kRelay, folder / "relay.wrl");
  const std::string text = folder.write(
      "b.pxn", "<pangu_model ver=\"1\"><import file=\"relay.wrl\" units=\"mm\"/></pangu_model>");
  for (const support::Outcome& outcome :
       {panwright(
            {"import", kRelay, "--units", "mm", "--max-triangles", "300", "-o", folder / "a.pan"}),
        panwright({"compile", text, "--max-triangles", "300", "-o", folder / "b.pan"})}) {
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("[E2003]"));
    EXPECT_THAT(outcome.err, HasSubstr("without the parts that failed"));
  }
  EXPECT_EQ(result_of({"check", folder / "a.pan"})["errors"], 0);
}

TEST(Import, converters_by_name) {
  const TemporaryFolder folder;
  fs::copy_file(kRelay, folder / "relay.wrl");
  fs::create_directories(folder.path() / "work");
  // into the working directory
  const support::Outcome outcome =
      support::run({"/bin/sh", "-c", "cd \"$0\" && exec \"$@\"", folder / "work",
                    PANWRIGHT_BIN_DIR "/vrmltopan", folder / "relay.wrl", "--keep-hidden"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("wrote relay.pan ("));
  EXPECT_TRUE(fs::exists(folder / "work/relay.pan"));
  EXPECT_FALSE(fs::exists(folder / "relay.pan"));
  EXPECT_EQ(panwright({"export", folder / "work/relay.pan", "-o", folder / "out.glb"}).code, 0);
  EXPECT_EQ(
      panwright({folder / "out.glb", "--keep-hidden", "-o", folder / "out.pan"}, "gltftopan").code,
      0);
  EXPECT_TRUE(fs::exists(folder / "out.pan"));
}

TEST(Import, inputs_are_not_overwritten_and_other_kinds_are_refused) {
  const TemporaryFolder folder;
  fs::copy_file(kRelay, folder / "relay.pan");
  EXPECT_EQ(panwright({"import", folder / "relay.pan", "-o", folder / "relay.pan"}).code, 2);
  EXPECT_EQ(panwright({"import", kRelay, "-o", folder / "a.obj"}).code, 2);
  EXPECT_EQ(panwright({"import", folder / "none.wrl"}).code, 3);
  EXPECT_EQ(panwright({"import", kRelay, "--weld", "nan"}).code, 2);
  EXPECT_EQ(panwright({"import", kRelay, "--units", "furlong"}).code, 2);
}

TEST(Export, comes_back_as_it_went) {
  const TemporaryFolder folder;
  const std::string model = PANWRIGHT_SOURCE_DIR "/examples/cubesat/cubesat.pxn";
  const json before = result_of({"compile", model, "-o", folder / "a.pan"});
  EXPECT_EQ(result_of({"export", folder / "a.pan", "-o", folder / "a.glb"})["errors"], 0);
  const json after = result_of({"import", folder / "a.glb", "--units", "m", "--keep-hidden",
                                "--no-weld", "-o", folder / "b.pan"});
  EXPECT_EQ(before["triangles"], after["triangles"]);
  EXPECT_EQ(before["unique_triangles"], after["unique_triangles"]);
  const json a = result_of({"info", folder / "a.pan"})["bounds"];
  const json b = result_of({"info", folder / "b.pan"})["bounds"];
  // two turns by 90 degrees leave a rounding
  for (const char* end : {"min", "max"})
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(a[end][k].get<double>(), b[end][k].get<double>(), 1e-9);
}

}  // namespace
}  // namespace panwright::import_test
