// CAD files, and the rules that dress them.

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/file_uses.h"
#include "base/text.h"
#include "importers/clean.h"
#include "importers/palette.h"
#include "pxn/import_template.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/pattern.h"
#include "pxn/reader/shapes.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using schemas::ElementId;

namespace {

// Files named by an imported one, within the root of the model's files.
class ImportFiles : public importers::Files {
 public:
  ImportFiles(pxn::Files& files, const FoundFile& model, const DiagnosticLog& log)
      : files_(files), model_(model), log_(log.apart()) {}

  Outcome read(const std::string& path, SharedText& bytes) override {
    FoundFile found;
    switch (files_.find(path, model_, true, found)) {
      case pxn::Files::Outcome::missing:
        return Outcome::missing;
      case pxn::Files::Outcome::outside:
        return Outcome::outside;
      case pxn::Files::Outcome::found:
        break;
    }
    DiagnosticLog log = log_.apart();  // the importer says it in its own words
    const auto loaded = files_.load(found, {}, log);
    if (!loaded) return log.contains(Code("E0104")) ? Outcome::too_large : Outcome::unreadable;
    bytes = *loaded;
    return Outcome::found;
  }

  std::optional<std::string> same_but_for_case(const std::string& path) override {
    return files_.same_but_for_case(path, model_);
  }

  std::optional<std::string> relative(const std::string& path) const override {
    const std::filesystem::path folder = std::filesystem::path(model_.key).parent_path();
    return std::filesystem::path(path)
        .lexically_normal()
        .lexically_relative(folder)
        .generic_string();
  }

  void declare(const std::string& path) override {
    if (log_.files()) log_.files()->will_read(std::filesystem::path(display_name(path)));
  }

  std::string display_name(const std::string& path) const override {
    return (std::filesystem::path(model_.name).parent_path() / path).lexically_normal().string();
  }

 private:
  pxn::Files& files_;
  const FoundFile& model_;
  const DiagnosticLog log_;  // an empty one of the run
};

// Images of at most this many texels are looked up for colours, not seen as images.
constexpr std::uint64_t kPaletteTexels = 64 * 64;

bool has_diffuse(const materials::Fields& fields) {
  DiagnosticLog said;  // where the material stands
  const materials::Material material = materials::resolved(fields, {}, said);
  return material.weights.x > 0 && material.diffuse != Vec3(0);
}

}  // namespace

std::int32_t base_texture(const importers::Imported& imported, const scene::Instance& instance) {
  if (instance.texture != scene::kNone) return instance.texture;
  const auto material = static_cast<std::size_t>(instance.material);
  const materials::Maps& maps = imported.scene.materials[material].maps;
  if (maps.albedo >= 0) return maps.albedo;
  const std::int32_t palette = imported.materials[material].palette;
  return palette >= 0 ? palette : maps.reflectance;
}

std::optional<std::uint32_t> Loader::imported_model(Work& work, std::uint32_t element,
                                                    const FoundFile& found) {
  Values& values = *work.file.values;
  importers::Options options;
  geometry::CleanOptions clean;
  const auto word = [&](std::size_t which) { return values.text_or_default(element, which); };
  const std::string units = word(attribute::import_units);
  const std::string up = word(attribute::import_up);
  const bool cleaned = word(attribute::import_clean) != "no";
  const std::string scene = word(attribute::import_scene);
  clean.keep_normals = word(attribute::import_normals) != "crease";
  clean.tolerance = values.real_or_default(element, attribute::import_weld);
  options.crease_angle = values.real_or_default(element, attribute::import_crease);
  clean.crease_angle = options.crease_angle;
  if (!scene.empty()) options.scene = scene;
  const std::string animation = word(attribute::import_animation);
  if (!animation.empty()) options.animation = animation;
  if (values.has(element, attribute::import_time))
    options.time = values.real_or_default(element, attribute::import_time);
  options.primitives =
      static_cast<std::uint32_t>(values.integer_or_default(element, attribute::import_primitives));
  options.deflection = values.real_or_default(element, attribute::import_deflection);
  options.limits.nodes = options_.limits.nodes;
  options.limits.texture_bytes = options_.limits.texture_bytes - texture_bytes_;

  const std::string key = fmt::format(
      "{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", found.key, units, up, cleaned,
      clean.keep_normals, clean.tolerance, options.crease_angle, scene, options.primitives,
      options.deflection, animation, options.time ? format_double(*options.time) : std::string());
  const auto known = known_models_.find(key);
  if (known != known_models_.end()) return known->second;
  auto& index = known_models_[key];

  ImportFiles files(files_, found, reporter_.log());
  auto imported = importers::import_from(
      files, std::filesystem::path(found.path).filename().generic_string(), options,
      reporter_.log(), values.value_place(element, attribute::import_file), job_);
  job_.poll();
  if (!imported) return std::nullopt;
  note_unused(work, element, imported->format, cleaned);
  // first, as lengths of cleaning are metres of the world
  const std::size_t nodes = imported->scene.nodes.size();
  importers::place(*imported, importers::unit_of(units), importers::up_of(up), false,
                   reporter_.log());
  if (cleaned &&
      !importers::clean_up(imported->scene, clean, reporter_.log(), job_, options_.cache))
    throw Cancelled();
  importers::split_palettes(*imported, reporter_.log(), job_);
  index = static_cast<std::uint32_t>(models_.size());
  ImportedModel& model = models_.emplace_back();
  model.imported = std::move(*imported);
  model.top = model.imported.scene.nodes.size() > nodes ? 1 : 0;
  // patterns are UTF-8, whatever the names of the file are
  for (scene::Node& node : model.imported.scene.nodes)
    node.name = to_utf8(node.name, Encoding::utf8);
  for (importers::CadMaterial& material : model.imported.materials)
    material.name = to_utf8(material.name, Encoding::utf8);
  model.material_names = numbered_names(model.imported.materials);
  take_over(model, found);
  return index;
}

// Attributes that are for files of another format, or for cleaning that is switched off.
void Loader::note_unused(Work& work, std::uint32_t element, importers::Format format,
                         bool cleaned) {
  using importers::Format;
  Values& values = *work.file.values;
  const auto note = [&](std::size_t which, const char* message) {
    if (!values.has(element, which)) return;
    reporter_.report(Code("N1405"), values.value_place(element, which), work.file.document, element,
                     [&] { return Reporter::Text(message); });
  };
  if (!cleaned) {
    note(attribute::import_weld, "'weld' has no effect with clean=\"no\"");
    note(attribute::import_normals, "'normals' has no effect with clean=\"no\"");
  }
  if (format != Format::gltf) note(attribute::import_scene, "'scene' is for glTF files only");
  if (format != Format::gltf)
    note(attribute::import_animation, "'animation' is for glTF files only");
  if (format != Format::gltf) note(attribute::import_time, "'time' is for glTF files only");
  if (format != Format::vrml97 && format != Format::vrml1)
    note(attribute::import_primitives, "'primitives' is for VRML files only");
  if (format != Format::step)
    note(attribute::import_deflection, "'deflection' is for STEP files only");
}

// Moves shapes, textures and inputs of a CAD file into the scene.
void Loader::take_over(ImportedModel& model, const FoundFile& found) {
  scene::Scene& from = model.imported.scene;
  const std::filesystem::path folder = std::filesystem::path(found.path).parent_path();
  for (scene::Input& input : from.inputs) {
    input.path = (folder / input.path).lexically_normal().generic_string();
    if (inputs_.insert("import\n" + input.path).second) scene_.inputs.push_back(input);
  }
  for (scene::Texture& texture : from.textures) {
    texture_bytes_ += texture.rgba.size();
    model.textures.push_back(static_cast<std::int32_t>(scene_.textures.size()));
    scene_.textures.push_back(std::move(texture));
  }
  from.textures.clear();
  for (geometry::Shape& shape : from.shapes) {
    model.shapes.push_back(static_cast<std::int32_t>(scene_.shapes.size()));
    scene_.shapes.push_back(std::move(shape));
  }
  from.shapes.clear();
}

void Loader::read_import(Work& work, std::uint32_t element) {
  Values& values = *work.file.values;
  const auto name = values.text(element, attribute::import_file);
  if (!name) return;
  const auto found = find(work, element, attribute::import_file, *name);
  if (!found) return;
  const auto model = imported_model(work, element, *found);
  // problems of the file itself are already reported
  if (!model) return;
  PartImport import;
  import.model = *model;
  const std::size_t instances = models_[*model].imported.scene.instances.size();
  import.removed.resize(instances);
  import.materials.assign(instances, -1);
  import.keeps_texture.assign(instances, 1);
  import.foils.resize(instances);
  import.keep_hidden = values.text_or_default(element, attribute::import_hidden) == "keep";
  const xml::Document& document = work.file.document;
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next)
    read_import_rule(work, c, import);
  const std::uint32_t properties = read_properties(work, element);
  work.part.imports.push_back(std::move(import));
  add_item(work, ItemKind::import, element,
           static_cast<std::uint32_t>(work.part.imports.size() - 1), properties);
}

// Which instances of the file a rule is about; reported as W1501 when there are none.
std::vector<char> Loader::chosen_instances(Work& work, std::uint32_t rule, std::size_t nodes,
                                           std::size_t materials, const ImportedModel& model) {
  Values& values = *work.file.values;
  const scene::Scene& scene = model.imported.scene;
  std::vector<char> chosen(scene.instances.size(), 1);
  const auto narrow = [&](std::size_t which, std::string_view what, const auto& applies,
                          const std::set<std::string>& names) {
    if (!values.has(rule, which)) return;
    const auto pattern = values.text(rule, which);
    if (!pattern) return chosen.assign(chosen.size(), 0);
    const auto holds = applies(*pattern);
    bool any = false;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const bool fits = holds(scene.instances[i]);
      any = any || fits;
      chosen[i] = static_cast<char>(chosen[i] && fits);
    }
    if (any) return;
    reporter_.report(Code("W1501"), values.value_place(rule, which), work.file.document, rule, [&] {
      return Reporter::Text(
          fmt::format("no {} of the import with a surface fits {}", what, in_quotes(*pattern)),
          near_names(*pattern, names));
    });
  };
  std::set<std::string> node_names, material_names;
  for (std::size_t i = 1; i < scene.nodes.size(); ++i) node_names.insert(scene.nodes[i].name);
  for (const importers::CadMaterial& material : model.imported.materials)
    material_names.insert(material.name);
  for (const std::string& name : model.material_names) material_names.insert(name);
  narrow(
      nodes, "node",
      [&](const std::string& pattern) {
        return [named = matching_nodes(scene, model.top, Pattern(pattern))](
                   const scene::Instance& instance) {
          return named[static_cast<std::size_t>(instance.node)] != 0;
        };
      },
      node_names);
  narrow(
      materials, "material",
      [&](const std::string& pattern) {
        const Pattern wanted(pattern);
        std::vector<char> named;
        for (std::size_t i = 0; i < model.material_names.size(); ++i)
          named.push_back(static_cast<char>(wanted.fits(model.material_names[i]) ||
                                            wanted.fits(model.imported.materials[i].name)));
        return [named = std::move(named)](const scene::Instance& instance) {
          return named[static_cast<std::size_t>(instance.material)] != 0;
        };
      },
      material_names);
  return chosen;
}

void Loader::read_import_rule(Work& work, std::uint32_t rule, PartImport& import) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  const ImportedModel& model = models_[import.model];
  if (document.elements[rule].id == ElementId::remove) {
    const auto chosen =
        chosen_instances(work, rule, attribute::remove_nodes, attribute::remove_materials, model);
    for (std::size_t i = 0; i < chosen.size(); ++i)
      if (chosen[i]) import.removed[i] = 1;
    return;
  }
  if (document.elements[rule].id == ElementId::import_joint)
    return read_import_joint(work, rule, import);
  if (document.elements[rule].id != ElementId::assign) return;
  const auto chosen =
      chosen_instances(work, rule, attribute::assign_nodes, attribute::assign_materials, model);
  if (const std::string foil = values.text_or_default(rule, attribute::assign_foil); !foil.empty())
    for (std::size_t i = 0; i < chosen.size(); ++i)
      if (chosen[i]) import.foils[i] = {foil_named(foil), rule};
  if (!values.has(rule, attribute::assign_material)) return;
  Definition* const material =
      look_up(work.file, rule, attribute::assign_material, work.file.materials, "material");
  const auto index = material == nullptr ? std::nullopt : material_of(*material);
  if (!index) return;
  const bool keep = values.text_or_default(rule, attribute::assign_pictures) == "keep";
  std::size_t unseen = 0, palettes = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i]) continue;
    const scene::Instance& instance = model.imported.scene.instances[i];
    const std::int32_t texture = base_texture(model.imported, instance);
    // a colour of a palette is one already
    const bool alone =
        model.imported.materials[static_cast<std::size_t>(instance.material)].palette >= 0;
    if (texture < 0 || (alone && !keep)) continue;
    ++(keep ? unseen : palettes);
    const scene::Texture& image =
        scene_
            .textures[static_cast<std::size_t>(model.textures[static_cast<std::size_t>(texture)])];
    if (!keep && std::uint64_t{image.width} * image.height > kPaletteTexels) --palettes;
  }
  if (has_diffuse(materials_[*index].fields)) unseen = 0;
  if (unseen + palettes > 0)
    reporter_.report(
        Code("W6008"), values.value_place(rule, attribute::assign_material), document, rule, [&] {
          if (unseen > 0)
            return Reporter::Text(fmt::format("the textures of {} have no effect: they multiply "
                                              "the diffuse colour, and {} has none",
                                              counted(unseen, "part"), in_quotes(material->name)),
                                  "assign a material with a diffuse colour");
          return Reporter::Text(
              fmt::format("{} {} colour from an image of at most {} texels, as from a palette, "
                          "which {} replaces by one colour",
                          counted(palettes, "part"), palettes == 1 ? "has its" : "have their",
                          kPaletteTexels, in_quotes(material->name)),
              "pictures=\"keep\" lets it multiply the diffuse colour");
        });
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i]) continue;
    import.materials[i] = static_cast<std::int32_t>(*index);
    import.keeps_texture[i] = static_cast<char>(keep);
  }
}

}  // namespace panwright::pxn
