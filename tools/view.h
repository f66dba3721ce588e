// From camera and Sun options, as typed, to a view.
#pragma once

#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"
#include "pan/model.h"
#include "preview/view.h"
#include "tools/options.h"

namespace panwright::tools {

// The sphere about the centre of a model's bounds that holds the model, world axes, metres.
struct BoundingSphere {
  Vec3 centre{0};
  double radius = 1;
};
BoundingSphere bounding_sphere(const pan::Model& model);

// Reads numbers separated by blanks or commas; nothing when the text is something else or the
// number of numbers is not `count`.
std::optional<std::vector<double>> parse_numbers(const std::string& text, std::size_t count);

// Reads an angle in radians: a bare number is degrees; deg, rad, mrad, urad, arcmin and arcsec
// may follow it.
std::optional<double> parse_angle(const std::string& text);

// A number of a view: what it means stands in docs/conventions.md 3–7. Options left out: the
// camera stands in front of the model, looks at the origin and sees all of it, and the Sun shines
// over its left shoulder.
//
// Reports: N5004. Fails: E0201, E5005.
Result<preview::View> make_view(const ViewOptions& options, const pan::Model& model,
                                DiagnosticLog& log);

// Reads a --views file. Options that a view leaves out are those of `defaults`.
//
// Fails: E0101…E0104, E0203.
Result<std::vector<ViewOptions>> read_views(const std::string& path, const ViewOptions& defaults,
                                            DiagnosticLog& log);

}  // namespace panwright::tools
