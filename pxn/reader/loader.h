// Loader of files into parts, with their includes and used parts.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/hash.h"
#include "materials/spectra.h"
#include "mli/trim.h"
#include "pxn/expression/values.h"
#include "pxn/pxn.h"
#include "pxn/reader/files.h"
#include "pxn/reader/joint_axis.h"
#include "pxn/reader/part.h"
#include "pxn/text/reporter.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Shapes of a sheet of foil, by mli::Cover; none for absent ones.
using FoilShapes = std::array<std::optional<std::uint32_t>, mli::kCovers>;

struct Preset;

// Loader. Shapes, textures, inputs and the budget go into the scene, each once; parts hold their
// placements.
class Loader {
 public:
  Loader(Files& files, const Options& options, Reporter& reporter, scene::Scene& scene,
         const Job& job)
      : files_(files), options_(options), reporter_(reporter), scene_(scene), job_(job) {}

  // Job of the load. All reading functions throw Cancelled.
  const Job& job() const { return job_; }

  // Returns the index of the part; nothing without a known root element, or beyond the limits of
  // elements or nodes.
  std::optional<std::uint32_t> load_top(const FoundFile& top);

  // Checks that the assembled scene has the frame named by the budget. Reports: E1311.
  void check_approach();

  const Part& part(std::uint32_t index) const { return parts_[index]; }
  const NamedMaterial& material(std::int32_t index) const {
    return materials_[static_cast<std::size_t>(index)];
  }
  const std::vector<NamedMaterial>& materials() const { return materials_; }
  const ImportedModel& model(std::uint32_t index) const { return models_[index]; }
  double foil_vertices() const { return foil_vertices_; }

 private:
  // Part being read.
  struct Work {
    File& file;
    Part& part;
    const Scope* scope;          // the file's, or that of a repeat's variable
    std::uint32_t run = kNoRun;  // of the innermost repeat around
  };
  // Use of a texture. Each use of a file is a texture of its own.
  enum class TextureKind { color, linear, cutout };

  // ---- loader.cpp: files and nodes
  std::optional<std::uint32_t> load(const FoundFile& file, SourceSpan included_at,
                                    std::uint32_t level);
  std::uint32_t add_part(File& file, std::uint32_t element);
  void walk(Work& work, std::uint32_t element, std::uint32_t depth);
  void walk_children(Work& work, std::uint32_t element, std::uint32_t depth);
  std::optional<std::uint32_t> add_item(Work& work, ItemKind kind, std::uint32_t element,
                                        std::uint32_t data,
                                        std::uint32_t properties = kNoProperties);
  void read_node(Work& work, std::uint32_t element, std::uint32_t depth, std::uint32_t properties);
  void read_appearance(Work& work, std::uint32_t element, std::uint32_t depth);
  void read_texture(Work& work, std::uint32_t element, std::uint32_t depth);
  static std::uint64_t least_items(const File& file, std::uint32_t element, std::uint64_t limit);
  bool fits_in_model(Work& work, std::uint32_t element, std::uint64_t count);
  void read_repeat(Work& work, std::uint32_t element, std::uint32_t depth);
  void check_group_count(Work& work, std::uint32_t element);
  void read_include(Work& work, std::uint32_t element, std::uint32_t depth);
  void read_use(Work& work, std::uint32_t element, std::uint32_t depth);
  // Returns true if a part may be placed in another: no cycle, not too deep.
  bool fits_in(Work& work, std::uint32_t element, SourceSpan where, const Part& inner,
               const std::string& name, std::uint32_t depth);
  // Finds the file named by an element; nothing: reported as E1301 or E1303.
  std::optional<FoundFile> find(Work& work, std::uint32_t element, std::size_t attribute,
                                const std::string& file);
  void add_input(const FoundFile& file, std::span<const std::byte> bytes);

  // ---- definitions.cpp: parameters, materials, parts, the budget
  void read_root(File& file);
  void import_definitions(File& file, std::uint32_t element);
  void merge(File& file, const Definitions& from, Definitions& to, std::uint32_t element);
  std::optional<std::string> parameter_name(File& file, std::uint32_t element, const Scope& scope);
  void read_parameter(File& file, std::uint32_t element);
  std::optional<Quantity> overriding_value(const std::string& name, const std::string& value,
                                           const Units& units);
  void define(File& file, std::uint32_t element, std::size_t attribute, Definitions& known);
  void read_budget(File& file, std::uint32_t element);
  void read_definitions(File& file);
  std::optional<std::uint32_t> part_of(Definition& definition, const Arguments& arguments,
                                       SourceSpan used_at);
  void read_part_parameters(File& file, std::uint32_t element, const Arguments& arguments,
                            Scope& scope);
  bool read_arguments(Work& work, std::uint32_t element, const Definition& definition,
                      Arguments& arguments);
  std::optional<std::uint32_t> material_of(Definition& definition);
  const Preset* preset_of(File& file, std::uint32_t element);
  void read_backs(File& file);
  BackMaterial back_of(File& file, std::uint32_t element, std::size_t which);
  // Finds the definition named by an attribute; nothing: reported as E1311.
  Definition* look_up(File& file, std::uint32_t element, std::size_t attribute,
                      const Definitions& known, std::string_view what);
  void check_overrides();

  // ---- node_properties.cpp: properties of nodes and shapes
  std::uint32_t read_properties(Work& work, std::uint32_t element);
  bool read_rotation(Work& work, std::uint32_t element, Quat& out);
  std::optional<Quat> unit_quat(Work& work, std::uint32_t element, SourceSpan where,
                                std::span<const double> q);
  void read_placing_children(Work& work, std::uint32_t element, scene::Transform& transform);
  void read_frame_s(Work& work, std::uint32_t element);
  void read_frame(Work& work, std::uint32_t element);
  void read_keypoint(Work& work, std::uint32_t element);
  // terrain_reader.cpp
  void read_terrain(File& file, std::uint32_t element);
  std::optional<materials::Material> ground_material(File& file, std::uint32_t element);
  bool whole(Work& work, std::uint32_t element, std::size_t attribute, const char* what,
             std::span<const double> numbers, std::span<std::uint32_t> out);
  std::optional<AlbedoText> read_albedo(Work& work, std::uint32_t element);
  std::optional<DemText> read_dem(Work& work, std::uint32_t element);
  // lights.cpp
  void read_lamp(Work& work, std::uint32_t element);
  void read_scene(File& file, std::uint32_t element);
  void read_shape(Work& work, std::uint32_t element);
  void read_blanket(Work& work, std::uint32_t element);
  FoilShapes foil_shapes(Work& work, std::uint32_t element);
  void add_trim(Work& work, std::uint32_t element, const FoilShapes& shapes,
                std::uint32_t properties);
  std::optional<std::uint32_t> material_at(Work& work, std::uint32_t element, std::size_t which);
  std::uint32_t known_shape(geometry::Shape shape);

  // ---- import_reader.cpp: CAD files
  void read_import(Work& work, std::uint32_t element);
  std::optional<std::uint32_t> imported_model(Work& work, std::uint32_t element,
                                              const FoundFile& found);
  void note_unused(Work& work, std::uint32_t element, importers::Format format, bool cleaned);
  void take_over(ImportedModel& model, const FoundFile& found);
  void read_import_rule(Work& work, std::uint32_t rule, PartImport& import);
  std::vector<char> chosen_instances(Work& work, std::uint32_t rule, std::size_t nodes,
                                     std::size_t materials, const ImportedModel& model);

  // ---- joint_reader.cpp
  void read_joint(Work& work, std::uint32_t element, std::uint32_t depth);
  // Reads a joint's motion; nothing if invalid: reported.
  std::optional<PartJoint> joint_of(Work& work, std::uint32_t element);
  std::string aim_of(Work& work, std::uint32_t element, PartJoint& joint);
  void read_import_joint(Work& work, std::uint32_t rule, PartImport& import);

  // ---- joint_axis.cpp
  // Completes a missing axis or origin by the surface of revolution of the nodes' faces. False
  // without a suitable one: reported.
  bool axis_from_faces(Work& work, std::uint32_t rule, const PartImport& import,
                       PartImport::Moved& moved, PartJoint& joint);
  std::vector<AxisLine> lines_in(const PartImport& import, const std::vector<char>& nodes);

  // ---- spectra_files.cpp
  // Reads n and k of the table named by an attribute; nothing: reported.
  std::optional<materials::Conductor> spectrum(Work& work, std::uint32_t element,
                                               std::size_t attribute);
  // Reads those of a named material's conductor and coat.
  void read_spectra(Work& work, std::uint32_t element, materials::Fields& fields);

  // ---- textures.cpp
  std::optional<std::uint32_t> read_sphere_texture(Work& work, std::uint32_t element);
  void read_decal(Work& work, std::uint32_t element);
  materials::Maps read_maps(Work& work, std::uint32_t element, const materials::Maps& base);
  std::optional<std::uint32_t> texture_of(Work& work, std::uint32_t element, std::size_t attribute,
                                          TextureKind use);
  std::optional<std::uint32_t> load_texture(Work& work, std::uint32_t element,
                                            std::size_t attribute, const std::string& file,
                                            const FoundFile& found, TextureKind use);

  Files& files_;
  const Options& options_;
  Reporter& reporter_;
  scene::Scene& scene_;
  const Job job_;
  File* budget_file_ = nullptr;  // with the effective budget, and its element
  std::uint32_t budget_ = 0;
  // note: addresses stay while these grow
  std::deque<File> loaded_files_;
  std::deque<Part> parts_;
  std::vector<NamedMaterial> materials_;
  std::deque<ImportedModel> models_;
  std::map<std::string, std::optional<std::uint32_t>> known_models_;  // by file and options
  std::map<std::string, std::optional<std::uint32_t>> known_files_;   // by key: their parts
  std::map<std::pair<std::string, TextureKind>, std::optional<std::uint32_t>> known_textures_;
  std::map<std::string, std::optional<materials::Conductor>> known_spectra_;
  std::map<Hash128, std::uint32_t> known_shapes_;
  std::map<std::vector<double>, FoilShapes> known_foils_;  // by FoilSheet::key()
  double foil_vertices_ = 0;                               // so far
  std::map<std::pair<const File*, std::uint32_t>, std::uint32_t> known_meshes_;  // in repeats
  std::set<std::string> parameters_;                                             // of all files
  std::set<std::string> inputs_;     // keys of files that count as inputs
  std::uint32_t nesting_ = 0;        // definitions being read
  std::uint32_t repeats_ = 0;        // around the current element
  bool complete_ = true;             // false: a limit was reached
  std::uint64_t elements_ = 0;       // so far
  std::uint64_t runs_ = 0;           // of all repeats, so far
  std::uint64_t items_ = 0;          // so far
  std::uint64_t texture_bytes_ = 0;  // so far
};

// Returns the first child of an element with this id, or 0.
std::uint32_t child_of(const xml::Document& document, std::uint32_t element, schemas::ElementId id);

// Returns the index of an attribute in the tables of an element; nothing if it has none.
std::optional<std::size_t> attribute_of(const xml::Document& document, std::uint32_t element,
                                        std::string_view name);

}  // namespace panwright::pxn
