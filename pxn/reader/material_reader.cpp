#include "pxn/reader/material_reader.h"

#include <fmt/core.h>

#include <span>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "base/text.h"
#include "materials/spectra.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using materials::Compensation;
using materials::DiffuseModel;
using schemas::ElementId;

namespace {

// sums of rounded decimals, as 0.7 0.2 0.1, may come out this much above 1
constexpr double kSumTolerance = 1e-9;

class Reader {
 public:
  Reader(const xml::Document& document, std::uint32_t element, Values& values, Reporter& reporter)
      : document_(document), values_(values), reporter_(reporter) {
    named_ = document.elements[element].id == ElementId::named_material;
  }

  void child(std::uint32_t c) {
    if (document_.elements[c].id == schemas::kNoElement) return;  // reported by the grammar check
    switch (document_.elements[c].id) {
      case ElementId::diffuse:
        return vector(c, fields.diffuse);
      case ElementId::specular:
        vector(c, fields.specular);
        if (const auto shine = values_.real(c, attribute::specular_shine))
          fields.blinn_phong = materials::BlinnPhong{*shine};
        return;
      case ElementId::emissive:
        return vector(c, fields.emissive);
      case ElementId::reflect:
        return weights(c);
      case ElementId::refract:
        return vector(c, fields.refract);
      case ElementId::conductor:
        return conductor(c);
      case ElementId::coat:
        return coat(c);
      case ElementId::cells:
        return cells(c);
      default:
        return brdf(c);
    }
  }

  materials::Fields fields;

 private:
  void vector(std::uint32_t c, std::optional<Vec3>& field) {
    Vec3 v(0);
    if (values_.numbers(c, std::span(&v.x, 3))) field = v;
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
    reporter_.report(Code("E1406"), document_.tag_span(c), document_, c, [&] {
      return Reporter::Text(fmt::format(
          "the weights {} {} {} of reflect add up to {:.6g}, expected at most 1 to conserve energy",
          format_double(w.x), format_double(w.y), format_double(w.z), w.x + w.y + w.z));
    });
    fields.reflect = w / (w.x + w.y + w.z);
  }

  // The element of a BRDF, if it is one; schemas/material.toml says where its parameters stand.
  void brdf(std::uint32_t c) {
    const std::string_view tag = schema(c).name;
    if (const auto model = materials::diffuse_model_of_tag(tag)) {
      auto brdf = materials::default_brdf(*model);
      if (!parameters(c, brdf)) return;
      set_brdf(fields, brdf);
      return settle_diffuse(c, *model);
    }
    const auto model = materials::specular_model_of_tag(tag);
    if (!model) return;
    auto brdf = materials::default_brdf(*model);
    const bool whole = parameters(c, brdf);
    if (whole) set_brdf(fields, brdf);
    // by level 0 the numbers choose
    if (schema(c).level > 0) fields.specular_model = *model;
    energy(c);
  }

  // Fills in what is given; false where the numbers between the tags cannot be read.
  template <class Brdf>
  bool parameters(std::uint32_t c, Brdf& brdf) {
    std::vector<double> numbers(schema(c).text.count);
    if (!numbers.empty() && !values_.numbers(c, numbers)) return false;
    std::size_t next = 0;
    edit_parameters(brdf, [&](const materials::Parameter& parameter, std::span<double> out) {
      if (parameter.attribute.empty()) {
        for (double& value : out) value = numbers[next++] * parameter.pxn_unit;
      } else if (const auto which = attribute_of(c, parameter.attribute)) {
        std::vector<double> given(out.size());
        if (!values_.numbers(c, *which, given)) return;
        for (std::size_t k = 0; k < out.size(); ++k) out[k] = given[k] * parameter.pxn_unit;
      }
    });
    return true;
  }

  // Models of level 1 are named; of level 0, and hapke and oren at any level, the numbers choose.
  void settle_diffuse(std::uint32_t c, DiffuseModel model) {
    if (schema(c).level > 0) fields.diffuse_model = model;
    if (model == DiffuseModel::hapke) fields.hapke_named = named_;
    if (model != DiffuseModel::oren_nayar) return;
    if (values_.text(c, attribute::oren_energy) != "preserving") return;
    fields.eon = materials::Eon{materials::eon_roughness(fields.oren_nayar->sigma)};
    fields.oren_nayar.reset();
    fields.diffuse_model = DiffuseModel::eon;
  }

  // Whether multiple scattering is added, where the element says so.
  void energy(std::uint32_t c) {
    const auto which = attribute_of(c, "energy");
    if (!which) return;
    if (const auto word = values_.text(c, *which))
      fields.compensation = *word == "full"     ? Compensation::on
                            : *word == "single" ? Compensation::off
                                                : Compensation::automatic;
  }

  const schemas::Element& schema(std::uint32_t c) const {
    return schemas::kPxn.elements[static_cast<std::size_t>(document_.elements[c].id)];
  }
  // The index of an attribute in the tables; none where the element has no such attribute.
  std::optional<std::size_t> attribute_of(std::uint32_t c, std::string_view name) const {
    const auto attributes = schema(c).attributes;
    for (std::size_t i = 0; i < attributes.size(); ++i)
      if (attributes[i].name == name) return i;
    return std::nullopt;
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
      if (const auto film = materials::coat_of_film(*name, thickness)) {
        coat.index = film->index;
        coat.depth = film->depth;
      } else {
        unknown(c, attribute::coat_film, *name, materials::film_names(), "give n and absorption");
      }
    }
    fields.coat = coat;
  }

  void cells(std::uint32_t c) {
    materials::Cells cells;
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
        Code("E1407"), values_.value_place(c, which), document_, c, [&]() -> Reporter::Text {
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
