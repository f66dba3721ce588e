// Materials of level 1: BRDFs, metals, coats, cells, the library.

#include <gtest/gtest.h>

#include "materials/spectra.h"
#include "pxn/materials.h"
#include "pxn/writer.h"
#include "tests/pxn/reading.h"
#include "tests/support/paths.h"

namespace panwright::pxn::named_material_test {
namespace {

using materials::Beckmann;
using materials::Compensation;
using materials::DiffuseModel;
using materials::Eon;
using materials::FresnelModel;
using materials::Ggx;
using materials::Hapke;
using materials::LommelSeeliger;
using materials::SpecularModel;

// One sphere that wears a named material; the material's fields stand in line 3.
Reading wearing(const std::string& fields, const std::string& attributes = "") {
  return read_files(
      {{"m.pxn", "<pangu_model ver=\"1\">\n<material name=\"m\" " + attributes + ">\n" + fields +
                     "\n</material><sphere material=\"m\"/></pangu_model>"}});
}

const materials::Material& worn(const Reading& r) { return r.scene->materials.at(0); }

TEST(NamedMaterial, ReflectanceMaps) {
  const auto with = [](const std::string& brdf_model) {
    return read_files({{"m.pxn",
                        "<pangu_model ver=\"1\">\n<material name=\"m\" "
                        "reflectance_map=\"p.ppm\">\n" +
                            brdf_model + "\n</material><sphere material=\"m\"/></pangu_model>"},
                       {"p.ppm", std::string("P6 1 1 255\n") + "\xff\x80\x40"}});
  };
  const Reading metal = with("<ggx>0.3</ggx><conductor metal=\"Al\"/>");
  EXPECT_EQ(metal.summary(), "");
  ASSERT_EQ(worn(metal).maps.reflectance, 0);
  EXPECT_EQ(worn(metal).maps.albedo, -1);
  EXPECT_FALSE(metal.scene->textures.at(0).linear);
  EXPECT_TRUE(materials::brdf_model_of(worn(metal)).mapped);
  // nothing that it could be the reflectance of
  const Reading paint = with("<diffuse>0.5 0.5 0.5</diffuse>");
  EXPECT_NE(paint.summary().find("N1405 reflectance_map has no effect"), std::string::npos)
      << paint.summary();
}

TEST(NamedMaterial, BrdfModel) {
  const Reading eon = wearing("<diffuse>0.5 0.5 0.5</diffuse><eon>0.7</eon>");
  EXPECT_EQ(eon.summary(), "");
  EXPECT_EQ(worn(eon).diffuse_model(), DiffuseModel::eon);
  EXPECT_EQ(std::get<Eon>(worn(eon).diffuse_brdf).roughness, 0.7);

  const Reading kept =
      wearing("<diffuse>0.5 0.5 0.5</diffuse><oren energy=\"preserving\">0.3</oren>");
  EXPECT_EQ(worn(kept).diffuse_model(), DiffuseModel::eon);
  // 0.45 s²/(s² + 0.09) = 0.225 over 1 − 0.5 s²/(s² + 0.33) = 1 − 0.045/0.42
  EXPECT_NEAR(std::get<Eon>(worn(kept).diffuse_brdf).roughness, 0.225 / (1 - 0.045 / 0.42), 1e-15);

  const Reading ggx = wearing("<ggx energy=\"single\">0.1 0.4</ggx><conductor metal=\"Al\"/>");
  EXPECT_EQ(ggx.summary(), "");
  EXPECT_EQ(worn(ggx).specular_model(), SpecularModel::ggx);
  EXPECT_EQ(std::get<Ggx>(worn(ggx).specular_brdf).alpha_x, 0.1);
  EXPECT_EQ(std::get<Ggx>(worn(ggx).specular_brdf).alpha_y, 0.4);
  EXPECT_EQ(worn(ggx).compensation, Compensation::off);
  EXPECT_EQ(worn(ggx).specular, Vec3(1)) << "facets are not coloured";
  EXPECT_EQ(worn(ggx).weights, Vec3(0, 1, 0));
  EXPECT_EQ(worn(ggx).refract, materials::metal("Al")->n);
  EXPECT_EQ(worn(ggx).extinction, materials::metal("Al")->k);
  EXPECT_EQ(materials::brdf_model_of(worn(ggx)).fresnel, FresnelModel::conductor);

  const Reading one = wearing("<beckmann>0.2</beckmann>");
  EXPECT_EQ(worn(one).specular_model(), SpecularModel::beckmann);
  EXPECT_EQ(std::get<Beckmann>(worn(one).specular_brdf).alpha_y, 0.2)
      << "one number for both directions";

  const Reading mirror = wearing("<mirror/><conductor n=\"0.2\" k=\"3 3 2\"/><coat n=\"1.46\"/>");
  EXPECT_EQ(worn(mirror).specular_model(), SpecularModel::mirror);
  EXPECT_EQ(worn(mirror).extinction, Vec3(3, 3, 2));
  ASSERT_TRUE(worn(mirror).coat);
  EXPECT_EQ(worn(mirror).coat->index, 1.46);

  const Reading cube = wearing(
      "<retroreflector index=\"1.46\" cutoff=\"50deg\" width=\"0.2mrad\"/>"
      "<specular>0.9 0.9 0.9</specular>");
  EXPECT_EQ(cube.summary(), "");
  const auto retro = std::get<materials::Retroreflector>(worn(cube).specular_brdf);
  EXPECT_EQ(retro.index, 1.46);
  EXPECT_EQ(retro.depth, materials::Retroreflector{}.depth) << "the schema's default";
  EXPECT_NEAR(retro.cutoff, 50 * kDegree, 1e-15);
  EXPECT_NEAR(retro.width, 2e-4, 1e-18);
  EXPECT_EQ(worn(cube).specular, Vec3(0.9));
  const Reading both = wearing("<mirror/><retroreflector/>");
  EXPECT_NE(both.summary(), "") << "one kind of highlight";

  const Reading hapke =
      wearing("<hapke b=\"0.25\" c=\"-0.5\" porosity=\"0.3\">0.2 0.1 1 20</hapke>");
  EXPECT_EQ(hapke.summary(), "") << "level 1 says what the numbers are";
  EXPECT_EQ(std::get<Hapke>(worn(hapke).diffuse_brdf).c, -0.5);
  EXPECT_EQ(std::get<Hapke>(worn(hapke).diffuse_brdf).porosity, 0.3);
  EXPECT_EQ(worn(hapke).diffuse, Vec3(1));

  const Reading lommel = wearing("<lommel_seeliger>0.1</lommel_seeliger>");
  EXPECT_EQ(worn(lommel).diffuse_model(), DiffuseModel::lommel_seeliger);
  EXPECT_EQ(std::get<LommelSeeliger>(worn(lommel).diffuse_brdf).w, 0.1);
  EXPECT_EQ(worn(lommel).diffuse, Vec3(1));
}

// Absorption times thickness, whatever the unit; a film's from its k: 4πk/λ.
TEST(NamedMaterial, Coats) {
  const Reading r =
      wearing("<coat n=\"1.7\" slope=\"0.1\" absorption=\"1000 2000 40000\" thickness=\"25um\"/>");
  ASSERT_TRUE(worn(r).coat);
  EXPECT_NEAR(worn(r).coat->depth.x, 0.025, 1e-15);
  EXPECT_NEAR(worn(r).coat->depth.z, 1.0, 1e-15);
  EXPECT_EQ(worn(r).coat->alpha, 0.1);
  const Reading film = wearing("<coat film=\"Kapton\" thickness=\"25um\"/>");
  EXPECT_EQ(film.summary(), "");
  EXPECT_NEAR(worn(film).coat->index, 1.8, 0.15);
  EXPECT_GT(worn(film).coat->depth.z, 2 * worn(film).coat->depth.x) << "amber";
}

TEST(NamedMaterial, InnerBrdfsReplaceOuterOnes) {
  const std::string base =
      "<material name=\"b\"><ggx>0.2</ggx><conductor metal=\"Au\"/>"
      "<provenance source=\"someone\"/></material>";
  const auto read = [&](const std::string& fields) {
    return read_files(
        {{"m.pxn", "<pangu_model ver=\"1\">" + base + "<material name=\"m\" base=\"b\">" + fields +
                       "</material><sphere material=\"m\"/></pangu_model>"}});
  };
  EXPECT_EQ(worn(read("<mirror/>")).specular_model(), SpecularModel::mirror);
  EXPECT_EQ(std::get<Ggx>(worn(read("<ggx>0.3</ggx>")).specular_brdf).alpha_x, 0.3);
  EXPECT_EQ(worn(read("<cook>1 0.3 1 1</cook>")).specular_model(), SpecularModel::cook_torrance);
  EXPECT_EQ(worn(read("<refract>1.5 1.5 1.5</refract>")).extinction, Vec3(0));
  EXPECT_EQ(worn(read("<coat/>")).specular_model(), SpecularModel::ggx);
}

TEST(NamedMaterial, BadInput) {
  EXPECT_EQ(wearing("<ggx>0</ggx>").codes(), std::multiset<std::string>{"E1202"});
  EXPECT_EQ(wearing("<ggx>1.5</ggx>").codes(), std::multiset<std::string>{"E1202"});
  EXPECT_EQ(wearing("<conductor n=\"1\" k=\"-1\"/><mirror/>").codes(),
            std::multiset<std::string>{"E1202"});
  EXPECT_EQ(wearing("<coat n=\"0.9\"/>").codes(), std::multiset<std::string>{"E1202"});
  EXPECT_EQ(wearing("<eon>nan</eon>").codes(), std::multiset<std::string>{"E1201"});
  EXPECT_EQ(wearing("<refract>0.5 1 1</refract><mirror/>").codes(),
            std::multiset<std::string>{"E1202"});
  EXPECT_EQ(wearing("<ggx>0.1 0.2 0.3</ggx>").codes(), std::multiset<std::string>{"E1203"});
  EXPECT_EQ(wearing("<conductor metal=\"Aluminum\"/><mirror/>").codes(),
            std::multiset<std::string>{"E1407"});
  EXPECT_EQ(wearing("<coat film=\"Kaptn\" thickness=\"1um\"/>").summary(),
            "3:13 E1407 optical constants of 'Kaptn' are not known (did you mean 'Kapton'?)\n");
  EXPECT_EQ(wearing("<diffuse>1 1 1</diffuse><specular>1 1 1</specular><cook>1 0.1 1 1</cook>"
                    "<reflect>0.7 0.7 0</reflect>")
                .codes(),
            std::multiset<std::string>{"E1406"});
  EXPECT_EQ(wearing("", "preset=\"white_z39\"").summary(),
            "2:28 E1311 the library has no material 'white_z39' (did you mean 'white_z93'?)\n");
  for (const char* name : {"mli_gold_kapton", "gold_kapton"})
    EXPECT_NE(read_files({{"m.pxn", "<pangu_model ver=\"1\">\n<box size=\"1\" material=\"" +
                                        std::string(name) + "\"/>\n</pangu_model>"}})
                  .summary()
                  .find("preset=\"mli_gold_kapton\"/> below the root"),
              std::string::npos)
        << name;
  EXPECT_EQ(wearing("<ggx>0.1</ggx><mirror/>").codes(), std::multiset<std::string>{"E1108"});
}

// Every material of the library is read without a word, has a source, and keeps its energy.
TEST(Presets, AllAreSound) {
  ASSERT_GE(preset_names().size(), 24u);
  for (const std::string_view name : preset_names()) {
    DiagnosticLog log;
    const auto found = preset(name, log);
    ASSERT_TRUE(found) << name;
    EXPECT_EQ(log.entries().size(), 0u) << name;
    EXPECT_EQ(found->material.name, name);
    EXPECT_FALSE(found->provenance.source.empty()) << name;
    EXPECT_FALSE(found->material.maps.any()) << name;
    const Reading r = read_files({{"p.pxn", std::string(*preset_text(name))}});
    EXPECT_EQ(r.summary(), "") << name;
  }
}

TEST(Presets, FieldsAreOverridden) {
  const Reading r = wearing("<ggx>0.3</ggx>", "preset=\"gold_plating\"");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(slopes_of(worn(r))->x, 0.3);
  EXPECT_EQ(worn(r).refract, materials::metal("Au")->n);
}

// What is written reads back the same, field by field.
TEST(Presets, AreWrittenAndReadBack) {
  std::string text = "<pangu_model ver=\"1\">";
  for (const std::string_view name : preset_names())
    text += "<material name=\"my_" + std::string(name) + "\" preset=\"" + std::string(name) +
            "\"/><sphere material=\"my_" + std::string(name) + "\"/>";
  const Reading first = read_files({{"m.pxn", text + "</pangu_model>"}});
  ASSERT_EQ(first.summary(), "");
  const Reading again = read_files({{"n.pxn", to_text(*first.scene)}});
  EXPECT_EQ(again.summary(), "");
  ASSERT_EQ(again.scene->materials.size(), first.scene->materials.size());
  for (std::size_t i = 0; i < first.scene->materials.size(); ++i)
    EXPECT_TRUE(first.scene->materials[i] == again.scene->materials[i])
        << first.scene->materials[i].name;
}

TEST(DescribedMaterials, OfAFile) {
  DiagnosticLog log;
  const auto all = read_materials(PANWRIGHT_SOURCE_DIR "/examples/servicer/materials.pxn", {}, log);
  ASSERT_TRUE(all);
  EXPECT_FALSE(log.has_errors());
  EXPECT_GT(all->size(), 5u);
}

// n and k of users' own tables.
TEST(NamedMaterial, SpectraFromFiles) {
  const auto with = [](const std::string& fields, const std::string& table) {
    return read_files({{"m.pxn", "<pangu_model ver=\"1\">\n<material name=\"m\">\n" + fields +
                                     "\n</material><sphere material=\"m\"/></pangu_model>"},
                       {"t.csv", table}});
  };
  const std::string table = "um,n,k\n0.4,1.5,0\n0.6,1.9,0.002\n0.7,1.9,0.002\n";
  const Reading metal = with("<mirror/><conductor file=\"t.csv\"/>", table);
  EXPECT_EQ(metal.summary(), "");
  EXPECT_NEAR(glm::length(*worn(metal).refract - Vec3(1.9, 1.8, 1.6)), 0, 1e-12);
  EXPECT_NEAR(glm::length(worn(metal).extinction - Vec3(0.002, 0.0015, 0.0005)), 0, 1e-12);
  EXPECT_EQ(metal.scene->inputs.size(), 2u) << "the table is an input";

  const Reading film =
      with("<mirror/><conductor metal=\"Al\"/><coat file=\"t.csv\" thickness=\"10um\"/>", table);
  EXPECT_EQ(film.summary(), "");
  EXPECT_NEAR(worn(film).coat->index, 1.8, 1e-12);
  // 4π k d/λ
  EXPECT_NEAR(worn(film).coat->depth.y, 4 * kPi * 0.0015 * 10e-6 / 0.55e-6, 1e-12);

  EXPECT_EQ(with("<mirror/><conductor file=\"t.csv\"/>", "0.4 1 1\n0.3 1 1\n").summary(),
            "3:27 E1409 optical constants 't.csv', line 2: a wavelength of 0.3 "
            "micrometres after 0.4, expected a larger one\n");
  EXPECT_EQ(with("<mirror/><conductor file=\"none.csv\"/>", table).summary(),
            "3:27 E1301 file 'none.csv' not found in this file's folder\n");
  EXPECT_EQ(
      with("<mirror/><conductor file=\"t.csv\" metal=\"Al\"/>", table).summary(),
      "3:11 E1108 <conductor> needs exactly one of @metal, @file or @n, not @metal and @file\n");
  EXPECT_EQ(with("<mirror/><coat file=\"t.csv\"/>", table).summary(),
            "3:11 E1108 <coat> has @file, which needs @thickness\n");
  EXPECT_EQ(with("<mirror/><coat file=\"t.csv\" thickness=\"1um\"/>", "0.4 5\n0.7 5\n").summary(),
            "3:22 E1409 a coat has an index of 1 to 4, and this one 5 at 550 nm\n");
}

}  // namespace
}  // namespace panwright::pxn::named_material_test
