#include "geometry/internal/tessellators.h"

namespace panwright::geometry::internal {

Problem problem(const Ellipsoid&) { return std::nullopt; }
Result<Mesh> make(const Ellipsoid&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Ellipsoid&, const TessellationOptions&) { return 0; }
Problem problem(const Cylinder&) { return std::nullopt; }
Result<Mesh> make(const Cylinder&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Cylinder&, const TessellationOptions&) { return 0; }
std::vector<Rim> rims(const Cylinder&) { return {}; }
std::uint32_t segments(const Cylinder&, const TessellationOptions&) { return 0; }
Problem problem(const Cone&) { return std::nullopt; }
Result<Mesh> make(const Cone&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Cone&, const TessellationOptions&) { return 0; }
std::vector<Rim> rims(const Cone&) { return {}; }
std::uint32_t segments(const Cone&, const TessellationOptions&) { return 0; }
Problem problem(const Disc&) { return std::nullopt; }
Result<Mesh> make(const Disc&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Disc&, const TessellationOptions&) { return 0; }
std::vector<Rim> rims(const Disc&) { return {}; }
std::uint32_t segments(const Disc&, const TessellationOptions&) { return 0; }
Problem problem(const Torus&) { return std::nullopt; }
Result<Mesh> make(const Torus&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Torus&, const TessellationOptions&) { return 0; }
Problem problem(const Dish&) { return std::nullopt; }
Result<Mesh> make(const Dish&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Dish&, const TessellationOptions&) { return 0; }
std::vector<Rim> rims(const Dish&) { return {}; }
std::uint32_t segments(const Dish&, const TessellationOptions&) { return 0; }
Problem problem(const Lathe&) { return std::nullopt; }
Result<Mesh> make(const Lathe&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Lathe&, const TessellationOptions&) { return 0; }
std::vector<Rim> rims(const Lathe&) { return {}; }
std::uint32_t segments(const Lathe&, const TessellationOptions&) { return 0; }

}  // namespace panwright::geometry::internal
