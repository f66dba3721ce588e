// Models measured by the cases.
#pragma once

#include <filesystem>
#include <string>

#include "base/axis_box.h"
#include "bench/bench.h"
#include "geometry/tessellate/shape.h"
#include "materials/material.h"
#include "pan/model.h"
#include "scene/scene.h"
#include "world/world.h"

namespace panwright::bench {

// One sphere of radius 1 about the origin.
scene::Scene sphere_scene(const geometry::SphereCounts& counts,
                          const materials::Material& material);

// The material of the paper's figure 8.
materials::Material figure8_material();
// A perfect diffuser of the given albedo.
materials::Material lambert_material(double albedo);

// Compiles a scene; null: refused, with a report.
world::ModelPtr compiled_model(const scene::Scene& scene, DiagnosticLog& log);

// Box of all meshes of a model, world axes: of their own boxes' corners.
AxisBox box_of(const pan::Model& model);

// pxn text of one sphere.
std::string sphere_pxn(const geometry::SphereCounts& counts);
// pxn text of `spheres` small spheres, each in a transform of its own: six elements for each.
std::string many_spheres_pxn(int spheres);

// Writes text into the scratch folder and returns its path; empty: refused.
std::filesystem::path write_scratch(const Context& context, const std::string& name,
                                    const std::string& text);

}  // namespace panwright::bench
