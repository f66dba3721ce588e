// Layers, comparisons, material samples and edges.
#include "studio/layers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "compiler/compile.h"
#include "pxn/pxn.h"
#include "studio/edges.h"
#include "studio/samples.h"

namespace panwright::studio {
namespace {

image::Image blank_image(std::uint32_t width, std::uint32_t height) {
  image::Image image;
  image.width = width;
  image.height = height;
  const std::size_t n = image.pixels();
  image.radiance.assign(3 * n, 0);
  image.coverage.assign(n, 1);
  image.depth.assign(n, 0);
  image.range.assign(n, 0);
  image.normal.assign(3 * n, 0);
  image.target_id.assign(n, 1);
  image.node_id.assign(n, 1);
  image.material_id.assign(n, 1);
  return image;
}

std::uint32_t rgb(const Pixels& pixels, std::size_t i) {
  return std::uint32_t{pixels.rgba[4 * i]} << 16 | std::uint32_t{pixels.rgba[4 * i + 1]} << 8 |
         pixels.rgba[4 * i + 2];
}

pan::Model compiled_model(const std::string& body) {
  const std::vector<pxn::MemoryFile> files = {
      {"a.pxn", "<pangu_model ver=\"1\">" + body + "</pangu_model>"}};
  DiagnosticLog log;
  const auto scene = pxn::read_memory(files, {}, log);
  const auto bytes =
      scene ? compiler::compiled(*scene, {}, log) : Result<std::vector<std::byte>>(failed);
  auto model = bytes ? pan::Model::from_bytes(*bytes, "a", log) : Result<pan::Model>(failed);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return std::move(*model);
}

TEST(Layers, NumbersOfADetectorAreGrey) {
  image::Image image = blank_image(4, 1);
  image.dn = {0, 2048, 4094, 4095};
  image.dn_bits = 12;
  std::vector<std::uint8_t> rgba = dn_pixels(image);
  const std::vector<int> expected = {0, 128, 255, 255};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(rgba[4 * i + k], expected[i]);
  // stripes over saturated pixels alone, not over all that are white on the screen
  const std::vector<std::uint8_t> marked = {1, 0, 0, 1};
  mark_pixels(4, marked, rgba);
  EXPECT_EQ(rgba[1], 0);
  EXPECT_EQ(rgba[0], 204);
  EXPECT_EQ(rgba[4 * 2 + 1], 255);
  EXPECT_EQ(rgba[4 * 3], 204);
}

TEST(Layers, FalseColoursAreFourDecades) {
  image::Image image = blank_image(5, 1);
  const float light[] = {0, 1e-5f, 1e-4f, 1e-2f, 1};
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t k = 0; k < 3; ++k) image.radiance[3 * i + k] = 7 * light[i];
  const Pixels pixels = layer_pixels(image, "false colours");
  EXPECT_NEAR(pixels.high, 7, 1e-6);
  EXPECT_NEAR(pixels.low, 7e-4, 1e-9);
  EXPECT_TRUE(pixels.logarithmic);
  std::uint8_t ends[3][3];
  for (int i = 0; i < 3; ++i) scale_color(0.5 * i, ends[i]);
  const auto is = [&](std::size_t i, const std::uint8_t* color) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(pixels.rgba[4 * i + k], color[k], 1) << i;
  };
  is(1, ends[0]);  // below the scale
  is(2, ends[0]);
  is(3, ends[1]);  // half of it
  is(4, ends[2]);
  EXPECT_NE(rgb(pixels, 0), rgb(pixels, 1));  // no light differs from faint light
}

TEST(Layers, TruthOfPixels) {
  image::Image image = blank_image(4, 1);
  image.target_id[3] = 0;
  image.depth = {10, 20, 15, 0};
  image.normal = {0, 0, 1, 0, 0, -1, 1, 0, 0, 0, 0, 0};
  image.node_id = {1, 2, 1, 0};
  image.material_id = {5, 5, 6, 0};
  const Pixels depth = layer_pixels(image, "depth");
  EXPECT_EQ(depth.low, 10);
  EXPECT_EQ(depth.high, 20);
  std::uint8_t near[3], far[3];
  scale_color(1, near);
  scale_color(0, far);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(depth.rgba[k], near[k]);
    EXPECT_EQ(depth.rgba[4 + k], far[k]);
  }
  const Pixels normals = layer_pixels(image, "normals");
  EXPECT_EQ(rgb(normals, 0), 0x8080ffu);
  EXPECT_EQ(rgb(normals, 1), 0x808000u);
  EXPECT_EQ(rgb(normals, 2), 0xff8080u);
  const Pixels parts = layer_pixels(image, "parts");
  EXPECT_EQ(rgb(parts, 0), rgb(parts, 2));
  EXPECT_NE(rgb(parts, 0), rgb(parts, 1));
  EXPECT_NE(rgb(parts, 0), rgb(parts, 3));
  const Pixels materials = layer_pixels(image, "materials");
  EXPECT_EQ(rgb(materials, 0), rgb(materials, 1));
  EXPECT_NE(rgb(materials, 0), rgb(materials, 2));
}

TEST(Layers, EmptyImage) {
  image::Image image = blank_image(3, 2);
  image.target_id.assign(6, 0);
  image.coverage.assign(6, 0);
  for (const char* layer : kLayers)
    if (std::string(layer) != "light") {
      const Pixels pixels = layer_pixels(image, layer);
      ASSERT_EQ(pixels.rgba.size(), 24u);
      for (std::size_t i = 1; i < 6; ++i) EXPECT_EQ(rgb(pixels, i), rgb(pixels, 0));
    }
  preview::ReferenceImage reference{image, std::vector<float>(18, 0.0f)};
  const Comparison same = compared(image, reference);
  EXPECT_EQ(same.flux, 0);
  EXPECT_EQ(same.rmse, 0);
  EXPECT_EQ(difference_pixels(image, image, same.rms, 0.1).rgba.size(), 24u);
}

TEST(Layers, WhiteIsStriped) {
  std::vector<std::uint8_t> rgba(4 * 16 * 2, 100);
  for (std::size_t i = 0; i < 16; ++i) rgba[4 * i + 1] = 255;
  mark_white(16, rgba);
  int striped = 0;
  for (std::size_t i = 0; i < 16; ++i) striped += rgba[4 * i + 1] != 255;
  EXPECT_EQ(striped, 8);
  for (std::size_t i = 64; i < rgba.size(); ++i) EXPECT_EQ(rgba[i], 100);
}

TEST(Layers, ComparedWithTheReference) {
  image::Image image = blank_image(2, 1);
  image.radiance = {1, 2, 4, 1, 2, 4};
  preview::ReferenceImage reference{blank_image(2, 1), std::vector<float>(6, 0.1f)};
  reference.image.radiance = {1, 2, 5, 1, 2, 5};
  reference.flux = Vec3(2, 4, 10);
  reference.flux_error = Vec3(0, 0, 0.05);
  const Comparison c = compared(image, reference);
  EXPECT_NEAR(c.flux, -0.2, 1e-12);  // of the worst channel
  EXPECT_NEAR(c.flux_error, 0.005, 1e-12);
  EXPECT_NEAR(c.rmse, std::sqrt(2.0 / 60), 1e-12);
  EXPECT_NEAR(c.noise, std::sqrt(0.06 / 60), 1e-8);
  EXPECT_NEAR(c.rms, std::sqrt(60.0 / 6), 1e-12);
  // darker is blue, brighter orange, beyond the range no more so
  const Pixels darker = difference_pixels(image, reference.image, c.rms, 0.01);
  const Pixels brighter = difference_pixels(reference.image, image, c.rms, 0.01);
  EXPECT_EQ(rgb(darker, 0), 0x0072b2u);
  EXPECT_EQ(rgb(brighter, 0), 0xd55e00u);
  EXPECT_EQ(rgb(difference_pixels(image, image, c.rms, 0.01), 0), 0xf0f0f0u);
}

// A Lambert plate has one reflectance in all directions, and that albedo.
TEST(Samples, OfALambertMaterial) {
  pxn::DescribedMaterial grey;
  grey.material.name = "grey";
  grey.material.diffuse = Vec3(0.5, 0.25, 0.1);
  const MaterialSample sample = sample_of(grey, 96);
  EXPECT_EQ(sample.name, "grey");
  EXPECT_NE(sample.verdict.find("conserved"), std::string::npos);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(sample.hemispherical[k], grey.material.diffuse[static_cast<int>(k)], 1e-4);
    for (const Vec2& point : sample.albedo[k])
      EXPECT_NEAR(point.y, grey.material.diffuse[static_cast<int>(k)], 1e-4);
  }
  for (const auto& lobe : sample.lobes) {
    ASSERT_GT(lobe.size(), 100u);
    for (const Vec2& point : lobe) EXPECT_NEAR(point.y, (0.5 + 0.25 + 0.1) / 3, 1e-6);
  }
  ASSERT_EQ(sample.width, 96u);
  ASSERT_EQ(sample.rgba.size(), std::size_t{4} * sample.width * sample.height);
  std::uint64_t sum[3] = {};
  for (std::size_t i = 0; i < sample.rgba.size(); ++i)
    if (i % 4 < 3) sum[i % 4] += sample.rgba[i];
  EXPECT_GT(sum[0], sum[1]);
  EXPECT_GT(sum[1], sum[2]);
  EXPECT_GT(sum[2], 0u);
}

// Edges of a box in two projections, against its corners; hidden ones are not drawn.
TEST(Edges, OfABox) {
  DiagnosticLog log;
  world::World world;
  ASSERT_TRUE(world.add(
      "box", std::make_shared<const pan::Model>(compiled_model("<box size=\"2 2 2\"/>")), log));
  for (const bool ortho : {false, true}) {
    world::Camera camera;
    if (ortho)
      world::set_orthographic(camera, 64, 64, 4);
    else
      world::set_field_of_view(camera, 64, 64,
                               2 * std::atan(4.0 / 18));  // 4 m wide at the near face
    camera.position = Vec3(0, 0, 10);
    camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), Vec3(0, 1, 0), log);
    preview::ReferenceOptions options;
    options.samples = 8;
    options.ground_truth = true;
    const auto drawn = preview::Reference().render(world, camera, options, log);
    ASSERT_TRUE(drawn) << to_text(log);
    const std::vector<std::uint8_t> edges = edges_of(world, camera, drawn->image);
    ASSERT_EQ(edges.size(), 64u * 64);
    std::size_t on = 0, inside = 0;
    for (std::size_t y = 0; y < 64; ++y)
      for (std::size_t x = 0; x < 64; ++x) {
        if (edges[64 * y + x] == 0) continue;
        ++on;
        // the near face fills pixels 16 to 48: its sides, and one diagonal of it
        const auto off = [](double a, double b) { return std::fabs(a - b); };
        const double u = static_cast<double>(x) + 0.5, v = static_cast<double>(y) + 0.5;
        const bool side = (off(u, 16) < 1 || off(u, 48) < 1 || off(v, 16) < 1 || off(v, 48) < 1) &&
                          u > 15 && u < 49 && v > 15 && v < 49;
        const bool diagonal = std::min(off(u, v), off(u, 64 - v)) < 1.5 && u > 15 && u < 49;
        inside += side || diagonal;
      }
    EXPECT_EQ(on, inside) << ortho;
    EXPECT_GT(on, 4u * 32);
  }
}

// Slopes of facets against those that the compiler measured.
TEST(Samples, SlopesOfFoil) {
  const pan::Model model = compiled_model(
      "<mli name=\"door\" type=\"flat\" "
      "seed=\"3\"><mli_settings><width>0.5</width><height>0.4</height><xgrid>100</xgrid>"
      "</mli_settings><mli_operations><random>1mm</random><smooth>3</smooth><slope_rms>0.2</"
      "slope_rms></mli_operations></mli>");
  ASSERT_EQ(model.sheets().size(), 1u);
  const SheetSlopes slopes = slopes_of(model, "door");
  ASSERT_EQ(slopes.sheets.size(), 1u);
  EXPECT_NE(slopes.sheets[0].find("flat 0.5 x 0.4 m, 100 x 80 cells, seed 3"), std::string::npos)
      << slopes.sheets[0];
  const auto& sheet = model.sheets()[0];
  const double expected = 0.5 * (sheet.facet_slope_covariance[0] + sheet.facet_slope_covariance[2]);
  EXPECT_NEAR(slopes.rms * slopes.rms, expected, 0.01 * expected);
  for (const auto& density : slopes.density) {
    double all = 0, square = 0;
    const double step = density[1].x - density[0].x;
    for (const Vec2& point : density) {
      all += point.y * step;
      square += point.y * step * point.x * point.x;
    }
    // measured: 0.9999 and 0.98 to 1.02; beyond four times the RMS there are no bins
    EXPECT_NEAR(all, 1, 2e-3);
    EXPECT_NEAR(square, expected, 0.1 * expected);
  }
  EXPECT_TRUE(slopes_of(model, "unknown").sheets.empty());
  EXPECT_EQ(slopes_of(model, "").sheets.size(), 1u);
}

// Of several requests at once, the last one is computed.
TEST(Samples, LastRequestIsComputed) {
  Samples samples;
  pxn::DescribedMaterial one;
  for (const char* name : {"a", "b", "c"}) {
    one.material.name = name;
    samples.request(one, 32);
  }
  while (!samples.last() || samples.last()->name != "c") samples.poll();
  EXPECT_FALSE(samples.busy());
}

}  // namespace
}  // namespace panwright::studio
