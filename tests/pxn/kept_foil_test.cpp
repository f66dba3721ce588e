// Foil that earlier readings made: the same scene, and only what changed is made anew.

#include "pxn/build/kept_foil.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "geometry/mesh/bytes.h"
#include "tests/pxn/reading.h"

namespace panwright::pxn {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSettings =
    "<mli_settings><width>1</width><height>1</height><xgrid>60</xgrid></mli_settings>"
    "<mli_operations><wrinkle wavelength='70mm' amplitude='1mm'/></mli_operations>";

std::string wrap(const std::string& on) {
  return "<mli type='wrap' standoff='1cm' on='" + on + "'>" + std::string(kSettings) + "</mli>";
}

std::string sheet(int seed) {
  return "<mli type='flat' seed='" + std::to_string(seed) + "'>" + std::string(kSettings) +
         "</mli>";
}

// Two boxes far apart, each in a blanket, a knob just above the first, and two sheets.
std::string model(const std::string& knob, const std::string& far = "10 0 0", int seed = 1) {
  return "<box name='a' size='1 0.8 0.6'/>" + wrap("a") + "<sphere radius='5mm' translate='" +
         knob + "'/><box name='b' size='0.5 0.6 0.7' translate='" + far + "'/>" + wrap("b") +
         "<node translate='0 0 50'>" + sheet(7) + sheet(seed) + "</node>";
}

class KeptFoil : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "panwright-foil-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder = name;
  }
  void TearDown() override { fs::remove_all(folder); }

  // What a scene says and all that it holds of meshes and foil, as one hash; and the counts.
  struct Read {
    std::string hash;
    std::string says;
    WorkCounts::Count foil;
  };
  Read read(const std::string& text, bool cached = true) const {
    const WorkCache cache(folder);
    Options options;
    if (cached) options.cache = &cache;
    const Reading reading =
        read_files({{"m.pxn", "<pangu_model ver=\"1\">\n" + text + "\n</pangu_model>\n"}}, options);
    EXPECT_TRUE(reading.scene) << reading.summary();
    KeyHasher key;
    for (const geometry::Shape& shape : reading.scene->shapes) {
      key.hash(geometry::hash_of(shape));
      if (const auto* mesh = std::get_if<geometry::MeshShape>(&shape))
        geometry::add_to_key(**mesh, key);
    }
    for (const scene::Foil& foil : reading.scene->foils) {
      key.list(std::span(&foil.statistics, 1));
      key.list(FoilSheet{foil.recipe, foil.form, {}}.key());
      for (const scene::FoilLevel& level : foil.levels) {
        geometry::add_to_key(*level.mesh, key);
        key.real(level.detail);
        key.real(level.error);
      }
    }
    for (const scene::Node& node : reading.scene->nodes) key.text(node.name);
    return {key.key().hex(), reading.summary(), cache.counts()[Work::foil]};
  }
  void expect_same(const Read& a, const Read& b) const {
    EXPECT_EQ(a.hash, b.hash);
    EXPECT_EQ(a.says, b.says);
  }
  fs::path folder;
};

TEST_F(KeptFoil, TheSameWithAndWithout) {
  const std::string text = model("0 0 5");
  const Read without = read(text, false);
  EXPECT_EQ(without.foil.made, 0u);
  const Read first = read(text);
  expect_same(first, without);
  EXPECT_EQ(first.foil.made, 4u);
  const Read again = read(text);
  expect_same(again, without);
  EXPECT_EQ(again.foil.reused, 4u);
  EXPECT_EQ(again.foil.made, 0u);
}

TEST_F(KeptFoil, OneChangedPartIsMadeAlone) {
  read(model("0 0 5"));
  const auto expect_made = [&](const std::string& text, std::uint64_t made) {
    const Read changed = read(text);
    expect_same(changed, read(text, false));
    EXPECT_EQ(changed.foil.made, made);
    EXPECT_EQ(changed.foil.reused, 4 - made);
  };
  expect_made(model("0 0 6"), 0);                // far from both
  expect_made(model("0 0 5", "11 2 0"), 0);      // nothing is near the second box
  expect_made(model("0 0 5", "10 0 0", 2), 1);   // another seed of a sheet
  expect_made(model("0 0 0.308"), 1);            // in the way of the first blanket
  expect_made(model("0 0 0.306"), 1);            // and nearer
  expect_made(model("0 0 0.308"), 0);            // as before
  expect_made(model("0.1 0 0.308"), 1);          // at another place
  expect_made(model("0 0 0.308", "10 0 1"), 0);  // the second box has no part in that
}

TEST_F(KeptFoil, DamagedEntriesAreReplaced) {
  const std::string text = model("0 0 0.308");
  const Read first = read(text);
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(entry.file_size() - 3));
    file.put('#');
  }
  const Read again = read(text);
  expect_same(again, first);
  EXPECT_EQ(again.foil.made, 4u);
  EXPECT_EQ(read(text).foil.reused, 4u);
}

// What is said of a sheet is said again.
TEST_F(KeptFoil, WarningsOfSheetsStay) {
  const std::string text =
      "<mli type='tube'><mli_settings><width>0.2</width><height>0.3</height><xgrid>40</xgrid>"
      "</mli_settings><mli_operations><random> 60mm </random></mli_operations></mli>";
  const Read without = read(text, false);
  EXPECT_NE(without.says.find("W7002"), std::string::npos);
  expect_same(read(text), without);
  const Read again = read(text);
  expect_same(again, without);
  EXPECT_EQ(again.foil.reused, 1u);
}

}  // namespace
}  // namespace panwright::pxn
