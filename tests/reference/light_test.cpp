// Penumbrae, interreflection and emission against closed forms and quadrature.
#include <array>

#include "reference_models.h"

namespace panwright::preview::light_test {
namespace {

using namespace testing_support;

// A plate of its own size in a plane z = height, looking up or down.
struct Plate {
  double x0, x1, y0, y1, height;
};

pan::Contents plates(const std::vector<Plate>& all, const materials::Material& material) {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.materials.push_back(material);
  for (const Plate& p : all) {
    geometry::Mesh mesh;
    mesh.positions = {{p.x0, p.y0, p.height},
                      {p.x1, p.y0, p.height},
                      {p.x1, p.y1, p.height},
                      {p.x0, p.y1, p.height}};
    mesh.normals.assign(4, Vec3(0, 0, 1));
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    contents.instances.push_back({0, static_cast<std::uint32_t>(contents.meshes.size()), 0, -1});
    contents.meshes.push_back(pan::packed(mesh, "plate"));
  }
  return contents;
}

// Orthographic from a height, along −z (or +z) with +y up.
View slice(std::uint32_t columns, std::uint32_t rows, double width, double height, double sign) {
  DiagnosticLog log;
  View view;
  set_orthographic(view.camera, columns, rows, width);
  view.camera.position = {0, 0, height};
  view.camera.world_from_camera = *world::looking_at(
      view.camera.position, view.camera.position - Vec3(0, 0, sign), Vec3(0, 1, 0), log);
  return view;
}

// The part of the Sun's disc beside a straight edge, t sines of its radius from the edge.
double visible(double t, double darkening) {
  t = std::clamp(t, -1.0, 1.0);
  const double even = t * std::sqrt(1 - t * t) + std::asin(t) + kPi / 2;
  return ((1 - darkening) * even + darkening * kPi / 2 * (t - t * t * t / 3 + 2.0 / 3)) /
         ((1 - darkening) * kPi + 2 * kPi * darkening / 3);
}

// Its mean from t − step/2 to t + step/2, by the midpoint rule.
double visible_over(double t, double step, double darkening) {
  constexpr int kPoints = 200;
  double sum = 0;
  for (int i = 0; i < kPoints; ++i)
    sum += visible(t + step * ((i + 0.5) / kPoints - 0.5), darkening);
  return sum / kPoints;
}

TEST(ReferenceLight, StraightEdgePenumbra) {
  // the table of the physics notes holds the formula
  EXPECT_NEAR(visible(-0.75, 0), 0.07214681, 1e-8);
  EXPECT_NEAR(visible(0.5, 0), 0.80449889, 1e-8);
  EXPECT_NEAR(visible(-0.5, 0.6), 0.17587555, 1e-8);
  EXPECT_NEAR(visible(0.25, 0.6), 0.67053746, 1e-8);
  const double drop = 2;  // metres from the edge to the receiver
  for (const double distance_au : {1.0, 0.4}) {
    const double sine = 695700e3 / (149597870700.0 * distance_au);
    const double reach = drop * sine / std::sqrt(1 - sine * sine);
    for (const double darkening : {0.0, 0.6}) {
      const pan::Model model =
          model_of(plates({{-1, 1, -1, 1, 0}, {-5, 0, -5, 5, drop}}, lambert(1)));
      View view = slice(48, 1, 2.4 * reach, 1, 1);
      view.sun_distance = distance_au;
      ReferenceOptions options;
      options.bounces = 0;
      options.samples = 1 << 15;
      const ReferenceImage result = traced(model, view, options, darkening);
      double worst = 0;
      for (std::uint32_t i = 0; i < 48; ++i) {
        const double t = ((i + 0.5) / 48 - 0.5) * 2.4;
        worst = std::max(worst, std::fabs(kPi * result.image.radiance[3 * i] -
                                          visible_over(t, 0.05, darkening)));
      }
      printf("Sun at %.1f AU, u = %.1f: worst %.1e\n", distance_au, darkening, worst);
      EXPECT_LE(worst, 0.005);
    }
  }
}

TEST(ReferenceLight, PointSunHasHardShadows) {
  const pan::Model model = model_of(plates({{-1, 1, -1, 1, 0}, {-5, 0, -5, 5, 2}}, lambert(1)));
  const View view = slice(8, 2, 0.01, 1, 1);
  const ReferenceImage result = traced(model, view, direct_light(64));
  for (std::uint32_t i = 0; i < 8; ++i)
    EXPECT_NEAR(kPi * result.image.radiance[3 * i], i < 4 ? 0.0 : 1.0, 1e-6) << i;
}

// ---- two parallel unit squares, one lit by the Sun: B = ρ(E + ∫ B K dA) by Gauss-Legendre

constexpr std::size_t kNodes = 12;

struct Rule {
  std::array<double, kNodes> place, weight;  // on [0, 1]
};

Rule gauss_legendre() {
  Rule rule;
  for (std::size_t i = 0; i < kNodes; ++i) {
    double x = std::cos(kPi * (static_cast<double>(i) + 0.75) / (kNodes + 0.5));
    double slope = 1;
    for (int step = 0; step < 100; ++step) {
      double before = 1, now = x;
      for (std::size_t k = 2; k <= kNodes; ++k) {
        const auto n = static_cast<double>(k);
        const double next = ((2 * n - 1) * x * now - (n - 1) * before) / n;
        before = now;
        now = next;
      }
      slope = kNodes * (x * now - before) / (x * x - 1);
      x -= now / slope;
    }
    rule.place[i] = 0.5 + 0.5 * x;
    rule.weight[i] = 1 / ((1 - x * x) * slope * slope);
  }
  return rule;
}

// ∫ of the radiosity over the lower and the upper square after so many bounces; E = 1 on the lower.
std::array<double, 2> radiosity(double albedo, double gap, std::uint32_t bounces) {
  const Rule rule = gauss_legendre();
  constexpr std::size_t n = kNodes * kNodes;
  std::vector<double> last[2] = {std::vector<double>(n, albedo), std::vector<double>(n, 0.0)};
  std::vector<double> sum[2] = {last[0], last[1]};
  const auto gathered = [&](const std::vector<double>& from, std::size_t i) {
    double result = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const double dx = rule.place[i % kNodes] - rule.place[k % kNodes];
      const double dy = rule.place[i / kNodes] - rule.place[k / kNodes];
      const double square = dx * dx + dy * dy + gap * gap;
      result += rule.weight[k % kNodes] * rule.weight[k / kNodes] * from[k] * gap * gap /
                (kPi * square * square);
    }
    return result;
  };
  for (std::uint32_t bounce = 0; bounce < bounces; ++bounce) {
    std::vector<double> next[2] = {std::vector<double>(n), std::vector<double>(n)};
    for (std::size_t side = 0; side < 2; ++side)
      for (std::size_t i = 0; i < n; ++i) next[side][i] = albedo * gathered(last[1 - side], i);
    for (std::size_t side = 0; side < 2; ++side) {
      last[side] = next[side];
      for (std::size_t i = 0; i < n; ++i) sum[side][i] += next[side][i];
    }
  }
  std::array<double, 2> total{};
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t i = 0; i < n; ++i)
      total[side] += rule.weight[i % kNodes] * rule.weight[i / kNodes] * sum[side][i];
  return total;
}

// Largest relative error of what a camera in the gap between two squares gets from either.
double off_between_squares(double gap, std::uint32_t bounces, double until_error) {
  const double albedo = 0.8;
  const pan::Model model =
      model_of(plates({{-0.5, 0.5, -0.5, 0.5, 0}, {-0.5, 0.5, -0.5, 0.5, gap}}, lambert(albedo)));
  const std::array<double, 2> exact = radiosity(albedo, gap, bounces);
  double most = 0;
  for (const bool upper : {false, true}) {
    // one square fills the image
    View view = slice(16, 16, 1, gap / 2, upper ? -1 : 1);
    // low enough that the upper square's shadow falls beside the lower one
    view.to_sun = {3, 0, gap};
    const double cosine = gap / std::sqrt(9 + gap * gap);
    view.sun_irradiance = Vec3(1 / cosine);
    ReferenceOptions options;
    options.sun_disc = false;
    options.bounces = bounces;
    options.samples = 64;
    options.until_error = until_error;
    const ReferenceImage result = traced(model, view, options);
    const double off = kPi * result.flux.x / exact[upper] - 1;
    printf("gap %.1f, %2u bounces, %s: %+.1e (error %.1e)\n", gap, bounces,
           upper ? "upper" : "lower", off, result.flux_error.x / result.flux.x);
    most = std::max(most, std::fabs(off));
  }
  return most;
}

// tolerances: three standard errors and a little
TEST(ReferenceLight, InterreflectionOfParallelSquares) {
  // the quadrature itself: one bounce from an evenly lit square is the form factor 0.19982490
  EXPECT_NEAR(radiosity(1, 1, 1)[1], 0.19982490, 1e-7);
  EXPECT_LE(off_between_squares(1, 1, 1e-3), 3.5e-3);
  EXPECT_LE(off_between_squares(0.5, 20, 1e-3), 3.5e-3);
}

TEST(ReferenceLight, InterreflectionOfParallelSquaresExactly) {
  for (const double gap : {1.0, 0.5})
    for (const std::uint32_t bounces : {1u, 20u})
      EXPECT_LE(off_between_squares(gap, bounces, 4e-4), 1e-3);
}

TEST(ReferenceLight, EmissionIsSeenAndLightsOthers) {
  materials::Material glowing = lambert(0);
  glowing.emissive = Vec3(0.5, 0.25, 0);
  glowing.weights = Vec3(0, 0, 1);
  pan::Contents contents =
      plates({{-0.5, 0.5, -0.5, 0.5, 0}, {-0.5, 0.5, -0.5, 0.5, 1}}, lambert(0.6));
  contents.materials.push_back(glowing);
  contents.instances[0].material = 1;
  const pan::Model model = model_of(contents);
  // the Sun edge on, or off: nothing else shines
  const std::pair<Vec3, std::optional<Vec3>> suns[] = {
      {{1, 0, 0}, {}}, {{1, 0, 0}, Vec3(2)}, {{0, 0, 1}, Vec3(0)}};
  for (const auto& [to_sun, irradiance] : suns) {
    const Vec3 white = irradiance ? light::kSolarIrradiance : Vec3(1);
    View view = slice(16, 16, 1, 0.5, 1);
    view.to_sun = to_sun;
    view.sun_irradiance = irradiance;
    ReferenceOptions options;
    options.sun_disc = false;
    options.until_error = 2e-3;
    const ReferenceImage glow = traced(model, view, options);
    EXPECT_NEAR(glow.flux.x / white.x, 0.5 / kPi, 1e-9);
    EXPECT_NEAR(glow.flux.y / white.y, 0.25 / kPi, 1e-9);
    EXPECT_EQ(glow.flux.z, 0);
    view.camera = slice(16, 16, 1, 0.5, -1).camera;
    const ReferenceImage lit = traced(model, view, options);
    const double exact = 0.5 / kPi * 0.6 * 0.19982490 * white.x;
    printf("lit by what glows: %+.1e\n", lit.flux.x / exact - 1);
    EXPECT_NEAR(lit.flux.x / exact, 1, 8e-3);  // four standard errors
    view.white = Vec3(7);
    EXPECT_NEAR(traced(model, view, options).flux.x / lit.flux.x, 7 / white.x, 1e-12);
  }
}

}  // namespace
}  // namespace panwright::preview::light_test
