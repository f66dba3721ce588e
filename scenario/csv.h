// Tables of frames as CSV: named columns with units.
//
// The first line names the columns, as time[s],client.x[m],client.y[m],client.z[m]. Fields end at
// commas, semicolons or tabs, whichever the first line has; lines that begin with # are skipped.
//
// Columns:
//   time[s]                     also ms, us, ns, min, h; none: frames by their order
//   time[s since EPOCH SYSTEM]  as time[s since 2026-01-01T00:00:00 TAI]
//   time[UTC]                   epochs as text; also TAI, TT, TDB, GPS
//   T.x[m] T.y[m] T.z[m]        position of target T, or of camera; also km, cm, mm
//   T.vx[m/s] …                 its velocity, for Hermite interpolation; also km/s, cm/s, mm/s
//   T.qw[world_from_model] …    its rotation, qw qx qy qz, Hamilton: p_world = q·p_model·q⁻¹; or
//                               model_from_world; of camera world_from_camera, camera_from_world
//   T.joint.NAME[deg]           value of a joint; also rad, m, km, cm, mm, 1 (a factor)
//   T.joint.NAME:2[deg]         its second value
//   camera.fov[deg]             full horizontal angle; also rad
//   camera.fx[px] fy cx cy      focal length and principal point
//   sun.x sun.y sun.z           direction to the Sun in world axes, any length
//   sun.distance[AU]            also km, m
//   name, seed                  of the frame
#pragma once

#include "base/result.h"
#include "scenario/method.h"
#include "scenario/source.h"
#include "scenario/text.h"

namespace panwright::scenario {

struct CsvOptions {
  Method method = Method::linear;  // between rows; rotations, joints and others: linear or cubic
  std::size_t degree = 7;          // of Lagrange's and Hermite's polynomial
  bool strict = false;             // unknown columns are errors
};

// Reads a table. Its own frames are its rows.
//
// Reports: W8002, W8006, W8011. Fails: E8001, E8004, E8005, E8007.
Result<SourcePtr> read_csv(const Text& text, const CsvOptions& options, DiagnosticLog& log);

}  // namespace panwright::scenario
