// <mli>: a recipe and its form, and the mesh that they make.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/mesh/strip.h"
#include "mli/levels.h"
#include "mli/preset.h"
#include "mli/sheet.h"
#include "pxn/reader/kept_foil.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/shapes.h"

namespace panwright::pxn {

using schemas::ElementId;
namespace attribute = schemas::attribute;

namespace {

// metres, where none is given
constexpr double kTapeWidth = 0.025, kThickness = 0.005;

class SheetReader {
 public:
  SheetReader(const xml::Document& document, std::uint32_t element, Values& values,
              Reporter& reporter)
      : doc_(document), element_(element), values_(values), reporter_(reporter) {}

  std::optional<FoilSheet> run() {
    FoilSheet sheet;
    read_recipe(sheet);
    read_form(sheet);
    sheet.trim.tape = tape_width();
    sheet.trim.thickness = thickness(std::holds_alternative<mli::Box>(sheet.form));
    if (!ok_) return std::nullopt;
    return sheet;
  }

  std::optional<PartWrap> run_wrap() {
    wrap_ = true;
    FoilSheet sheet;
    PartWrap wrap;
    read_recipe(sheet);
    read_choice(wrap);
    if (!ok_) return std::nullopt;
    const bool sized = sheet.recipe.xgrid > 0;
    wrap.blanket.preset = preset_;
    wrap.blanket.operations = std::move(sheet.recipe.operations);
    wrap.blanket.seed = sheet.recipe.seed;
    wrap.blanket.cell = sized ? sheet.recipe.cell() : 0;
    return wrap;
  }

 private:
  void read_recipe(FoilSheet& sheet) {
    const std::uint32_t settings = child_of(doc_, element_, ElementId::mli_settings);
    const std::uint32_t operations = child_of(doc_, element_, ElementId::mli_operations);
    // other children that are not there have been reported
    if (settings == 0 && !wrap_)
      reporter_.report(Code("E1103"), doc_.name_span(element_), doc_, element_,
                       [] { return Reporter::Text("<mli> needs <mli_settings>"); });
    if ((settings == 0 && !wrap_) || operations == 0) {
      ok_ = false;
      return;
    }
    sheet.places.recipe = doc_.name_span(element_);
    if (settings != 0) read_settings(sheet, settings);
    mli::Recipe& recipe = sheet.recipe;
    if (values_.has(element_, attribute::mli_seed)) {
      const auto seed = values_.integer(element_, attribute::mli_seed);
      ok_ = ok_ && seed.has_value();
      recipe.seed = static_cast<std::uint32_t>(seed.value_or(0));
    }
    read_preset(sheet, operations);
    const std::uint32_t end = doc_.elements[operations].next;
    for (std::uint32_t c = operations + 1; c < end; c = doc_.elements[c].next) {
      if (doc_.elements[c].id == schemas::kNoElement) continue;
      if (auto operation = read_operation(c)) {
        recipe.operations.push_back(*std::move(operation));
        sheet.places.operations.push_back(doc_.name_span(c));
      } else {
        ok_ = false;
      }
    }
  }

  void read_settings(FoilSheet& sheet, std::uint32_t settings) {
    mli::Recipe& recipe = sheet.recipe;
    const auto setting = [&](ElementId id, double& value, SourceSpan& place) {
      const std::uint32_t child = child_of(doc_, settings, id);
      ok_ = child != 0 && values_.numbers(child, std::span(&value, 1)) && ok_;
      if (child != 0) place = doc_.name_span(child);
    };
    setting(ElementId::width, recipe.width, sheet.places.width);
    setting(ElementId::height, recipe.height, sheet.places.height);
    if (const std::uint32_t cells = child_of(doc_, settings, ElementId::xgrid); cells != 0) {
      const auto count = values_.integer(cells);
      ok_ = ok_ && count.has_value();
      recipe.xgrid = static_cast<std::uint32_t>(count.value_or(1));
      sheet.places.xgrid = doc_.name_span(cells);
    } else {
      ok_ = false;
    }
  }

  void read_preset(FoilSheet& sheet, std::uint32_t operations) {
    if (!values_.has(operations, attribute::mli_operations_preset)) return;
    const auto name = values_.text(operations, attribute::mli_operations_preset);
    if (wrap_) {
      // its operations depend on the size of each sheet
      preset_ = foil_named(name.value_or(""));
      ok_ = ok_ && !preset_.empty();
      return;
    }
    auto preset = mli::preset_operations(name.value_or(""), sheet.recipe.height);
    if (!preset) {
      ok_ = false;  // no word of the tables: reported
      return;
    }
    sheet.recipe.operations = *std::move(preset);
    sheet.places.operations.assign(
        sheet.recipe.operations.size(),
        values_.value_place(operations, attribute::mli_operations_preset));
  }

  std::optional<mli::Operation> read_operation(std::uint32_t child) {
    at_ = child;
    read_ok_ = true;
    mli::Operation operation = operation_at(doc_.elements[child].id);
    if (!read_ok_) return std::nullopt;
    return operation;
  }

  mli::Operation operation_at(ElementId id) {
    switch (id) {
      case ElementId::random:
        return mli::Random{text()};
      case ElementId::smooth:
        return mli::Smooth{count()};
      case ElementId::constant:
        return mli::Constant{text()};
      case ElementId::taper: {
        double n[4] = {};
        read_ok_ = values_.numbers(at_, n);
        return mli::Taper{n[0], n[1], n[2], n[3]};
      }
      case ElementId::wrinkle:
        return mli::Wrinkle{real(attribute::wrinkle_wavelength), real(attribute::wrinkle_amplitude),
                            real(attribute::wrinkle_direction),
                            real(attribute::wrinkle_anisotropy)};
      case ElementId::crease:
        return mli::Crease{real(attribute::crease_density), real(attribute::crease_depth),
                           real(attribute::crease_length),  real(attribute::crease_spread),
                           real(attribute::crease_tail),    real(attribute::crease_tail_share)};
      case ElementId::fractal:
        return mli::Fractal{real(attribute::fractal_hurst), real(attribute::fractal_rms),
                            real(attribute::fractal_longest)};
      case ElementId::emboss:
        return mli::Emboss{word(attribute::emboss_pattern) == "diamond" ? mli::Pattern::diamond
                                                                        : mli::Pattern::quilt,
                           real(attribute::emboss_pitch), real(attribute::emboss_depth)};
      case ElementId::seam:
        return mli::Seam{word(attribute::seam_along) == "x", real(attribute::seam_position),
                         real(attribute::seam_width),        real(attribute::seam_height),
                         real(attribute::seam_stitch),       real(attribute::seam_pucker)};
      case ElementId::button:
        return mli::Button{real(attribute::button_pitch), real(attribute::button_radius),
                           real(attribute::button_reach), real(attribute::button_pucker)};
      case ElementId::crush:
        return mli::Crush{real(attribute::crush_size), real(attribute::crush_depth)};
      default:
        return mli::SlopeRms{text()};
    }
  }

  // ---- of the operation at_

  double text() {
    double value = 0;
    read_ok_ = values_.numbers(at_, std::span(&value, 1)) && read_ok_;
    return value;
  }

  std::uint32_t count() {
    const auto value = values_.integer(at_);
    read_ok_ = read_ok_ && value.has_value();
    return static_cast<std::uint32_t>(value.value_or(0));
  }

  // The default of the tables, or 0, where it is absent.
  double real(std::size_t which) {
    const auto& entry =
        schemas::kPxn.elements[static_cast<std::size_t>(doc_.elements[at_].id)].attributes[which];
    if (!values_.has(at_, which)) {
      // one that must be there has been reported
      if (entry.required) read_ok_ = false;
      return entry.initial.empty() ? 0 : entry.initial[0];
    }
    const auto value = values_.real(at_, which);
    read_ok_ = read_ok_ && value.has_value();
    return value.value_or(0);
  }

  std::string word(std::size_t which) {
    if (!values_.has(at_, which)) {
      const std::string_view initial = values_.default_text(at_, which);
      if (initial.empty()) read_ok_ = false;
      return std::string(initial);
    }
    auto value = values_.text(at_, which);
    read_ok_ = read_ok_ && value.has_value();
    return value.value_or("");
  }

  // ---- the form

  void read_form(FoilSheet& sheet) {
    at_ = element_;
    read_ok_ = true;
    const std::string type = word(attribute::mli_type);
    const double radius = real(attribute::mli_radius), length = real(attribute::mli_length);
    const double top = real(attribute::mli_top_radius), flange = real(attribute::mli_flange);
    Vec3 size(0);
    if (values_.has(element_, attribute::mli_size))
      read_ok_ = values_.numbers(element_, attribute::mli_size, std::span(&size.x, 3)) && read_ok_;
    ok_ = ok_ && read_ok_;
    if (!ok_) return;
    const double width = sheet.recipe.width;
    const double height = sheet.recipe.cell() * sheet.recipe.ygrid();
    if (type == "flat") {
      sheet.form = mli::Flat{};
      refuse_others(type, {});
    } else if (type == "tube" || type == "tubular") {
      sheet.form = mli::Tube{radius, length, flange};
      refuse_others("tube", {attribute::mli_radius, attribute::mli_length, attribute::mli_flange});
    } else if (type == "disc") {
      sheet.form = mli::Disc{radius > 0 ? radius : std::min(width, height) / 2 - flange, flange};
      refuse_others(type, {attribute::mli_radius, attribute::mli_flange});
    } else if (type == "box") {
      sheet.form = mli::Box{size, flange};
      refuse_others(type, {attribute::mli_size, attribute::mli_flange});
    } else {
      sheet.form = cone(width, height, radius, top, length, flange);
      refuse_others("cone", {attribute::mli_radius, attribute::mli_top_radius,
                             attribute::mli_length, attribute::mli_flange});
    }
  }

  // Without sizes: the half disc over the sheet's lower edge, rolled up; as wide as it is long
  // along its side.
  mli::Cone cone(double width, double height, double radius, double top, double length,
                 double flange) {
    const double slant = std::min(width / 2, height);
    if (radius == 0 && length == 0)
      return {(slant - flange) / 2, top, (slant - flange) * (std::sqrt(3.0) / 2), flange};
    const auto missing = radius == 0 ? "radius" : length == 0 ? "length" : nullptr;
    if (missing != nullptr)
      wrong(doc_.name_span(element_),
            fmt::format("the cone has no {}; a radius and a length are given together, or neither",
                        missing));
    return {radius, top, length, flange};
  }

  // What a form has no use for is no part of it.
  void refuse_others(std::string_view type, std::initializer_list<std::size_t> used) {
    for (const std::size_t which :
         {attribute::mli_radius, attribute::mli_top_radius, attribute::mli_length,
          attribute::mli_flange, attribute::mli_size, attribute::mli_on, attribute::mli_materials,
          attribute::mli_faces, attribute::mli_standoff}) {
      if (!values_.has(element_, which) || std::ranges::find(used, which) != used.end()) continue;
      const auto name =
          schemas::kPxn.elements[static_cast<std::size_t>(ElementId::mli)].attributes[which].name;
      wrong(values_.value_place(element_, which),
            fmt::format("a sheet of type '{}' has no {}", type, name));
    }
  }

  // ---- what closes it

  // Metres; 0: no tape.
  double tape_width() {
    return beside(attribute::mli_tape, attribute::mli_tape_width, kTapeWidth,
                  "tape_width without tape: 'tape' names the tape's material");
  }

  // Metres; 0: no edge.
  double thickness(bool closed) {
    if (closed && values_.has(element_, attribute::mli_edge))
      wrong(values_.value_place(element_, attribute::mli_edge),
            "a box has no cut edge: it is closed");
    return beside(attribute::mli_edge, attribute::mli_thickness, kThickness,
                  "thickness without edge: 'edge' names the material of cut edges");
  }

  // A length that goes with a material.
  double beside(std::size_t material, std::size_t length, double usual, const char* missing) {
    if (!values_.has(element_, length)) return values_.has(element_, material) ? usual : 0;
    if (!values_.has(element_, material)) wrong(values_.value_place(element_, length), missing);
    const auto value = values_.real(element_, length);
    ok_ = ok_ && value.has_value();
    return value.value_or(0);
  }

  // ---- what a wrap covers

  void read_choice(PartWrap& wrap) {
    refuse_others("wrap", {attribute::mli_on, attribute::mli_materials, attribute::mli_faces,
                           attribute::mli_standoff});
    if (values_.has(element_, attribute::mli_thickness))
      wrong(values_.value_place(element_, attribute::mli_thickness),
            "a wrap has no thickness: its cut edge has the height of the stand-off");
    for (const std::size_t which :
         {attribute::mli_translate, attribute::mli_rotate, attribute::mli_quat,
          attribute::mli_scale, attribute::mli_tolerance})
      if (values_.has(element_, which))
        wrong(values_.value_place(element_, which),
              "a wrap has no placement and no tolerance: it lies on the shapes that it covers");
    const auto pattern = [&](std::size_t which, std::optional<std::string>& out) {
      if (!values_.has(element_, which)) return;
      out = values_.text(element_, which);
      ok_ = ok_ && out.has_value();
    };
    pattern(attribute::mli_on, wrap.on);
    pattern(attribute::mli_materials, wrap.materials);
    if (!wrap.on && !wrap.materials && ok_)
      reporter_.report(Code("E1103"), doc_.name_span(element_), doc_, element_, [&] {
        ok_ = false;
        return Reporter::Text(
            "a wrap covers nothing: 'on' names nodes or shapes, 'materials' materials");
      });
    ok_ = ok_ && (wrap.on || wrap.materials);
    if (values_.has(element_, attribute::mli_standoff)) {
      const auto stand_off = values_.real(element_, attribute::mli_standoff);
      ok_ = ok_ && stand_off.has_value();
      wrap.blanket.stand_off = stand_off.value_or(0);
    }
    wrap.blanket.tape = tape_width();
    if (!values_.has(element_, attribute::mli_faces)) return;
    const auto faces = values_.text(element_, attribute::mli_faces);
    ok_ = ok_ && faces.has_value();
    wrap.faces = faces.value_or("");
    for (std::size_t begin = 0; begin < wrap.faces.size();) {
      const std::size_t end = std::min(wrap.faces.find(' ', begin), wrap.faces.size());
      const std::string word = wrap.faces.substr(begin, end - begin);
      begin = end + 1;
      const auto known = std::ranges::find(kFaceWords, word);
      if (known != std::end(kFaceWords))
        wrap.blanket.faces |= 1u << (known - std::begin(kFaceWords));
      else if (!word.empty() && wrap.faces != "all")
        wrong(values_.value_place(element_, attribute::mli_faces),
              fmt::format("faces is '{}'; it is all, or some of +x -x +y -y +z -z", wrap.faces));
    }
  }

  void wrong(SourceSpan where, const std::string& message) {
    ok_ = false;
    reporter_.report(Code("E7001"), where, doc_, element_, [&] { return Reporter::Text(message); });
  }

  const xml::Document& doc_;
  std::uint32_t element_;
  std::uint32_t at_ = 0;  // of what is being read
  Values& values_;
  Reporter& reporter_;
  bool read_ok_ = true;  // of what is being read
  bool ok_ = true;
  bool wrap_ = false;
  std::string_view preset_;  // of a wrap
};

// Numbers of operations and forms, one after another.
struct KeyWriter {
  std::vector<double>& key;
  template <class... N>
  void all(N... numbers) {
    (key.push_back(static_cast<double>(numbers)), ...);
  }
  void operator()(const mli::Random& o) { all(o.amplitude); }
  void operator()(const mli::Smooth& o) { all(o.passes); }
  void operator()(const mli::Constant& o) { all(o.height); }
  void operator()(const mli::Taper& o) { all(o.x0, o.x1, o.y0, o.y1); }
  void operator()(const mli::Wrinkle& o) {
    all(o.wavelength, o.amplitude, o.direction, o.anisotropy);
  }
  void operator()(const mli::Crease& o) {
    all(o.density, o.depth, o.length, o.spread, o.tail, o.tail_share);
  }
  void operator()(const mli::Fractal& o) { all(o.hurst, o.rms, o.longest); }
  void operator()(const mli::Emboss& o) { all(static_cast<int>(o.pattern), o.pitch, o.depth); }
  void operator()(const mli::Seam& o) {
    all(o.along_x, o.position, o.width, o.height, o.stitch, o.pucker);
  }
  void operator()(const mli::Button& o) { all(o.pitch, o.radius, o.reach, o.pucker); }
  void operator()(const mli::Crush& o) { all(o.size, o.depth); }
  void operator()(const mli::SlopeRms& o) { all(o.slope); }
  void operator()(const mli::Flat&) {}
  void operator()(const mli::Tube& f) { all(f.radius, f.length, f.flange); }
  void operator()(const mli::Cone& f) { all(f.radius, f.top_radius, f.length, f.flange); }
  void operator()(const mli::Disc& f) { all(f.radius, f.flange); }
  void operator()(const mli::Box& f) { all(f.size.x, f.size.y, f.size.z, f.flange); }
};

}  // namespace

std::vector<double> FoilSheet::key() const {
  std::vector<double> key{recipe.width, recipe.height, static_cast<double>(recipe.xgrid),
                          static_cast<double>(recipe.seed)};
  KeyWriter writer{key};
  for (const mli::Operation& operation : recipe.operations) {
    key.push_back(static_cast<double>(operation.index()));
    std::visit(writer, operation);
  }
  key.push_back(-1 - static_cast<double>(form.index()));
  std::visit(writer, form);
  writer.all(trim.tape, trim.thickness);
  return key;
}

std::optional<FoilSheet> read_foil(const xml::Document& document, std::uint32_t element,
                                   Values& values, Reporter& reporter) {
  return SheetReader(document, element, values, reporter).run();
}

std::optional<PartWrap> read_wrap(const xml::Document& document, std::uint32_t element,
                                  Values& values, Reporter& reporter) {
  return SheetReader(document, element, values, reporter).run_wrap();
}

std::vector<double> key_of(const Blanket& blanket) {
  double preset = -1;
  for (const mli::Preset& known : mli::presets())
    if (known.name == blanket.preset) preset = static_cast<double>(&known - mli::presets().data());
  std::vector<double> key{preset,
                          static_cast<double>(blanket.seed),
                          blanket.cell,
                          blanket.stand_off,
                          static_cast<double>(blanket.faces),
                          blanket.tape,
                          blanket.edge ? 1.0 : 0.0};
  KeyWriter writer{key};
  for (const mli::Operation& operation : blanket.operations) {
    key.push_back(static_cast<double>(operation.index()));
    std::visit(writer, operation);
  }
  return key;
}

std::string_view foil_named(std::string_view name) {
  for (const mli::Preset& preset : mli::presets())
    if (preset.name == name) return preset.name;
  return {};
}

namespace {

// What is tape and edge, cut into the mesh of a sheet.
std::vector<mli::Cover> trimmed(geometry::Mesh& mesh, mli::Sheet sheet, const FoilSheet& foil,
                                double crease_angle) {
  if (foil.trim.tape > 0 || foil.trim.thickness > 0) {
    DiagnosticLog ignored;  // the sheet itself has been formed
    std::ranges::fill(sheet.heights, 0.0);
    if (auto surface = mli::formed(sheet, foil.form, ignored)) {
      geometry::compute_normals(*surface, crease_angle);
      return mli::trimmed(mesh, *surface, foil.trim);
    }
  }
  return std::vector<mli::Cover>(mesh.triangles.size(), mli::Cover::foil);
}

// Null where there is none of it. A mesh that is all of one cover goes on whole.
std::shared_ptr<const geometry::Mesh> part_of(geometry::Mesh& mesh,
                                              const std::vector<mli::Cover>& covers,
                                              mli::Cover cover) {
  const auto count = std::ranges::count(covers, cover);
  if (count == 0 || mesh.triangles.empty()) return nullptr;
  if (static_cast<std::size_t>(count) == covers.size())
    return std::make_shared<const geometry::Mesh>(std::exchange(mesh, {}));
  return std::make_shared<const geometry::Mesh>(mli::part_of(mesh, covers, cover));
}

// Without a finest mesh: it failed.
FoilMeshes meshes_of(const FoilSheet& foil, double crease_angle, double room, DiagnosticLog& log,
                     const Job& job) {
  FoilMeshes out;
  const auto sheet = mli::made(foil.recipe, {}, log, foil.places, job);
  if (!sheet) return out;
  out.statistics = sheet->statistics;
  auto mesh = mli::formed(*sheet, foil.form, log, foil.places.recipe);
  if (!mesh) return out;
  geometry::compute_normals(*mesh, crease_angle);
  const std::vector<mli::Cover> covers = trimmed(*mesh, *sheet, foil, crease_angle);
  out.vertices = static_cast<double>(mesh->positions.size());
  std::vector<mli::Level> levels;
  if (foil.levels)
    levels = mli::levels_of(*sheet, foil.form, crease_angle, room - out.vertices, foil.trim, job);
  for (const mli::Level& level : levels)
    out.vertices += static_cast<double>(level.mesh.positions.size());
  for (std::size_t k = 0; k < mli::kCovers; ++k) {
    const auto cover = static_cast<mli::Cover>(k);
    out.parts[k].finest = part_of(*mesh, covers, cover);
    for (mli::Level& level : levels)
      if (auto part = part_of(level.mesh, level.covers, cover))
        out.parts[k].levels.push_back({std::move(part), level.detail, level.error});
  }
  return out;
}

}  // namespace

std::optional<FoilMeshes> make_foil(const xml::Document& document, std::uint32_t element,
                                    const FoilSheet& foil, double crease_angle, double room,
                                    const WorkCache* cache, Reporter& reporter, const Job& job) {
  // note: a log of its own, so that problems in a repeat are reported once
  DiagnosticLog log;
  const auto pass_on = [&](const std::vector<Diagnostic>& entries) {
    for (const Diagnostic& entry : entries)
      reporter.report(entry.code, entry.where, document, element,
                      [&] { return Reporter::Text(entry.message, entry.hint); });
  };
  if (!mli::check(foil.recipe, log, foil.places)) {
    pass_on(log.entries());
    return std::nullopt;
  }
  const double vertices = (foil.recipe.xgrid + 1.0) * (foil.recipe.ygrid() + 1);
  if (vertices > room) {
    reporter.report(Code("E7001"), foil.places.xgrid, document, element, [&] {
      return Reporter::Text(
          fmt::format("the sheet has {:.0f} vertices; all sheets of a model may have {:.0f}, and "
                      "{:.0f} are left; a smaller xgrid has fewer",
                      vertices, kMaxFoilVertices, room));
    });
    return std::nullopt;
  }
  auto made = kept_or_made(
      foil.levels ? cache : nullptr, foil, crease_angle, room, [&]() -> std::optional<MadeFoil> {
        MadeFoil fresh{meshes_of(foil, crease_angle, room, log, job), log.entries()};
        if (std::ranges::none_of(fresh.meshes.parts,
                                 [](const auto& part) { return part.finest != nullptr; }))
          return std::nullopt;
        return fresh;
      });
  pass_on(made ? made->said : log.entries());
  if (!made) return std::nullopt;
  return std::move(made->meshes);
}

}  // namespace panwright::pxn
