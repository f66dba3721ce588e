// Lamps as words.
#include "workspace/lamp_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/diagnostic.h"
#include "world/lamps.h"

namespace panwright::workspace::lamp_text_test {
namespace {

template <class Kind>
Kind read_as(const std::string& text, world::Lamp::Carrier carrier) {
  DiagnosticLog log;
  const auto lamp = lamp_of(text, {}, log);
  EXPECT_TRUE(lamp && log.entries().empty()) << text << '\n' << to_text(log);
  if (!lamp) return {};
  EXPECT_EQ(lamp->carrier, carrier);
  EXPECT_TRUE(std::holds_alternative<Kind>(lamp->source)) << text;
  return std::get<Kind>(lamp->source);
}

TEST(LampText, Kinds) {
  using Carrier = world::Lamp::Carrier;
  const auto spot = read_as<light::Spot>(
      "spot on camera at 30cm 0 0 toward 0.3 0 5 intensity 100 half-angle 20deg", Carrier::camera);
  EXPECT_EQ(spot.position, Vec3(0.3, 0, 0));
  EXPECT_EQ(glm::normalize(spot.axis), Vec3(0, 0, 1));
  EXPECT_EQ(spot.intensity, Vec3(100));
  EXPECT_NEAR(spot.half_angle, 20 * kDegree, 1e-15);
  EXPECT_EQ(spot.exponent, 0);
  const auto point =
      read_as<light::Point>("point intensity 1 2 3 at 1, 2, 3 radius 5mm", Carrier::world);
  EXPECT_EQ(point.intensity, Vec3(1, 2, 3));
  EXPECT_EQ(point.position, Vec3(1, 2, 3));
  EXPECT_EQ(point.radius, 0.005);
  const auto led = read_as<light::Spot>("led power 3", Carrier::world);
  EXPECT_EQ(led.exponent, 1);
  EXPECT_NEAR(led.intensity.x, 3 / kPi, 1e-15);
  const auto disc = read_as<light::Disc>("disc power 2 radius 1 toward 1 0 0", Carrier::world);
  EXPECT_EQ(disc.axis, Vec3(1, 0, 0));
  EXPECT_NEAR(disc.intensity.x, 2 / kPi, 1e-15);
}

// Power is the integral of the intensity over all directions.
TEST(LampText, Power) {
  for (const char* cone : {"half-angle 10deg", "half-angle 170deg", "half-angle 50deg exponent 3",
                           "half-angle 120deg exponent 0.5"}) {
    const auto spot =
        read_as<light::Spot>(std::string("spot power 7 ") + cone, world::Lamp::Carrier::world);
    double power = 0;
    constexpr int n = 100000;
    for (int k = 0; k < n; ++k) {
      const double angle = (k + 0.5) * kPi / n;
      const Vec3 away(std::sin(angle), 0, std::cos(angle));
      power += light::incidence(spot, away).irradiance.x * 2 * kPi * std::sin(angle) * kPi / n;
    }
    EXPECT_NEAR(power, 7, 5e-3) << cone;  // 1.2e-3: steps at the edge of the cone
  }
}

TEST(LampText, WhatIsWrongIsSaid) {
  for (const auto& [text, words] : std::initializer_list<std::pair<const char*, const char*>>{
           {"", "expected spot, point, disc or led"},
           {"spot intensity 1 pulse 1", "expected two times after it"},
           {"spot intensity 1 pulse 2ms 1ms", "expected two times after it"},
           {"spot intensity 1 pulse 0 1 pulse 0 1", "expected each word once"},
           {"bulb intensity 1", "has 'bulb', expected spot"},
           {"spot", "expected intensity or power"},
           {"spot intensity 1 power 1", "expected intensity or power"},
           {"spot intensity", "has 'intensity', expected one number or three"},
           {"spot intensity -1", "expected one number or three after it, 0 to 1e30"},
           {"spot intensity nan", "expected one number"},
           {"spot intensity 1 2", "expected one number or three"},
           {"spot intensity 1 at 1 2", "has 'at', expected three lengths"},
           {"spot intensity 1 at 1 2 20deg", "has 'at', expected three lengths"},
           {"spot intensity 1 half-angle 200deg", "has '200deg', expected an angle up to 180deg"},
           {"spot intensity 1 half-angle", "has 'half-angle', expected an angle"},
           {"spot intensity 1 radius -1", "has '-1', expected a length"},
           {"spot intensity 1 exponent x", "has 'x', expected a number"},
           {"spot intensity 1 colour red", "has 'colour', expected on, at"},
           {"spot intensity 1 intensity 2", "has 'intensity', expected each word once"},
           {"spot intensity 1 at 1 1 1 toward 1 1 1", "expected another point"},
           {"spot intensity 1 on", "expected camera, TARGET/FRAME"},
           {"spot intensity 1 on mars", "has 'mars', expected camera"},
           {"point intensity 1 toward 1 0 0", "expected no direction"},
           {"point intensity 1 exponent 2", "expected no half-angle"},
           {"disc intensity 1", "expected a radius above 0"}}) {
    DiagnosticLog log;
    EXPECT_FALSE(lamp_of(text, {}, log)) << text;
    ASSERT_EQ(log.errors(), 1u) << text;
    EXPECT_NE(log.entries()[0].message.find(words), std::string::npos)
        << log.entries()[0].message << "\nexpected " << words;
  }
}

world::Lamp lamp_from(const std::string& text) {
  DiagnosticLog log;
  const auto lamp = lamp_of(text, {}, log);
  EXPECT_TRUE(lamp) << to_text(log);
  return lamp.value_or(world::Lamp());
}

TEST(LampText, Pulses) {
  EXPECT_EQ(lamp_from("point intensity 1 pulse -1.5ms 250us").pulse,
            (world::Pulse{-1.5e-3, 250e-6}));
  EXPECT_EQ(lamp_from("point intensity 1 pulse 2 3s").pulse, (world::Pulse{2, 3}));
  EXPECT_FALSE(lamp_from("point intensity 1").pulse);
}

// Lamps of a camera that look from it and do not turn with another one.
TEST(LampText, FixedToWhereTheCameraIs) {
  const std::vector<std::string> texts = {
      "led at 1 2 3 intensity 4", "nav off",
      "spot on camera at 0.1 0 0 toward 0.1 0 5 intensity 1 2 3 half-angle 20deg exponent 2 radius "
      "0.05 pulse 0 1ms"};
  std::vector<world::Lamp> lamps = {lamp_from(texts[0]), lamp_from(texts[2])};
  world::Lamp of_model = lamps[0];
  of_model.name = "nav";
  lamps.insert(lamps.begin(), of_model);
  world::Camera camera;
  camera.position = {5, 0, 0};
  camera.world_from_camera = glm::angleAxis(kPi / 2, Vec3(0, 1, 0));  // z to x, x to -z
  const auto fixed = fixed_lamp_texts(texts, lamps, camera);
  ASSERT_EQ(fixed.size(), 3u);
  EXPECT_EQ(fixed[0], texts[0]);
  EXPECT_EQ(fixed[1], texts[1]);
  const world::Lamp lamp = lamp_from(fixed[2]);
  EXPECT_EQ(lamp.carrier, world::Lamp::Carrier::world);
  EXPECT_EQ(lamp.pulse, (world::Pulse{0, 1e-3}));
  const auto& spot = std::get<light::Spot>(lamp.source);
  EXPECT_LT(glm::length(spot.position - Vec3(5, 0, -0.1)), 1e-14);
  EXPECT_LT(glm::length(glm::normalize(spot.axis) - Vec3(1, 0, 0)), 1e-14);
  EXPECT_EQ(spot.intensity, Vec3(1, 2, 3));
  EXPECT_EQ(spot.half_angle, 20 * kDegree);
  EXPECT_EQ(spot.exponent, 2);
  EXPECT_EQ(spot.radius, 0.05);
}

TEST(LampsDuring, ShareOfAnExposure) {
  const auto intensity = [](double begin, double end) {
    const auto lamps = world::lamps_during({lamp_from("point intensity 8 pulse 1 3")}, begin, end);
    EXPECT_FALSE(lamps[0].pulse);
    return lamps[0].on ? std::get<light::Point>(lamps[0].source).intensity.x : 0.0;
  };
  EXPECT_EQ(intensity(1, 3), 8);
  EXPECT_EQ(intensity(1.5, 2.5), 8);
  EXPECT_EQ(intensity(0, 4), 4);
  EXPECT_EQ(intensity(-1, 2), 8.0 / 3);
  EXPECT_EQ(intensity(3, 4), 0);
  EXPECT_EQ(intensity(0, 1), 0);
  EXPECT_EQ(intensity(1, 1), 8);  // instants
  EXPECT_EQ(intensity(3, 3), 0);
}

}  // namespace
}  // namespace panwright::workspace::lamp_text_test
