// VRML 1.0 texts in memory, and queries of their scenes.
#pragma once

#include <gtest/gtest.h>

#include "vrml_reading.h"

namespace panwright::importers::vrml {

inline std::unique_ptr<Reading> read10(const std::string& body, const Options& options = {}) {
  auto reading = read_files({{"model.wrl", "#VRML V1.0 ascii\n" + body}}, options);
  if (reading->out) {
    EXPECT_EQ(reading->out->format, Format::vrml1);
    EXPECT_EQ(scene::check(reading->out->scene), "");
  }
  return reading;
}

inline const scene::Instance& instance(const Reading& reading, std::size_t i = 0) {
  return reading.scene().instances.at(i);
}
inline const geometry::Shape& shape(const Reading& reading, std::size_t i = 0) {
  return reading.scene().shapes.at(static_cast<std::size_t>(instance(reading, i).shape));
}
inline const geometry::Mesh& mesh(const Reading& reading, std::size_t i = 0) {
  return *std::get<geometry::MeshShape>(shape(reading, i));
}
inline const materials::Material& material(const Reading& reading, std::size_t i = 0) {
  return reading.scene().materials.at(static_cast<std::size_t>(instance(reading, i).material));
}
inline Mat4 world(const Reading& reading, std::size_t i = 0) {
  return scene::world_from_nodes(reading.scene())
      .at(static_cast<std::size_t>(instance(reading, i).node));
}
inline Vec3 moved(const Reading& reading, const Vec3& p, std::size_t i = 0) {
  return Vec3(world(reading, i) * Vec4(p, 1));
}
inline std::string node_name(const Reading& reading, std::size_t i = 0) {
  return reading.scene().nodes.at(static_cast<std::size_t>(instance(reading, i).node)).name;
}

// One triangle with its first corner at the origin.
inline const std::string kTriangle =
    "Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] } IndexedFaceSet { coordIndex [ 0, 1, 2, -1 ] }\n";

}  // namespace panwright::importers::vrml
