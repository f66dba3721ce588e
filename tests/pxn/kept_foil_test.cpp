// Foil that earlier readings made: the same scene, and only what changed is made anew.

#include "pxn/reader/kept_foil.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "geometry/mesh/bytes.h"
#include "tests/pxn/reading.h"

namespace panwright::pxn::kept_foil_test {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSettings =
    "<mli_settings><width>1</width><height>1</height><xgrid>60</xgrid></mli_settings>";
constexpr std::string_view kOperations =
    "<mli_operations><wrinkle wavelength='70mm' amplitude='1mm'/></mli_operations>";

std::string wrap(const std::string& on, const std::string& more = "standoff='1cm'",
                 std::string_view operations = kOperations, std::string_view settings = kSettings) {
  return "<mli type='wrap' on='" + on + "' " + more + ">" + std::string(settings) +
         std::string(operations) + "</mli>";
}

std::string sheet(const std::string& more, std::string_view settings = kSettings,
                  std::string_view operations = kOperations) {
  return "<mli " + more + ">" + std::string(settings) + std::string(operations) + "</mli>";
}

// Two boxes far apart, each in a blanket, a knob just above the first, and two sheets.
std::string model(const std::string& knob, const std::string& far = "10 0 0", int seed = 1) {
  return "<box name='a' size='1 0.8 0.6'/>" + wrap("a") + "<sphere radius='5mm' translate='" +
         knob + "'/><box name='b' size='0.5 0.6 0.7' translate='" + far + "'/>" + wrap("b") +
         "<node translate='0 0 50'>" + sheet("type='flat' seed='7'") +
         sheet("type='flat' seed='" + std::to_string(seed) + "'") + "</node>";
}

// A unit that stands on a plate, and a box far away.
std::string corner(const std::string& unit = "size='0.4 0.3 0.3' translate='0 0 0.2'",
                   const std::string& how = "standoff='1cm'",
                   const std::string& far = "size='0.5'") {
  return "<box name='plate' size='1 1 0.1'/>" + wrap("plate") + "<box name='unit' " + unit + "/>" +
         wrap("unit", how) + "<box name='far' translate='0 9 0' " + far + "/>" + wrap("far");
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
  Read read(const std::string& text, bool cached = true, double crease = 30) const {
    const WorkCache cache(folder);
    Options options;
    options.crease_angle = crease * kDegree;
    if (cached) options.cache = &cache;
    const Reading reading =
        read_files({{"m.pxn", "<pangu_model ver=\"1\">\n" + text + "\n</pangu_model>\n"}}, options);
    EXPECT_TRUE(reading.scene) << reading.summary();
    EXPECT_EQ(reading.log.errors(), 0u) << reading.summary();
    KeyHasher key;
    if (!reading.scene) return {};
    for (const geometry::Shape& shape : reading.scene->shapes) {
      key.hash(geometry::hash_of(shape));
      if (const auto* mesh = std::get_if<geometry::MeshShape>(&shape))
        geometry::add_to_key(**mesh, key);
    }
    for (const scene::Foil& foil : reading.scene->foils) {
      key.list(std::span(&foil.statistics, 1));
      key.list(FoilSheet{foil.recipe, foil.form, {}, {}}.key());
      key.number(static_cast<std::uint64_t>(foil.shape));
      for (const scene::FoilLevel& level : foil.levels) {
        geometry::add_to_key(*level.mesh, key);
        key.real(level.detail);
        key.real(level.error);
      }
    }
    for (const scene::Instance& one : reading.scene->instances) {
      key.number(static_cast<std::uint64_t>(one.shape));
      key.number(static_cast<std::uint64_t>(one.material));
    }
    for (const scene::Node& node : reading.scene->nodes) key.text(node.name);
    return {key.key().hex(), reading.summary(), cache.counts()[Work::foil]};
  }
  void expect_same(const Read& a, const Read& b) const {
    EXPECT_EQ(a.hash, b.hash);
    EXPECT_EQ(a.says, b.says);
  }
  // Of `all` so many are made anew, and the scene is that of a reading without a cache.
  void expect_made(const std::string& text, std::uint64_t made, std::uint64_t all) const {
    SCOPED_TRACE(text);
    const Read changed = read(text);
    expect_same(changed, read(text, false));
    EXPECT_EQ(changed.foil.made, made);
    EXPECT_EQ(changed.foil.reused, all - made);
  }
  void each_entry(const std::function<void(const fs::path&)>& change) const {
    std::vector<fs::path> entries;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file()) entries.push_back(entry.path());
    EXPECT_FALSE(entries.empty());
    for (const fs::path& entry : entries) change(entry);
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
  expect_made(model("0 0 6"), 0, 4);                // far from both
  expect_made(model("0 0 5", "11 2 0"), 0, 4);      // nothing is near the second box
  expect_made(model("0 0 5", "10 0 0", 2), 1, 4);   // another seed of a sheet
  expect_made(model("0 0 0.308"), 1, 4);            // in the way of the first blanket
  expect_made(model("0 0 0.306"), 1, 4);            // and nearer
  expect_made(model("0 0 0.308"), 0, 4);            // as before
  expect_made(model("0.1 0 0.308"), 1, 4);          // at another place
  expect_made(model("0 0 0.308", "10 0 1"), 0, 4);  // the second box has no part in that
}

// What a blanket becomes in an inner corner follows from the faces that wear the other one.
TEST_F(KeptFoil, BlanketsInACornerAreMadeTogether) {
  read(corner());
  expect_made(corner(), 0, 3);
  const std::string unit = "size='0.4 0.3 0.3' translate='0 0 0.2'";
  expect_made(corner(unit, "standoff='1cm' seed='5'"), 1, 3);  // its faces are the same
  // the part is as near as before, and its sides wear nothing
  expect_made(corner(unit, "standoff='1cm' faces='+z'"), 2, 3);
  expect_made(corner("size='0.4 0.3 0.2' translate='0 0 0.15'"), 2, 3);  // another unit
  expect_made(corner("size='0.4 0.3 0.3' translate='0.1 0 0.2'"), 2, 3);
  // nobody's neighbour, which the box tree of all faces holds as well
  expect_made(corner(unit, "standoff='1cm'", "size='0.6'"), 1, 3);
  // above the plate, and no longer beside it: the plate's is like one that is alone
  expect_made(corner("size='0.4 0.3 0.3' translate='0 0 3'"), 2, 3);
  expect_made(corner("size='0.4 0.3 0.3' translate='0 0 4'"), 0, 3);
  expect_made(corner(), 0, 3);
}

// Equal shapes share a blanket; one that has something in the way wears its own.
TEST_F(KeptFoil, SharedBlankets) {
  const std::string text =
      "<repeat count='3' var='k'><box name='b' size='1' translate='{3*k} 0 0'/></repeat>"
      "<box name='shelf' size='0.3 0.3 0.01' translate='3 0 0.51'/>" +
      wrap("b", "standoff='1cm' faces='+z'");
  const Read first = read(text);
  expect_same(first, read(text, false));
  EXPECT_EQ(first.foil.made, 2u);
  expect_made(text, 0, 2);
}

TEST_F(KeptFoil, DamagedEntriesAreReplaced) {
  const std::string text = model("0 0 0.308");
  const Read first = read(text);
  const auto damage = [&](const char* what, const std::function<void(const fs::path&)>& change) {
    SCOPED_TRACE(what);
    each_entry(change);
    const Read again = read(text);
    expect_same(again, first);
    EXPECT_EQ(again.foil.made, 4u);
    EXPECT_EQ(read(text).foil.reused, 4u);
  };
  damage("cut short",
         [](const fs::path& entry) { fs::resize_file(entry, fs::file_size(entry) / 2); });
  damage("empty", [](const fs::path& entry) { fs::resize_file(entry, 0); });
  damage("changed", [](const fs::path& entry) {
    std::fstream file(entry, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(fs::file_size(entry) - 3));
    file.put('#');
  });
}

// What is said of a sheet is said again, and what is said of blankets.
TEST_F(KeptFoil, WarningsStay) {
  const std::string text =
      "<mli type='tube'><mli_settings><width>0.2</width><height>0.3</height><xgrid>40</xgrid>"
      "</mli_settings><mli_operations><random> 60mm </random></mli_operations></mli>"
      "<box name='b' size='0.5' translate='2 0 0'/><sphere name='s' radius='0.1' translate='5 0 "
      "0'/>" +
      wrap("*", "standoff='1cm'", "<mli_operations><random> 50mm </random></mli_operations>");
  const Read without = read(text, false);
  EXPECT_THAT(without.says, testing::HasSubstr("have no blanket"));
  EXPECT_THAT(without.says, testing::HasSubstr("heights meet the base"));
  expect_same(read(text), without);
  const Read again = read(text);
  expect_same(again, without);
  EXPECT_EQ(again.foil.reused, 4u);  // the tube is wrapped as well, and that nothing fits
  EXPECT_EQ(again.foil.made, 0u);
}

TEST_F(KeptFoil, KeysHoldEveryInput) {
  const std::string materials = "<material name='m' preset='mli_silver'/>";
  const std::string box = "size='0.4 0.3 0.2'";
  const auto blanket = [&](const std::string& how, const std::string& shape,
                           std::string_view operations = kOperations,
                           std::string_view settings = kSettings) {
    return materials + "<box name='a' " + shape + "/>" + wrap("a", how, operations, settings);
  };
  const auto foil = [&](const std::string& how, std::string_view settings = kSettings,
                        std::string_view operations = kOperations) {
    return materials + sheet("type='flat' " + how, settings, operations);
  };
  constexpr std::string_view kOther =
      "<mli_operations><wrinkle wavelength='70mm' amplitude='1.5mm'/></mli_operations>";
  constexpr std::string_view kMore =
      "<mli_operations><wrinkle wavelength='70mm' amplitude='1mm'/><random> 0.1mm </random>"
      "</mli_operations>";
  constexpr std::string_view kPreset = "<mli_operations preset='crinkled'/>";
  constexpr std::string_view kWider =
      "<mli_settings><width>1.1</width><height>1</height><xgrid>60</xgrid></mli_settings>";
  constexpr std::string_view kHigher =
      "<mli_settings><width>1</width><height>1.1</height><xgrid>60</xgrid></mli_settings>";
  constexpr std::string_view kFiner =
      "<mli_settings><width>1</width><height>1</height><xgrid>70</xgrid></mli_settings>";
  constexpr std::string_view kFine =
      "<mli_settings><width>1</width><height>1</height><xgrid>100</xgrid></mli_settings>";
  for (const std::string& text : {
           blanket("", box),
           blanket("seed='2'", box),
           blanket("standoff='6mm'", box),
           blanket("faces='+x'", box),
           blanket("tape='m'", box),
           blanket("tape='m' tape_width='2cm'", box),
           blanket("edge='m'", box),
           blanket("", box, kOther),
           blanket("", box, kMore),
           blanket("", box, kOperations, kFine),
           blanket("", box, kPreset, kFine),
           blanket("", "size='0.4 0.3 0.25'"),
           blanket("", box + " scale='1 1 1.1'"),
           foil(""),
           foil("seed='2'"),
           foil("tape='m'"),
           foil("tape='m' tape_width='2cm'"),
           foil("edge='m'"),
           foil("edge='m' thickness='1cm'"),
           foil("", kSettings, kOther),
           foil("", kSettings, kMore),
           foil("", kFine, kPreset),
           foil("", kWider),
           foil("", kHigher),
           foil("", kFiner),
           materials + sheet("type='tube'"),
           materials + sheet("type='disc'"),
           materials + sheet("type='disc' radius='0.3'"),
       }) {
    expect_made(text, 1, 1);
    expect_made(text, 0, 1);
    // another crease angle
    EXPECT_EQ(read(text, true, 20).foil.made, 1u) << text;
  }
  // what is no part of it: names, and where it stands
  expect_made(blanket("", box + " translate='3 2 1' rotate='10 20 30'"), 0, 1);
  expect_made("<node translate='7 0 0'>" + sheet("type='flat' name='other'") + "</node>", 0, 1);
}

geometry::Mesh triangle() {
  geometry::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.texcoords.assign(3, {0, 0});
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

geometry::MeshShape shared(geometry::Mesh mesh) {
  return std::make_shared<const geometry::Mesh>(std::move(mesh));
}

// What lies under a right key with a right checksum, and is no foil.
TEST(FoilBytes, UnsoundBlanketsAreRefused) {
  WovenFoil good;
  FoilMeshes::Part& part = good.meshes.parts[0];
  part = {shared(triangle()), {{shared(triangle()), 0.02, 0.003}}};
  good.meshes.vertices = 6;
  good.triangles = 1;
  good.tally.reasons["curved (no plane)"] = 2;
  good.recipe.width = 3;
  good.asked = {0.01, 0.02};
  const auto reads = [](const WovenFoil& woven) {
    ByteWriter to;
    write(woven, to);
    ByteReader from(to.bytes());
    const WovenFoil back = read_woven(from);
    return from.at_end() && back.triangles == woven.triangles &&
           back.meshes.vertices == woven.meshes.vertices &&
           back.meshes.parts[0].levels.size() == woven.meshes.parts[0].levels.size() &&
           back.tally.reasons == woven.tally.reasons && back.recipe.width == woven.recipe.width &&
           back.asked.corners == woven.asked.corners;
  };
  EXPECT_TRUE(reads(good));
  EXPECT_TRUE(reads({}));  // all was refused
  const auto refused = [&](const char* what, const auto& change) {
    WovenFoil bad = good;
    change(bad);
    EXPECT_FALSE(reads(bad)) << what;
  };
  const auto refused_mesh = [&](const char* what, const auto& change) {
    geometry::Mesh mesh = triangle();
    change(mesh);
    refused(what, [&](auto& w) { w.meshes.parts[0].finest = shared(mesh); });
    refused(what, [&](auto& w) { w.meshes.parts[0].levels[0].mesh = shared(mesh); });
  };
  refused_mesh("index", [](auto& m) { m.triangles[0][1] = 3; });
  refused_mesh("no triangle", [](auto& m) { m.triangles.clear(); });
  refused_mesh("normals", [](auto& m) { m.normals.clear(); });
  refused_mesh("texcoords", [](auto& m) { m.texcoords.clear(); });
  refused_mesh("number", [](auto& m) { m.positions[2].x = NAN; });
  refused("nothing", [](auto& w) { w.meshes.parts = {}; });
  refused("no triangles", [](auto& w) { w.triangles = 0; });
  refused("vertices", [](auto& w) { w.meshes.vertices = NAN; });
  refused("asked", [](auto& w) { w.asked.parts = HUGE_VAL; });
  ByteWriter to;
  write(good, to);
  for (std::size_t size = 0; size < to.bytes().size(); ++size) {
    ByteReader from(to.bytes().first(size));
    read_woven(from);
    EXPECT_FALSE(from.at_end()) << size;
  }
}

TEST(FoilBytes, UnsoundSheetsAreRefused) {
  mli::RecipePlaces places;
  places.recipe = {0, 5, 8};
  MadeFoil good;
  good.meshes.parts[0] = {shared(triangle()), {{shared(triangle()), 0.1, 0.01}}};
  good.meshes.parts[2].finest = shared(triangle());
  good.meshes.vertices = 9;
  good.said = {{Code("W7002"), places.recipe, "too high", {}, "lower"}};
  ByteWriter to;
  ASSERT_TRUE(write(good, places, to));
  ByteReader whole(to.bytes());
  mli::RecipePlaces elsewhere;
  elsewhere.recipe = {0, 15, 18};
  const MadeFoil back = read_made(elsewhere, whole);
  EXPECT_TRUE(whole.at_end());
  EXPECT_EQ(back.meshes.parts[0].levels.at(0).detail, 0.1);
  EXPECT_EQ(back.meshes.parts[1].finest, nullptr);
  EXPECT_EQ(back.said.at(0).where.begin, 15u);
  EXPECT_EQ(back.said.at(0).hint, "lower");
  for (std::size_t size = 0; size < to.bytes().size(); ++size) {
    ByteReader from(to.bytes().first(size));
    read_made(places, from);
    EXPECT_FALSE(from.at_end()) << size;
  }
  const auto refused = [&](const char* what, const auto& change) {
    MadeFoil bad = good;
    change(bad);
    ByteWriter bytes;
    ASSERT_TRUE(write(bad, places, bytes)) << what;
    ByteReader from(bytes.bytes());
    read_made(places, from);
    EXPECT_FALSE(from.at_end()) << what;
  };
  refused("index", [&](auto& m) {
    geometry::Mesh mesh = triangle();
    mesh.triangles[0][0] = 9;
    m.meshes.parts[0].finest = shared(mesh);
  });
  refused("normals", [&](auto& m) {
    geometry::Mesh mesh = triangle();
    mesh.normals.clear();
    m.meshes.parts[0].levels[0].mesh = shared(mesh);
  });
  refused("nothing", [](auto& m) { m.meshes.parts = {}; });
  // what is said of another place cannot be said again
  good.said[0].where = {0, 1, 2};
  ByteWriter other;
  EXPECT_FALSE(write(good, places, other));
}

}  // namespace
}  // namespace panwright::pxn::kept_foil_test
