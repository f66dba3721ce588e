#include "pxn/internal/material_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>

#include "base/math.h"
#include "base/text.h"
#include "materials/spectra.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using materials::Compensation;
using materials::DiffuseLaw;
using materials::SpecularLaw;
using schemas::ElementId;

namespace {

// sums of rounded decimals, as 0.7 0.2 0.1, may come out this much above 1
constexpr double kSumTolerance = 1e-9;

constexpr double kBands_um[] = {0.65, 0.55, 0.45};  // of the channels
constexpr std::string_view kFilms[] = {"Kapton", "MgF2", "SiO2"};

// n and k of a film for the channels.
std::optional<materials::Conductor> film_of(std::string_view name) {
  if (std::find(std::begin(kFilms), std::end(kFilms), name) == std::end(kFilms))
    return std::nullopt;
  const auto constants = materials::optical_constants(name);
  if (!constants) return std::nullopt;
  const auto grid = materials::wavelengths_um();
  materials::Conductor out;
  for (int channel = 0; channel < 3; ++channel) {
    const auto above = std::upper_bound(grid.begin(), grid.end(), kBands_um[channel]);
    const auto i = static_cast<std::size_t>(above - grid.begin()) - 1;
    const double t = (kBands_um[channel] - grid[i]) / (grid[i + 1] - grid[i]);
    out.n[channel] = constants->n[i] + t * (constants->n[i + 1] - constants->n[i]);
    out.k[channel] = constants->k[i] + t * (constants->k[i + 1] - constants->k[i]);
  }
  return out;
}

class Reader {
 public:
  Reader(const xml::Document& document, std::uint32_t element, Values& values, Reporter& reporter)
      : document_(document), values_(values), reporter_(reporter) {
    named_ = document.elements[element].id == ElementId::named_material;
  }

  void child(std::uint32_t c) {
    switch (document_.elements[c].id) {
      case ElementId::diffuse:
        return vector(c, fields.diffuse);
      case ElementId::specular:
        vector(c, fields.specular);
        fields.shine = values_.real(c, attribute::specular_shine);
        return;
      case ElementId::emissive:
        return vector(c, fields.emissive);
      case ElementId::reflect:
        return weights(c);
      case ElementId::refract:
        return vector(c, fields.refract);
      case ElementId::cook:
        return numbers(c, fields.cook);
      case ElementId::oren:
        return oren(c);
      case ElementId::hapke:
        return hapke(c);
      case ElementId::lambert:
        fields.diffuse_law = DiffuseLaw::lambert;
        return;
      case ElementId::eon:
        number(c, fields.oren);
        fields.diffuse_law = DiffuseLaw::eon;
        return;
      case ElementId::lommel_seeliger:
        number(c, fields.lommel);
        fields.diffuse_law = DiffuseLaw::lommel_seeliger;
        return;
      case ElementId::beckmann:
        return facets(c, SpecularLaw::beckmann, attribute::beckmann_energy);
      case ElementId::ggx:
        return facets(c, SpecularLaw::ggx, attribute::ggx_energy);
      case ElementId::mirror:
        fields.specular_law = SpecularLaw::mirror;
        return;
      case ElementId::conductor:
        return conductor(c);
      case ElementId::coat:
        return coat(c);
      case ElementId::cells:
        return cells(c);
      default:
        return;
    }
  }

  materials::Fields fields;

 private:
  void vector(std::uint32_t c, std::optional<Vec3>& field) {
    Vec3 v(0);
    if (values_.numbers(c, std::span(&v.x, 3))) field = v;
  }
  void numbers(std::uint32_t c, std::optional<std::array<double, 4>>& field) {
    std::array<double, 4> four{};
    if (values_.numbers(c, four)) field = four;
  }
  void number(std::uint32_t c, std::optional<double>& field) {
    double one = 0;
    if (values_.numbers(c, std::span(&one, 1))) field = one;
  }
  // Attributes that are not there leave their default.
  void give(std::uint32_t c, std::size_t which, double& out) {
    if (const auto value = values_.real(c, which)) out = *value;
  }
  void give(std::uint32_t c, std::size_t which, Vec2& out) {
    Vec2 v(0);
    if (values_.numbers(c, which, std::span(&v.x, 2))) out = v;
  }
  bool give(std::uint32_t c, std::size_t which, Vec3& out) {
    Vec3 v(0);
    const bool given = values_.numbers(c, which, std::span(&v.x, 3));
    if (given) out = v;
    return given;
  }

  void weights(std::uint32_t c) {
    vector(c, fields.reflect);
    if (!named_ || !fields.reflect) return;
    const Vec3& w = *fields.reflect;
    if (w.x + w.y + w.z <= 1 + kSumTolerance) return;
    reporter_.report(Code::E1406, document_.tag_span(c), document_, c, [&] {
      return Reporter::Text(
          fmt::format("the weights {} {} {} of reflect add up to {:.6g}, at most "
                      "1 keeps the balance of energy",
                      format_double(w.x), format_double(w.y), format_double(w.z), w.x + w.y + w.z));
    });
    fields.reflect = w / (w.x + w.y + w.z);
  }

  void oren(std::uint32_t c) {
    number(c, fields.oren);
    if (values_.text(c, attribute::oren_energy) != "preserving" || !fields.oren) return;
    fields.oren = materials::eon_roughness(*fields.oren);
    fields.diffuse_law = DiffuseLaw::eon;
  }

  void hapke(std::uint32_t c) {
    numbers(c, fields.hapke);
    if (!named_) return;
    materials::HapkeGrains grains;
    give(c, attribute::hapke_b, grains.b);
    give(c, attribute::hapke_c, grains.c);
    give(c, attribute::hapke_hc, grains.h_c);
    give(c, attribute::hapke_bc0, grains.b_c0);
    give(c, attribute::hapke_porosity, grains.porosity);
    fields.hapke_grains = grains;
  }

  void facets(std::uint32_t c, SpecularLaw law, std::size_t energy) {
    std::array<double, 2> alpha{};
    if (values_.numbers(c, alpha)) fields.alpha = alpha;
    fields.specular_law = law;
    if (const auto word = values_.text(c, energy))
      fields.compensation = *word == "full"     ? Compensation::on
                            : *word == "single" ? Compensation::off
                                                : Compensation::automatic;
  }

  void conductor(std::uint32_t c) {
    Vec3 n(1), k(0);
    if (give(c, attribute::conductor_n, n)) {
      give(c, attribute::conductor_k, k);
      fields.refract = n;
      fields.extinction = k;
    } else if (const auto name = values_.text(c, attribute::conductor_metal)) {
      if (const auto metal = materials::metal(*name)) {
        fields.refract = metal->n;
        fields.extinction = metal->k;
        return;
      }
      unknown(c, attribute::conductor_metal, *name, materials::metal_names(),
              "give n and k for the bands about 650, 550 and 450 nm");
    }
  }

  void coat(std::uint32_t c) {
    materials::Coat coat;
    give(c, attribute::coat_n, coat.index);
    give(c, attribute::coat_slope, coat.alpha);
    double thickness = 0;
    give(c, attribute::coat_thickness, thickness);
    if (give(c, attribute::coat_absorption, coat.depth)) coat.depth *= thickness;
    if (const auto name = values_.text(c, attribute::coat_film)) {
      if (const auto film = film_of(*name)) {
        coat.index = film->n.y;
        for (int k = 0; k < 3; ++k)
          coat.depth[k] = 4 * kPi * film->k[k] / (kBands_um[k] * 1e-6) * thickness;
      } else {
        unknown(c, attribute::coat_film, *name, kFilms, "give n and absorption");
      }
    }
    fields.coat = coat;
  }

  void cells(std::uint32_t c) {
    materials::Cells cells;
    cells.finger_width = 0.03;
    give(c, attribute::cells_columns, cells.count.x);
    give(c, attribute::cells_rows, cells.count.y);
    give(c, attribute::cells_gap, cells.gap);
    give(c, attribute::cells_gap_color, cells.gap_color);
    give(c, attribute::cells_fingers, cells.fingers);
    give(c, attribute::cells_finger_width, cells.finger_width);
    give(c, attribute::cells_finger_color, cells.finger_color);
    give(c, attribute::cells_tilt, cells.tilt);
    fields.cells = cells;
  }

  void unknown(std::uint32_t c, std::size_t which, const std::string& name,
               std::span<const std::string_view> known, const char* otherwise) {
    reporter_.report(
        Code::E1407, values_.value_place(c, which), document_, c, [&]() -> Reporter::Text {
          const auto near = nearest_name(name, known);
          return {fmt::format("optical constants of {} are not known", in_quotes(name)),
                  near ? fmt::format("did you mean '{}'?", *near) : otherwise};
        });
  }

  const xml::Document& document_;
  Values& values_;
  Reporter& reporter_;
  bool named_ = false;
};

}  // namespace

materials::Fields read_material(const xml::Document& document, std::uint32_t element,
                                Values& values, Reporter& reporter) {
  Reader reader(document, element, values, reporter);
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next) reader.child(c);
  return std::move(reader.fields);
}

void read_provenance(const xml::Document& document, std::uint32_t element, Values& values,
                     Provenance& out) {
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next) {
    const auto text = [&](std::size_t which) { return values.text(c, which).value_or(""); };
    switch (document.elements[c].id) {
      case ElementId::provenance:
        out.source = text(attribute::provenance_source);
        out.published = text(attribute::provenance_published);
        out.fitted = text(attribute::provenance_fitted);
        out.indicative = text(attribute::provenance_indicative);
        out.absorptance = values.real(c, attribute::provenance_absorptance);
        break;
      case ElementId::conductor:
        out.metal = text(attribute::conductor_metal);
        break;
      case ElementId::refract:
        out.metal.clear();
        break;
      case ElementId::coat:
        out.film = text(attribute::coat_film);
        out.film_thickness = values.real(c, attribute::coat_thickness).value_or(0);
        break;
      default:
        break;
    }
  }
}

}  // namespace panwright::pxn
