#include "geometry/internal/tessellators.h"

namespace panwright::geometry::internal {

Problem problem(const Box&) { return std::nullopt; }
Result<Mesh> make(const Box&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Box&, const TessellationOptions&) { return 0; }
Problem problem(const Plane&) { return std::nullopt; }
Result<Mesh> make(const Plane&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Plane&, const TessellationOptions&) { return 0; }
Problem problem(const Tube&) { return std::nullopt; }
Result<Mesh> make(const Tube&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Tube&, const TessellationOptions&) { return 0; }
std::vector<Rim> rims(const Tube&) { return {}; }
std::uint32_t segments(const Tube&, const TessellationOptions&) { return 0; }
Problem problem(const Extrude&) { return std::nullopt; }
Result<Mesh> make(const Extrude&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Extrude&, const TessellationOptions&) { return 0; }
Problem problem(const Polygons&) { return std::nullopt; }
Result<Mesh> make(const Polygons&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Polygons&, const TessellationOptions&) { return 0; }

}  // namespace panwright::geometry::internal
