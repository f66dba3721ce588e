// The mapping of materials against the BRDF of glTF's specification, appendix B, in closed form.

#include <gtest/gtest.h>

#include <cmath>

#include "materials/brdf.h"
#include "tests/importers/gltf/sample.h"

namespace panwright::importers {
namespace {

struct Look {
  Vec3 base{1};
  double metallic = 1;
  double roughness = 1;
};

// B.2 and B.3, written down from the specification.
Vec3 specified(const Look& look, const Vec3& l, const Vec3& v) {
  const Vec3 n(0, 0, 1), h = glm::normalize(l + v);
  const double nl = l.z, nv = v.z, nh = h.z, vh = glm::dot(v, h);
  const double alpha = look.roughness * look.roughness, a2 = alpha * alpha;
  const double d = a2 / (kPi * std::pow(nh * nh * (a2 - 1) + 1, 2));
  const double visible =
      1 / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2)) / 2;
  const double specular = d * visible, bend = std::pow(1 - vh, 5);
  const Vec3 metal = specular * (look.base + (Vec3(1) - look.base) * bend);
  const double fresnel = 0.04 + 0.96 * bend;
  const Vec3 dielectric = glm::mix(look.base / kPi, Vec3(specular), fresnel);
  return glm::mix(dielectric, metal, look.metallic);
}

materials::Material mapped(const Look& look) {
  Sample sample = triangle();
  sample.json["materials"] = {{{"pbrMetallicRoughness",
                                {{"baseColorFactor", {look.base.x, look.base.y, look.base.z, 1}},
                                 {"metallicFactor", look.metallic},
                                 {"roughnessFactor", look.roughness}}}}};
  sample.json["meshes"][0]["primitives"][0]["material"] = 0;
  const Loaded out = load(sample.glb());
  EXPECT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  EXPECT_EQ(out.imported->materials[0].metallic, look.metallic);
  return out.imported->scene.materials[0];
}

// The largest difference of f cos θ over that of a white plate, 1/π, up to 75 degrees; of the peak
// where it is higher.
double difference(const Look& look) {
  const materials::Material material = mapped(look);
  const Vec3 n(0, 0, 1);
  double worst = 0;
  for (int i = 0; i <= 5; ++i)
    for (int j = 0; j <= 5; ++j)
      for (int k = 0; k <= 6; ++k) {
        const double a = 15 * i * kDegree, b = 15 * j * kDegree, turn = 30 * k * kDegree;
        const Vec3 l(std::sin(a), 0, std::cos(a));
        const Vec3 v(std::sin(b) * std::cos(turn), std::sin(b) * std::sin(turn), std::cos(b));
        const Vec3 wanted = specified(look, l, v) * l.z;
        const Vec3 got = materials::f64::brdf(material, l, v, n) * l.z;
        for (int c = 0; c < 3; ++c)
          worst = std::max(worst, std::fabs(got[c] - wanted[c]) / std::max(1 / kPi, wanted[c]));
      }
  return worst;
}

TEST(GltfMaterials, DielectricsFollowTheSpecification) {
  // what is left: the exact reflectance of glass against Schlick's curve for it, and 0.96 for
  // 1 − F of the diffuse part, which glTF lets fall towards grazing
  double worst = 0;
  for (const double roughness : {0.1, 0.3, 0.6, 1.0})
    worst = std::max(worst, difference({Vec3(0.8, 0.5, 0.2), 0, roughness}));
  std::printf("dielectrics: %.4f\n", worst);
  EXPECT_LE(worst, 0.28);  // measured 0.274, at 75 degrees to both sides
}

TEST(GltfMaterials, MetalsFollowTheSpecification) {
  double worst = 0;
  for (const double roughness : {0.1, 0.3, 0.6, 1.0})
    for (const Vec3& base : {Vec3(1.0, 0.77, 0.34), Vec3(0.91, 0.92, 0.92), Vec3(1)})
      worst = std::max(worst, difference({base, 1, roughness}));
  std::printf("metals: %.4f\n", worst);
  EXPECT_LE(worst, 0.052);  // measured 0.0513
}

TEST(GltfMaterials, AWhiteMirrorIsExact) {
  // F = 1 everywhere: facets alone, whose distribution and shadowing are glTF's
  for (const double roughness : {0.1, 0.3, 0.6, 1.0})
    EXPECT_LE(difference({Vec3(1), 1, roughness}), 1e-9) << roughness;
}

TEST(GltfMaterials, ExtensionsAreMappedOrListed) {
  Sample sample = triangle();
  sample.json["extensionsUsed"] = {"KHR_materials_ior", "KHR_materials_clearcoat",
                                   "KHR_materials_sheen", "KHR_materials_emissive_strength",
                                   "KHR_materials_transmission"};
  sample.json["materials"] = {
      {{"name", "glass"},
       {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.5}}},
       {"emissiveFactor", {0, 0.5, 1}},
       {"extensions",
        {{"KHR_materials_ior", {{"ior", 1.7}}},
         {"KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatRoughnessFactor", 0.5}}},
         {"KHR_materials_sheen", {{"sheenColorFactor", {1, 1, 1}}}},
         {"KHR_materials_transmission", {{"transmissionFactor", 0.75}}},
         {"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}}};
  sample.json["meshes"][0]["primitives"][0]["material"] = 0;
  const Loaded out = load(sample.glb());
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  const materials::Material& material = out.imported->scene.materials[0];
  EXPECT_EQ(material.name, "glass");
  EXPECT_EQ(*material.refract, Vec3(1.7));
  EXPECT_EQ(material.cook[1], 0.25);
  ASSERT_TRUE(material.coat);
  EXPECT_EQ(material.coat->alpha, 0.25);
  EXPECT_EQ(material.emissive, Vec3(0, 2, 4));
  EXPECT_EQ(material.weights.z, 1);
  const CadMaterial& cad = out.imported->materials[0];
  EXPECT_EQ(cad.opacity, 0.25);
  EXPECT_EQ(cad.lost, (std::vector<std::string>{"transmission", "sheen"}));
  EXPECT_TRUE(out.log.contains(Code::N6008));
}

}  // namespace
}  // namespace panwright::importers
