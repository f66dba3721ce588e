// Appearances: fields, inheritance, sharing.

#include <gtest/gtest.h>

#include "tests/pxn/reading.h"

namespace panwright::pxn::material_test {
namespace {

const std::string kSphere = "<sphere rings=\"4\" quads=\"4\"/>";

std::string appearance(const std::string& fields, const std::string& inside) {
  return "<appearance><material>" + fields + "</material><child>" + inside +
         "</child></appearance>";
}
std::string group(const std::string& inside) { return "<group>" + inside + "</group>"; }

const materials::Material& material_of(const Reading& r, std::size_t instance) {
  return r.scene->materials.at(static_cast<std::size_t>(r.scene->instances.at(instance).material));
}

TEST(Material, EveryFieldArrives) {
  const Reading r = read_nodes(
      appearance(
          "<diffuse>0.1 0.2 0.3</diffuse><specular shine=\"25\">0.4 0.5 0.6</specular>"
          "<emissive>7 8 9</emissive><reflect>0.3 0.2 0.1</reflect><refract>1.5 2.5 3.5</refract>",
          kSphere) +
      appearance("<diffuse>1 1 1</diffuse><oren>0.35</oren><specular>1 1 1</specular>"
                 "<cook>1 0.25 1 1</cook><reflect>0.4 0.6 0</reflect>",
                 kSphere) +
      appearance("<diffuse>1 1 1</diffuse><hapke>0.33 0.1 0.95 15</hapke>", kSphere));
  EXPECT_FALSE(r.log.has_errors()) << r.summary();
  const materials::Material& a = material_of(r, 0);
  EXPECT_EQ(a.diffuse, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(a.specular, Vec3(0.4, 0.5, 0.6));
  EXPECT_EQ(a.emissive, Vec3(7, 8, 9));
  EXPECT_EQ(a.weights, Vec3(0.3, 0.2, 0.1));
  EXPECT_EQ(a.refract, Vec3(1.5, 2.5, 3.5));
  EXPECT_EQ(std::get<materials::BlinnPhong>(a.specular_brdf).shine, 25);
  EXPECT_EQ(a.specular_model(), materials::SpecularModel::blinn_phong);
  EXPECT_EQ(std::get<materials::OrenNayar>(material_of(r, 1).diffuse_brdf).sigma, 0.35);
  EXPECT_EQ(std::get<materials::CookTorrance>(material_of(r, 1).specular_brdf).alpha, 0.25);
  EXPECT_EQ(material_of(r, 1).diffuse_model(), materials::DiffuseModel::oren_nayar);
  EXPECT_EQ(material_of(r, 1).specular_model(), materials::SpecularModel::cook_torrance);
  EXPECT_EQ(std::get<materials::Hapke>(material_of(r, 2).diffuse_brdf).w, 0.33);
  EXPECT_DOUBLE_EQ(std::get<materials::Hapke>(material_of(r, 2).diffuse_brdf).roughness,
                   15 * kPi / 180);
  EXPECT_EQ(material_of(r, 2).diffuse_model(), materials::DiffuseModel::hapke);
}

// What the grammar has refused has no schema to read it by.
TEST(Material, RefusedElementsAreLeftOut) {
  const auto check = [](const Reading& r, const char* what) {
    ASSERT_TRUE(r.scene) << what;
    EXPECT_NE(r.summary().find(what), std::string::npos) << r.summary();
    EXPECT_EQ(material_of(r, 0).diffuse, Vec3(0.1, 0.2, 0.3)) << what;
  };
  const std::string diffuse = "<diffuse>0.1 0.2 0.3</diffuse>";
  check(read_nodes(appearance("<difuse>1 1 1</difuse>" + diffuse, kSphere)),
        "E1101 unknown element 'difuse' in <material>");
  check(read_nodes(appearance(diffuse + "<diffuse>1 1 1</diffuse>", kSphere)), "E1104");
  check(read_nodes(appearance("<ggx>0.1</ggx>" + diffuse, kSphere)), "E1101");
  check(
      read_files({{"m.pxn", "<pangu_model ver=\"1\"><material name=\"m\"><difuse>1 1 1</difuse>" +
                                diffuse +
                                "</material><sphere radius=\"1\" material=\"m\"/></pangu_model>"}}),
      "E1101 unknown element 'difuse' in <material>");
}

TEST(Material, FieldsAreInheritedOneByOneThroughIncludes) {
  const std::string inner = appearance("<diffuse>0.3 0 0</diffuse>", kSphere);
  const std::string outer =
      appearance(
          "<diffuse>0 0.2 0</diffuse><specular shine=\"9\">0.5 0.5 0.5</specular>"
          "<reflect>0.5 0.5 0</reflect>",
          group(kSphere + "<include type=\"pxn\" file=\"p.pxn\"/>" + kSphere)) +
      kSphere;
  const Reading r =
      read_files({{"t.pxn", "<pangu_model ver=\"0\">" + outer + "</pangu_model>"},
                  {"p.pxn", "<pangu_model ver=\"0\">" + inner + kSphere + "</pangu_model>"}});
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 5u);
  EXPECT_EQ(material_of(r, 0).diffuse, Vec3(0, 0.2, 0));
  EXPECT_EQ(material_of(r, 1).diffuse, Vec3(0.3, 0, 0)) << "the inner one wins";
  EXPECT_EQ(std::get<materials::BlinnPhong>(material_of(r, 1).specular_brdf).shine, 9)
      << "and inherits the rest";
  EXPECT_EQ(material_of(r, 1).weights, Vec3(0.5, 0.5, 0));
  EXPECT_EQ(material_of(r, 2).diffuse, Vec3(0, 0.2, 0)) << "beside it nothing changed";
  EXPECT_EQ(material_of(r, 3).diffuse, Vec3(0, 0.2, 0));
  EXPECT_EQ(material_of(r, 4).name, "default");
  EXPECT_EQ(material_of(r, 4).diffuse, Vec3(0.8));
  EXPECT_EQ(r.scene->materials.size(), 3u);
  std::set<std::string> names;
  for (const auto& m : r.scene->materials) EXPECT_TRUE(names.insert(m.name).second) << m.name;
}

TEST(Material, EqualOnesAreStoredOnceAndWarnedOfOnce) {
  const std::string loud = "<specular>0.5 0.5 0.5</specular><cook>0.5 0.2 1 1</cook>";
  std::string nodes;
  for (int i = 0; i < 100; ++i) nodes += appearance(loud, group(kSphere + kSphere));
  // the default, written out
  nodes += appearance("<diffuse>0.8 0.8 0.8</diffuse>", kSphere) + kSphere +
           appearance("<reflect>1 0 -0.0</reflect>", kSphere);
  const Reading r = read_nodes(nodes);
  EXPECT_EQ(r.codes(), std::multiset<std::string>{"W1403"});
  EXPECT_EQ(r.scene->materials.size(), 2u);
}

TEST(Material, ABadFieldIsLeftOutAlone) {
  const Reading r = read_nodes(appearance(
      "<diffuse>0.1 x 0.3</diffuse><oren>0.2</oren><specular shine=\"129\">1 1 1</specular>"
      "<reflect>1 0 0</reflect>",
      kSphere));
  EXPECT_EQ(r.codes(), (std::multiset<std::string>{"E1201", "E1202"}));
  EXPECT_EQ(material_of(r, 0).diffuse, Vec3(0.8));
  EXPECT_EQ(std::get<materials::OrenNayar>(material_of(r, 0).diffuse_brdf).sigma, 0.2);
  EXPECT_EQ(material_of(r, 0).specular, Vec3(1));
}

TEST(Material, RangesAreHeld) {
  const auto code = [](const std::string& fields) {
    const Reading r = read_nodes(appearance(fields, kSphere));
    std::string out;
    for (const auto& c : r.codes())
      if (c[0] == 'E') out += c;
    return out;
  };
  EXPECT_EQ(code("<diffuse>-0.1 0 0</diffuse>"), "E1202");
  EXPECT_EQ(code("<refract>0.9 1 1</refract>"), "E1202");
  EXPECT_EQ(code("<cook>1 0 1 1</cook>"), "E1202");
  EXPECT_EQ(code("<cook>1 0.1 1</cook>"), "E1203");
  EXPECT_EQ(code("<oren>2</oren>"), "E1202");
  EXPECT_EQ(code("<oren>0.1 0.2</oren>"), "E1203");
  EXPECT_EQ(code("<hapke>1.1 0 0 0</hapke>"), "E1202");
  EXPECT_EQ(code("<hapke>1 0 0 0</hapke>"), "");
  EXPECT_EQ(code("<specular shine=\"-1\">0 0 0</specular>"), "E1202");
  EXPECT_EQ(code("<specular shine=\"\">0 0 0</specular>"), "E1201");
}

}  // namespace
}  // namespace panwright::pxn::material_test
