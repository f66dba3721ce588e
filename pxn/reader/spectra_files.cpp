// Tables of optical constants that materials name.
#include <fmt/core.h>

#include "base/file.h"
#include "base/text.h"
#include "materials/spectra_file.h"
#include "pxn/reader/loader.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using schemas::ElementId;

std::optional<materials::Conductor> Loader::spectrum(Work& work, std::uint32_t element,
                                                     std::size_t attribute) {
  const auto file = work.file.values->text(element, attribute);
  if (!file) return std::nullopt;
  const auto found = find(work, element, attribute, *file);
  if (!found) return std::nullopt;
  const auto known = known_spectra_.find(found->key);
  if (known != known_spectra_.end()) return known->second;
  auto& spectrum = known_spectra_[found->key];
  const SourceSpan where = work.file.values->value_place(element, attribute);
  const auto bytes = files_.load(*found, where, reporter_.log());
  if (!bytes) return std::nullopt;
  add_input(*found, as_bytes(**bytes));
  materials::TableProblem problem;
  spectrum = materials::read_optical_table(**bytes, problem);
  if (!spectrum)
    reporter_.report(Code("E1409"), where, work.file.document, element, [&] {
      const std::string line = problem.line > 0 ? fmt::format(", line {}", problem.line) : "";
      return Reporter::Text(
          fmt::format("optical constants {}{}: {}", in_quotes(*file), line, problem.message));
    });
  return spectrum;
}

void Loader::read_spectra(Work& work, std::uint32_t element, materials::Fields& fields) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  const std::uint32_t conductor = child_of(document, element, ElementId::conductor);
  if (conductor != 0 && values.has(conductor, attribute::conductor_file)) {
    if (const auto body = spectrum(work, conductor, attribute::conductor_file)) {
      fields.refract = body->n;
      fields.extinction = body->k;
    }
  }
  const std::uint32_t coat = child_of(document, element, ElementId::coat);
  if (coat == 0 || !fields.coat || !values.has(coat, attribute::coat_file)) return;
  const auto film = spectrum(work, coat, attribute::coat_file);
  if (!film) return;
  const SourceSpan where = values.value_place(coat, attribute::coat_file);
  if (!(film->n.y >= 1 && film->n.y <= 4)) {
    reporter_.report(Code("E1409"), where, document, coat, [&] {
      return Reporter::Text(fmt::format("a coat has an index of 1 to 4, and this one {} at 550 nm",
                                        format_double(film->n.y)));
    });
    return;
  }
  const double thickness = values.real(coat, attribute::coat_thickness).value_or(0);
  const materials::Coat of_film = materials::coat_of_film(*film, thickness);
  fields.coat->index = of_film.index;
  fields.coat->depth = of_film.depth;
}

}  // namespace panwright::pxn
