// Interreflections whose light is known in closed form or by quadrature.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/transport/transport_models.h"

namespace panwright::transport::oracles_test {
namespace {

using namespace testing_support;

geometry::Mesh open_box(double side) {
  geometry::Mesh mesh = support::box(Vec3(side));
  mesh.closed = false;
  return mesh;
}

bool is_inside(const light::Surfel& surfel) { return glm::dot(surfel.normal, surfel.position) < 0; }

// A closed room of albedo r whose walls send M: E = M (1 - r^n)/(1 - r) after n bounces, anywhere;
// and nothing comes out.
TEST(TransportOracles, ClosedFurnace) {
  const geometry::Mesh mesh = open_box(2);
  const Solved room(world_of({&mesh, 1}, 0.8), {2000, 32});
  const auto light = room.light(0.8, [&](std::size_t i) { return is_inside(room[i]) ? 1 : 0; }, 40);
  const double whole = (1 - std::pow(0.8, 40)) / 0.2;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < room.size(); ++i) {
    if (is_inside(room[i])) {
      EXPECT_NEAR(light[i], whole, 1e-5 * whole);
      ++inside;
    } else {
      EXPECT_EQ(light[i], 0);
    }
  }
  EXPECT_GT(inside, 500u);
}

// A room without a lid, white, under a sky of irradiance 1: every place has 1.
TEST(TransportOracles, OpenFurnace) {
  const geometry::Mesh walls[] = {
      sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), sheet({-1, -1, 0}, {0, 0, 1}, {2, 0, 0}),
      sheet({-1, 1, 0}, {2, 0, 0}, {0, 0, 1}), sheet({-1, -1, 0}, {0, 2, 0}, {0, 0, 1}),
      sheet({1, -1, 0}, {0, 0, 1}, {0, 2, 0})};
  const Solved room(world_of(walls, 1), {3000, 32});
  const auto light = room.light(1, [&](std::size_t i) { return 1 - room.around(i); }, 200);
  for (std::size_t i = 0; i < room.size(); ++i)
    EXPECT_NEAR(light[i] + 1 - room.around(i), 1, 2e-4);
}

// Whatever lights the inside of a sphere, what walls send is the same everywhere.
TEST(TransportOracles, SphereInside) {
  const geometry::Mesh mesh = ball(1, 48);
  const Solved sphere(world_of({&mesh, 1}, 0.7), {8192, 32});
  double lit = 0, whole = 0;
  const auto is_lit = [&](std::size_t i) { return is_inside(sphere[i]) && sphere[i].position.z > 0.8; };
  for (std::size_t i = 0; i < sphere.size(); ++i) {
    if (!is_inside(sphere[i])) continue;
    whole += sphere.set->area(i);
    if (is_lit(i)) lit += sphere.set->area(i);
  }
  const auto light = sphere.light(0.7, [&](std::size_t i) { return is_lit(i) ? 0.7 : 0; }, 100);
  const double expected = 0.7 * lit / whole / 0.3;
  double sum = 0, squares = 0, areas = 0;
  for (std::size_t i = 0; i < sphere.size(); ++i) {
    if (!is_inside(sphere[i])) continue;
    const double area = sphere.set->area(i), error = light[i] / expected - 1;
    sum += area * error;
    squares += area * error * error;
    areas += area;
  }
  printf("sphere: mean %.5f rms %.5f of %zu\n", sum / areas, std::sqrt(squares / areas), sphere.size());
}

double form_factor(const Solved& solved, const std::function<bool(const light::Surfel&)>& from,
                   const std::function<bool(const light::Surfel&)>& to) {
  const auto light = solved.light(0, [&](std::size_t i) { return to(solved[i]) ? 1 : 0; }, 1);
  double sum = 0, area = 0;
  for (std::size_t i = 0; i < solved.size(); ++i)
    if (from(solved[i])) {
      sum += solved.set->area(i) * light[i];
      area += solved.set->area(i);
    }
  return sum / area;
}

// Equal squares face to face, and edge to edge at a right angle.
TEST(TransportOracles, FacingSquares) {
  for (const auto& [side, expected] :
       {std::pair{0.5, 0.0685896}, {1.0, 0.1998249}, {2.0, 0.4152533}}) {
    const geometry::Mesh plates[] = {sheet({0, 0, 0}, {side, 0, 0}, {0, side, 0}),
                                     sheet({0, 0, 1}, {0, side, 0}, {side, 0, 0})};
    const Solved solved(world_of(plates, 0.5), {4096, 32});
    const double factor =
        form_factor(solved, [](const auto& s) { return s.position.z < 0.5 && s.normal.z > 0; },
                    [](const auto& s) { return s.position.z > 0.5 && s.normal.z < 0; });
    printf("squares %.1f: %.6f %.6f\n", side, factor, expected);
  }
  const geometry::Mesh edge[] = {sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                                 sheet({0, 0, 0}, {0, 1, 0}, {0, 0, 1})};
  const Solved solved(world_of(edge, 0.5), {4096, 32});
  printf("edge: %.6f %.6f\n",
         form_factor(solved, [](const auto& s) { return s.normal.z > 0.5; },
                     [](const auto& s) { return s.normal.x > 0.5; }),
         0.2000438);
}

// Long walls of width 1 at a right angle, the upright one lit: the floor.
TEST(TransportOracles, Corner) {
  constexpr double kLong = 60;
  const geometry::Mesh walls[] = {sheet({0, -kLong / 2, 0}, {1, 0, 0}, {0, kLong, 0}),
                                  sheet({0, -kLong / 2, 0}, {0, kLong, 0}, {0, 0, 1})};
  const Solved solved(world_of(walls, 0.8), {30000, 32});
  const auto sent = [&](std::size_t i) { return solved[i].normal.x > 0.5 ? 0.8 : 0; };
  const auto once = solved.light(0.8, sent, 1);
  const auto all = solved.light(0.8, sent, 60);
  constexpr double kAll[] = {.42768587, .32713551, .23513327, .12338714};
  const double places[] = {0.05, 0.25, 0.5, 0.97};
  const light::SurfelLight shown_once = solved.shown(once), shown_all = solved.shown(all);
  for (int k = 0; k < 4; ++k) {
    const double x = places[k];
    double sum_once = 0, sum_all = 0;
    constexpr int kPlaces = 400;
    for (int i = 0; i < kPlaces; ++i) {
      const Vec3 at(x, 8 * ((i + 0.5) / kPlaces - 0.5), 0);
      sum_once += irradiance_at(shown_once, at, {0, 0, 1}).x / kPlaces;
      sum_all += irradiance_at(shown_all, at, {0, 0, 1}).x / kPlaces;
    }
    printf("corner x %.2f: once %.5f %.5f all %.5f %.5f (h %.4f, %zu)\n", x, sum_once,
           0.4 * (1 - x / std::sqrt(1 + x * x)), sum_all, kAll[k], solved.set->spacing(), solved.size());
  }
}

// Long V grooves of equal walls under even light: effective albedo.
TEST(TransportOracles, Groove) {
  struct Case { double angle, albedo, effective; };
  for (const Case& one : {Case{30, .5, .193833}, {30, .8, .469341}, {30, .95, .795317}, {60, .5, .327049},
                          {60, .8, .654708}, {60, .95, .898556}, {90, .5, .412147}, {90, .8, .735937}, {120, .8, .775526}}) {
    constexpr double kLong = 60;
    const double half = one.angle / 2 * kDegree;
    const Vec3 left(-std::sin(half), 0, std::cos(half)), right(std::sin(half), 0, std::cos(half));
    const geometry::Mesh walls[] = {sheet({0, -kLong / 2, 0}, left, {0, kLong, 0}),
                                    sheet({0, -kLong / 2, 0}, right, {0, kLong, 0})};
    const Solved solved(world_of(walls, one.albedo), {12000, 32});
    const auto in_groove = [&](std::size_t i) { return solved[i].normal.z > 0; };
    const auto light =
        solved.light(one.albedo, [&](std::size_t i) { return in_groove(i) ? one.albedo : 0; }, 200);
    // what leaves, in parts of what arrives
    double sum = 0, area = 0;
    for (std::size_t i = 0; i < solved.size(); ++i) {
      if (!in_groove(i) || std::fabs(solved[i].position.y) > 20) continue;
      sum += solved.set->area(i) * one.albedo * (1 + light[i]) * (1 - solved.around(i));
      area += solved.set->area(i);
    }
    printf("groove %.0f %.2f: %.5f %.5f\n", one.angle, one.albedo, sum / area, one.effective);
  }
}

}  // namespace
}  // namespace panwright::transport::oracles_test
