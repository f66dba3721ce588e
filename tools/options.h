// What the command line said, as plain data.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"

namespace panwright::tools {

// Options that every command has.
struct CommonOptions {
  bool json = false;           // one JSON object on standard output
  std::string sarif;           // also write the diagnostics here, as SARIF 2.1.0
  bool quiet = false;          // no notes
  bool timings = false;        // how long each step took, on standard error
  std::string color = "auto";  // auto, always, never
  std::size_t threads = 0;     // 0: all cores
};

// How a CAD file is taken.
struct CadOptions {
  std::string units = "auto";
  std::string up = "auto";
  std::string root;      // folder of what it names; empty: the file's
  std::string scene;     // glTF; empty: the default one
  std::string assume;    // a format: for files that do not say
  bool no_weld = false;  // meshes stay as they are
  double weld = 0;       // metres
  double crease_deg = 30;
  std::uint32_t primitives = 0;  // VRML; 0: exact shapes
  double deflection = 0;         // STEP; metres, 0: by the model's size
  bool crease_normals = false;   // those of the file are computed anew
  bool keep_hidden = false;
  bool recentre = false;
};

// Options of what reads pxn.
struct ReadOptions {
  std::string root;                        // folder that includes may not leave; empty: the file's
  std::uint64_t max_input = 128ull << 20;  // bytes in all
  std::vector<std::string> parameters;     // NAME=VALUE, in place of the model's own values
  std::optional<double> max_error;         // metres in the world; none: what the model needs
  std::uint64_t max_triangles = 1ull << 27;
  CadOptions cad;     // for models that are CAD files
  bool prune = true;  // hidden parts of imports go, which no picture from outside shows
};

struct CompileOptions {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  std::string output;
  std::string depfile;
  std::string license;  // of the original tools: accepted, ignored, noted
  bool strip_sources = false;
  bool compress = false;
};

struct ImportOptions {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  std::string output;  // .pan or .pxn; empty: none
  std::string report;  // .txt, .json or .html; empty: none
  bool compress = false;
  std::string gl = "auto";
};

struct ExportOptions {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  std::string output;  // .glb
};

struct CheckOptions {
  CommonOptions common;
  ReadOptions read;
  std::vector<std::string> inputs;
};

struct InfoOptions {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  bool meshes = false;  // all of them
};

struct DiffOptions {
  CommonOptions common;
  ReadOptions read;
  std::string a;
  std::string b;
  bool all = false;  // provenance too
};

// One camera and Sun state as typed; absent fields fall back to the command line's, then to the
// defaults of docs/conventions.md 2–5.
struct ViewOptions {
  std::optional<std::string> camera;          // "x y z" metres
  std::optional<std::string> look_at;         // "x y z"
  std::optional<std::string> up;              // "x y z"
  std::optional<std::string> quat;            // "w x y z", world_from_camera
  std::optional<std::string> pose;            // "x y z w i j k", world_from_model
  std::optional<std::string> camera_frame;    // name
  std::optional<std::string> sun;             // "x y z", towards the Sun
  std::optional<std::string> sun_distance;    // AU
  std::optional<std::string> sun_irradiance;  // "E" or "Er,Eg,Eb"
  std::optional<std::string> fov;             // angle; bare: degrees
  std::optional<std::string> ifov;            // angle; bare: degrees
  std::optional<std::string> intrinsics;      // "fx,fy,cx,cy" pixels
  std::optional<std::string> ortho;           // metres
  std::optional<std::string> size;            // "WxH"
  std::optional<std::string> ev;
  std::optional<std::string> output;
};

struct RenderOptions {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  ViewOptions view;
  std::string views;  // JSON file of many views
  std::string gl = "auto";
  unsigned samples = 0;  // N; 0: the engine's own
  bool flat = false;
  bool no_shadows = false;
  unsigned shadow_side = 2048;  // texels
  std::uint64_t max_image_bytes = 12ull << 30;

  bool reference = false;   // the path tracer; what follows is for it alone
  std::string until_error;  // "0.1%" or a fraction; empty: none
  std::uint64_t seed = 0;
  unsigned max_samples = 1u << 26;  // of a pixel, with until_error
  unsigned bounces = 3;
  std::string filter = "box";  // or "gaussian:σ" in pixels
  double limb_darkening = 0;   // u, 0 to 1
  bool no_sun_disc = false;
};

struct MaterialOptions {
  CommonOptions common;
  ReadOptions read;
  std::vector<std::string> inputs;  // pxn files, and materials of the library
  std::string name;                 // of one in the files; empty: all
  bool all = false;                 // the whole library too
  bool list = false;
  bool show = false;          // the text of a library's material
  std::string albedo;         // cosines, with commas
  std::string svg;            // folder for plots
  std::string fit;            // table of measured reflectance
  std::string render;         // picture of samples
  std::uint32_t width = 480;  // of one material in the picture, pixels
  std::string engine = "gl";
  std::string gl = "auto";
};

struct FmtOptions {
  CommonOptions common;
  std::uint64_t max_input = 128ull << 20;  // bytes of each file
  std::vector<std::string> inputs;         // "-": standard input
  std::string output;                      // empty: each file itself; "-": standard output
  bool check = false;                      // write nothing, name the files that would change
};

struct UpgradeOptions {
  CommonOptions common;
  std::string root;
  std::uint64_t max_input = 128ull << 20;  // bytes of a model
  std::vector<std::string> inputs;
  std::string output;  // empty: each file itself
};

struct ExpandOptions {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  std::string output;
};

struct ExplainOptions {
  CommonOptions common;
  std::string code;  // empty: lists all
};

}  // namespace panwright::tools
