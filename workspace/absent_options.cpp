#include "workspace/absent_options.h"

#include <algorithm>
#include <initializer_list>
#include <string>

namespace panwright::workspace {

namespace {

struct Absent {
  std::initializer_list<std::string_view> names;
  std::string_view instead;
};

constexpr std::string_view kSensor =
    "a table [detector] in the camera's file makes numbers with noise (docs/detector.md)";
constexpr std::string_view kSky =
    "--sky stars,earth,moon,sun with --date and --orbit draws the sky of a date, --planet NAME=\"X "
    "Y "
    "Z\" places bodies, --stars V draws stars (docs/sky-by-date.md, docs/sky.md, docs/stars.md)";
constexpr std::string_view kLayers =
    ".npz and .exr hold depth, range, normals and ids; meta.json names the ids and has the "
    "keypoints in pixels (docs/image-files.md)";

const Absent kAbsent[] = {
    {{"noise", "read-noise", "shot-noise", "dark-current", "full-well", "iso", "quantum-efficiency",
      "detector", "sensor", "bit-depth"},
     kSensor},
    {{"star-catalog", "magnitude", "background", "skybox", "earth", "moon", "planets",
      "environment", "hdri", "atmosphere"},
     kSky},
    {{"exposure-time", "gamma", "brightness", "tone-mapping"},
     "--ev STOPS, or --ev auto, sets the exposure of a PNG, --tone photo its curve; the other "
     "formats hold radiance; --exposure is that of a detector"},
    {{"labels", "label", "mask", "masks", "segmentation", "annotations", "boxes", "bbox",
      "keypoints"},
     "--labels of 'render' and [labels] of a scenario write masks, boxes and keypoints "
     "(docs/labels.md)"},
    {{"depth", "normals", "ids", "ground-truth"}, kLayers},
    {{"distort", "lens", "k1", "k2", "calibration"},
     "--camera-file FILE or --distortion \"MODEL K…\" sets the distortion of the lens "
     "(docs/cameras.md)"},
    {{"vignetting", "aperture", "dof", "motion-blur"},
     "tables [optics] and [detector] in the camera's file have them (docs/detector.md)"},
    {{"light", "lights", "lamps", "spotlight", "ambient"},
     "--sun \"X Y Z\" places the Sun, --lamp adds a light (docs/lamps.md)"},
    {{"resolution", "width", "height", "res"}, "--size WxH sets the pixels"},
    {{"position", "eye", "location"}, "--camera \"X Y Z\" places the camera"},
    {{"attitude", "quaternion", "orientation", "rotation"},
     "--quat \"QW QX QY QZ\" turns the camera, --pose a target"},
    {{"focal-length", "focal"}, "--intrinsics \"FX FY CX CY\", --fov or --ifov sets the lens"},
    {{"time", "epoch", "datetime", "utc", "orbital-elements", "kepler", "tle", "trajectory"},
     "--date UTC and --orbit place the Earth, the Moon and the Sun (docs/sky-by-date.md); "
     "`panwright "
     "run` takes trajectories (docs/scenarios.md)"},
};

}  // namespace

std::string_view instead_of(std::string_view name) {
  std::string plain(name);
  std::ranges::replace(plain, '_', '-');
  for (const Absent& absent : kAbsent)
    if (std::ranges::find(absent.names, plain) != absent.names.end()) return absent.instead;
  return {};
}

}  // namespace panwright::workspace
