// Files and parts, as read: their nodes in order, with their values. Repeatedly used parts and
// included files are stored once.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "materials/material.h"
#include "mli/recipe.h"
#include "pxn/expression/scope.h"
#include "pxn/expression/values.h"
#include "pxn/materials.h"
#include "pxn/reader/files.h"
#include "pxn/reader/imported_model.h"
#include "pxn/text/xml.h"
#include "scene/scene.h"

namespace panwright::pxn {

enum class ItemKind : std::uint8_t {
  node,        // has children, with properties
  appearance,  // data: index into fields
  texture,     // data: index into scene::Scene::textures
  shape,       // data: index into scene::Scene::shapes
  frame,       // data: index into frames
  keypoint,    // data: index into keypoints
  lamp,        // data: index into lamps
  decal,       // data: index into decals
  include,     // data: index of the included file's part
  use,         // data: index of the used part
  import,      // data: index into imports
  wrap,        // data: index into wraps
  joint,       // a node with a joint; data: index into joints
};

inline constexpr std::uint32_t kNoProperties = 0xffffffffu;

// Item, in document order; those of a repeat occur once per run. Those inside one follow it, up to
// `end`.
struct Item {
  ItemKind kind;
  std::uint32_t element;
  std::uint32_t end;         // item index, past the last one inside
  std::uint32_t data;        // by kind
  std::uint32_t properties;  // index into details, or kNoProperties
};

// Material of a back. All empty: the front's.
struct BackMaterial {
  std::int32_t named = -1;   // index into Loader::materials
  std::string_view library;  // or one of the library
};

// Properties of nodes, shapes and uses.
struct NodeProperties {
  std::string name;  // as written; empty: from the kind
  scene::Marks marks;
  std::optional<scene::Transform> transform;
  std::int32_t material = -1;        // index into Loader::materials
  std::optional<BackMaterial> back;  // none: the material's
  std::optional<double> tolerance;   // metres
  std::string_view foil;             // of mli::presets(), over all faces; empty: none
};

struct PartFrame {
  std::string label;
  Vec3 origin;
  Quat rotation;  // node_from_frame
};

struct PartKeypoint {
  std::string name;
  Vec3 position;
};

// Joint, with its references as written; its index fields are not set.
struct PartJoint {
  scene::Joint joint;
  std::string mimic;   // empty: follows none
  std::string gimbal;  // empty: aims alone
  std::string node;    // name of its node; empty: its own
};

// Run of a repeat: its items in the part.
struct Run {
  std::uint32_t begin;
  std::uint32_t end;    // past the last one
  std::uint32_t outer;  // index into runs of the one around; kNoRun for none
};
inline constexpr std::uint32_t kNoRun = 0xffffffffu;

// Decal as scene::Decal, on the shapes of a name in the same run, or else around it.
struct PartDecal {
  std::string on;
  std::uint32_t run = kNoRun;
  scene::Decal decal;
};

// Blanket as written, for faces of any shape.
struct Blanket {
  std::string_view preset;                 // of mli::presets(); empty: none
  std::vector<mli::Operation> operations;  // after those of the preset
  std::uint32_t seed = 0;
  double cell = 0;          // metres; 0: the preset's
  double stand_off = 0;     // metres; 0: by the shape's size
  double tape = 0;          // metres from borders; 0: none
  bool edge = false;        // seams are cut edges
  std::uint32_t faces = 0;  // bits of kFaceWords; 0: all
};
inline constexpr std::string_view kFaceWords[] = {"+x", "-x", "+y", "-y", "+z", "-z"};

// Targets of a blanket: instances matched by both patterns, of those below the nodes of the same
// run, or else around it.
struct PartWrap {
  std::optional<std::string> on, materials;
  std::uint32_t run = kNoRun;
  Blanket blanket;
  std::string faces;  // as written
  // materials of tape and cut edges: indices into Loader::materials; -1: none
  std::int32_t tape = -1, edge = -1;
};

struct File;

// Values given by a use to parameters of its part, by name.
using Arguments = std::map<std::string, Quantity>;
// The same as a key: the members of a Quantity.
using ArgumentsKey =
    std::vector<std::tuple<std::string, double, schemas::Dimension, double, double, int, bool>>;

// Named part or material. Read on first use, a part once for each set of arguments.
struct Definition {
  std::string name;
  File* file = nullptr;
  std::uint32_t element = 0;
  bool reading = false;  // a further request is a cycle
  bool done = false;
  bool used = false;
  std::optional<std::uint32_t> index;  // of the named material, once read, if usable
  // of the part, for each set of arguments
  std::map<ArgumentsKey, std::uint32_t> parts;
};

using Definitions = std::map<std::string, Definition*, std::less<>>;

// A pxn file.
struct File {
  FoundFile found;
  xml::Document document;
  std::unique_ptr<Values> values;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> positions;  // E: line and column of each
  Units units;
  bool y_up = false;
  Scope scope;                         // its parameters, and those of the root's includes
  std::deque<Definition> definitions;  // its own
  Definitions parts;                   // its own, and those of the root's includes
  Definitions materials;
  std::uint32_t level = 0;  // of includes, 0 for the top file
};

// Nodes of a file, or of a <part>.
struct Part {
  File* file = nullptr;
  FileId source = kNoFile;    // of its places: records its first includer or user
  std::uint32_t element = 0;  // the root, or the <part>
  std::string name;           // of a <part>
  std::vector<Item> items;
  std::vector<NodeProperties> properties;
  std::vector<materials::Fields> fields;
  std::vector<PartFrame> frames;
  std::vector<PartKeypoint> keypoints;
  std::vector<scene::Lamp> lamps;  // without nodes
  std::vector<PartDecal> decals;
  std::vector<PartImport> imports;
  std::vector<PartWrap> wraps;
  std::vector<PartJoint> joints;
  std::vector<Run> runs;             // of the repeats with decals or wraps
  std::uint32_t height = 0;          // elements on the longest path, through includes and uses
  std::uint32_t include_height = 0;  // files on the longest path of includes below this one
  bool too_deep = false;             // contents were left out for depth, and reported
  bool loading = true;               // its own includes and uses are being read
};

struct NamedMaterial {
  std::string name;
  materials::Fields fields;
  SourceSpan place;
  Provenance provenance;
  BackMaterial back;
};

}  // namespace panwright::pxn
