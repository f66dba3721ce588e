// Differences: none between equal files, and the right words for each kind of change.
#include "pan/diff.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "tests/pan/load.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::diff_test {
namespace {

std::vector<std::string> lines(const std::vector<Difference>& list) {
  std::vector<std::string> out;
  for (const Difference& difference : list)
    out.push_back(difference.where + ": " + difference.what);
  return out;
}

using Lines = std::vector<std::string>;

// The differences that a change of the sample makes.
Differences after(const std::function<void(Contents&)>& change) {
  Contents changed = support::small_contents();
  change(changed);
  return diff(load(support::small_pan()), load(write_to_memory(changed)));
}

void expect_model(const Lines& expected, const std::function<void(Contents&)>& change) {
  const Differences found = after(change);
  EXPECT_EQ(lines(found.model), expected);
  EXPECT_EQ(lines(found.provenance), Lines());
}

void expect_provenance(const Lines& expected, const std::function<void(Contents&)>& change) {
  const Differences found = after(change);
  EXPECT_TRUE(found.same_model());
  Lines seen = lines(found.provenance);
  std::erase_if(seen, [](const std::string& line) { return line.starts_with("build identity"); });
  EXPECT_EQ(seen, expected);
}

TEST(Diff, EqualFilesDoNotDiffer) {
  EXPECT_TRUE(after([](Contents&) {}).empty());
}

TEST(Diff, Nodes) {
  expect_model({"node 'craft/body': translation: 1 2 3 in a, 1 2 3.5 in b"},
               [](Contents& c) { c.nodes[1].translation.z = 3.5; });
  expect_model({"node 'craft/body': rotation: 0.6 0 0.8 0 in a, -0.6 0 0.8 0 in b"},
               [](Contents& c) { c.nodes[1].rotation.w = -0.6; });
  expect_model({"node 'craft': scale: 1 1 1 in a, 1 -1 1 in b"},
               [](Contents& c) { c.nodes[0].scale.y = -1; });
  expect_model({"node 'craft/extra': only in b"}, [](Contents& c) {
    c.nodes.push_back({"extra", 0});
  });
}

TEST(Diff, ARenamedNodeIsAnother) {
  const Differences found = after([](Contents& c) { c.nodes[2].name = "panel"; });
  const Lines seen = lines(found.model);
  EXPECT_EQ(seen[0], "node 'craft/body/[2]': only in a");
  EXPECT_EQ(seen[1], "node 'craft/body/panel': only in b");
  EXPECT_EQ(seen[2], "mesh 'pläté' at node 'craft/body/[2]': only in a");
  EXPECT_EQ(seen[3], "mesh 'pläté' at node 'craft/body/panel': only in b");
  EXPECT_EQ(seen[4],
            "keypoint 'tip': at node 'craft/body/[2]' in a, at node 'craft/body/panel' in b");
  EXPECT_EQ(seen.size(), 6u);  // the decal that lies on it is the last
}

TEST(Diff, EqualNamesAreToldApartByPathAndOrder) {
  Contents first = support::small_contents(), second = first;
  first.nodes.push_back({"leg", 0, {1, 0, 0}});
  first.nodes.push_back({"leg", 1, {2, 0, 0}});
  first.nodes.push_back({"leg", 1, {3, 0, 0}});
  second.nodes.push_back({"leg", 1, {2, 0, 0}});
  second.nodes.push_back({"leg", 1, {4, 0, 0}});
  second.nodes.push_back({"leg", 0, {1, 0, 0}});
  EXPECT_EQ(lines(diff(load(write_to_memory(first)), load(write_to_memory(second))).model),
            Lines{"node 'craft/body/leg': translation: 3 0 0 in a, 4 0 0 in b"});
}

TEST(Diff, Meshes) {
  expect_model({"mesh 'hull': vertices lie up to 0.5 m apart"},
               [](Contents& c) { c.meshes[0].positions[3] -= 0.5f; });
  expect_model({"mesh 'hull': vertices lie up to 5 m apart"},
               [](Contents& c) { c.meshes[0].origin += Vec3(0, 3, 4); });
  // an origin that moves while the vertices stay is no difference of place: the file differs still
  expect_model({"file: the contents are equal, but their order or storage differs"},
               [](Contents& c) {
                 c.meshes[0].origin.x += 1;
                 for (std::size_t i = 0; i < 12; i += 3) c.meshes[0].positions[i] -= 1;
               });
  expect_model({"mesh 'hull': error: 0.25 in a, 0.5 in b", "mesh 'hull': closed only in a"},
               [](Contents& c) {
                 c.meshes[0].error = 0.5;
                 c.meshes[0].closed = false;
               });
  expect_model({"mesh 'pläté': normals differ by up to 1.5708 rad"}, [](Contents& c) {
    c.meshes[1].normals[0] = 1;
    c.meshes[1].normals[2] = 0;
  });
  expect_model({"mesh 'pläté': texcoords lie up to 0.25 apart"},
               [](Contents& c) { c.meshes[1].texcoords[0] = 0.25f; });
  expect_model({"mesh 'pläté': colours differ by up to 2"},
               [](Contents& c) { c.meshes[1].colors[0] = 3; });
  expect_model({"mesh 'pläté': colours only in a"},
               [](Contents& c) { c.meshes[1].colors.clear(); });
  expect_model({"mesh 'hull': 2 of 4 triangles differ in corners"}, [](Contents& c) {
    std::swap(c.meshes[0].indices[0], c.meshes[0].indices[3]);
    std::swap(c.meshes[0].indices[1], c.meshes[0].indices[4]);
    std::swap(c.meshes[0].indices[2], c.meshes[0].indices[5]);
  });
  expect_model({"mesh 'hull': triangle_count: 4 in a, 3 in b"},
               [](Contents& c) { c.meshes[0].indices.resize(9); });
  expect_model({"mesh 'extra': only in b"}, [](Contents& c) {
    c.meshes.push_back(c.meshes[0]);
    c.meshes[2].name = "extra";
    c.mesh_tolerances.push_back({});
  });
}

TEST(Diff, InstancesMaterialsAndTextures) {
  expect_model({"mesh 'hull' at node 'craft/body': material 'plastic' in a, material 'paint' in b"},
               [](Contents& c) { c.instances[0].material = 1; });
  expect_model({"mesh 'pläté' at node 'craft/body/[2]': texture 'skin.png' in a, no texture in b"},
               [](Contents& c) { c.instances[1].texture = -1; });
  expect_model({"material 'plastic': refract: 1.5 1.5 1.5 in a, 0 0 0 in b",
                "material 'plastic': specular_brdf: cook_torrance in a, none in b"},
               [](Contents& c) {
                 c.materials[0].refract.reset();
                 c.materials[0].specular_brdf = materials::NoSpecular{};
               });
  // the parameters of a model by name
  expect_model({"material 'plastic': alpha: 0.5 in a, 0.25 in b",
                "material 'plastic': g_scale: 1 in a, 3 in b"},
               [](Contents& c) {
                 c.materials[0].specular_brdf =
                     materials::CookTorrance{.alpha = 0.25, .g_scale = 3};
               });
  expect_model({"texture 'skin.png': linear only in a"},
               [](Contents& c) { c.textures[0].linear = false; });
  expect_model(
      {"texture 'skin.png': width: 2 in a, 3 in b", "texture 'skin.png': height: 3 in a, 2 in b"},
      [](Contents& c) { std::swap(c.textures[0].width, c.textures[0].height); });
  std::vector<std::uint8_t> other;
  expect_model({"texture 'skin.png': 1 of 6 texels differ, by up to 5 of 255"}, [&](Contents& c) {
    other.assign(c.textures[0].rgba.begin(), c.textures[0].rgba.end());
    other[7] += 5;
    c.textures[0].rgba = other;
  });
}

TEST(Diff, Frames) {
  expect_model({"frame 'camera': origin: 0 0 0.5 in a, 0 1 0.5 in b"},
               [](Contents& c) { c.frames[0].origin.y = 1; });
  expect_model({"frame 'camera': at node 'craft/body' in a, at node 'craft' in b"},
               [](Contents& c) { c.frames[0].node = 0; });
  expect_model({"frame 'camera': only in a"}, [](Contents& c) { c.frames.clear(); });
}

TEST(Diff, MapsAreComparedByTheTexturesTheyName) {
  expect_model({"material 'paint': cutout_threshold: 0.5 in a, 0.25 in b",
                "material 'paint': albedo_map: no texture in a, texture 'skin.png' in b",
                "material 'paint': reflectance_map: no texture in a, texture 'skin.png' in b"},
               [](Contents& c) {
                 c.materials[1].maps.albedo = 0;
                 c.materials[1].maps.reflectance = 0;
                 c.materials[1].maps.threshold = 0.25;
               });
  // the texture has another number and is the same
  static const std::vector<std::uint8_t> kTexel(4);
  Contents a = support::small_contents(), b = a;
  a.materials[1].maps.cutout = 0;
  b.materials[1].maps.cutout = 1;
  b.textures.insert(b.textures.begin(), {"first.png", 1, 1, false, kTexel});
  b.instances[1].texture = b.instances[2].texture = 1;
  for (DecalContent& decal : b.decals) decal.texture = 1;
  EXPECT_EQ(lines(diff(load(write_to_memory(a)), load(write_to_memory(b))).model),
            Lines{"texture 'first.png': only in b"});
}

TEST(Diff, Keypoints) {
  expect_model({"keypoint 'tip': position: 0 0 0.1 in a, 0 2 0.1 in b"},
               [](Contents& c) { c.keypoints[1].position.y = 2; });
  expect_model({"keypoint 'corner': at node 'craft/body' in a, at node 'craft' in b"},
               [](Contents& c) { c.keypoints[0].node = 0; });
  expect_model({"keypoint 'tip': only in a"}, [](Contents& c) { c.keypoints.pop_back(); });
}

TEST(Diff, Sheets) {
  expect_model({"sheet of mesh 'pl\u00e4t\u00e9': slope_rms: 0.2 in a, 0.25 in b",
                "sheet of mesh 'pl\u00e4t\u00e9': seed: 5 in a, 6 in b"},
               [](Contents& c) {
                 c.sheets[0].seed = 6;
                 c.sheets[0].slope_rms = 0.25;
               });
  expect_model({"sheet of mesh 'pl\u00e4t\u00e9': only in a"},
               [](Contents& c) { c.sheets.clear(); });
}

TEST(Diff, Decals) {
  expect_model({"decal 'flag': width: 0.5 in a, 1 in b", "decal 'flag': depth: 1.5 in a, 2 in b"},
               [](Contents& c) {
                 c.decals[0].width = 1;
                 c.decals[1].depth = 2;
               });
  expect_model({"decal 'flag': on mesh 'hull' at node 'craft/body' in a, on mesh 'pläté' at node "
                "'craft/body/[2]' in b"},
               [](Contents& c) { c.decals[1].instance = 1; });
  expect_model({"decal 'flag': only in a"}, [](Contents& c) { c.decals.pop_back(); });
}

TEST(Diff, Needs) {
  expect_model({"budget: flux: 0.125 in a, 0.25 in b"}, [](Contents& c) { c.budget->flux = 0.25; });
  expect_model({"budget: only in a"}, [](Contents& c) { c.budget.reset(); });
  expect_model({"tolerances of the meshes: only in a"},
               [](Contents& c) { c.mesh_tolerances.clear(); });
  expect_model({"mesh 'hull': tolerance: 0.25 in a, 0.5 in b",
                "mesh 'hull': reason: flux in a, centroid in b"},
               [](Contents& c) {
                 c.mesh_tolerances[0].tolerance = 0.5;
                 c.mesh_tolerances[0].reason =
                     static_cast<std::uint32_t>(layout::ToleranceReason::centroid);
               });
}

TEST(Diff, ProvenanceStandsApart) {
  expect_provenance({"version: 'panwright 0.1.0' in a, 'panwright 0.2.0' in b"},
                    [](Contents& c) { c.version = "panwright 0.2.0"; });
  expect_provenance({"options: 'max_error=0.001' in a, '' in b"},
                    [](Contents& c) { c.options.clear(); });
  expect_provenance({"input 'craft.pxn': contents differ: 300 bytes in a, 300 in b"},
                    [](Contents& c) { c.inputs[0].hash.low = 9; });
  expect_provenance({"input 'skin.png': only in a"}, [](Contents& c) { c.inputs.pop_back(); });
  expect_provenance({"source locations: 1 of 3 differ"},
                    [](Contents& c) { c.sources[1].line = 10; });
  expect_provenance({"source locations: only in a"}, [](Contents& c) { c.sources.clear(); });
}

TEST(Diff, UnknownSectionsAndOrder) {
  support::OpenPan file(support::small_pan());
  file.add_section(1000, true, 1, std::vector<std::byte>(64, std::byte{1}));
  file.seal();
  const Model a = load(support::small_pan()), b = load(file.bytes());
  EXPECT_EQ(lines(diff(a, b).model), Lines{"section of kind 1000: only in b"});
  EXPECT_EQ(lines(diff(b, a).model), Lines{"section of kind 1000: only in a"});
  file.at<std::uint8_t>(layout::SectionKind{1000}, 5) = 9;
  file.seal();
  EXPECT_EQ(lines(diff(b, load(file.bytes())).model),
            Lines{"section of kind 1000: contents differ"});
  expect_model({"file: the contents are equal, but their order or storage differs"},
               [](Contents& c) {
                 std::swap(c.materials[0], c.materials[1]);
                 for (InstanceContent& instance : c.instances) instance.material ^= 1;
                 c.levels[0].material ^= 1;
               });
}

TEST(Diff, TheLimitCountsWhatItHides) {
  Contents many = support::small_contents();
  for (int i = 0; i < 10; ++i) many.nodes.push_back({"n", 0});
  const Differences found = diff(load(support::small_pan()), load(write_to_memory(many)), 3);
  EXPECT_EQ(found.model.size(), 3u);
  EXPECT_EQ(found.hidden, 7u);
}

}  // namespace
}  // namespace panwright::pan::diff_test
