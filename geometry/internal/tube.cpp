#include "geometry/internal/tessellators.h"

namespace panwright::geometry::internal {

Problem problem(const Tube&) { return std::nullopt; }
Result<Mesh> make(const Tube&, const TessellationOptions&, SourceSpan, DiagnosticLog&) { return failed; }
double planned(const Tube&, const TessellationOptions&) { return 0; }
std::vector<Rim> rims(const Tube&) { return {}; }
std::uint32_t segments(const Tube&, const TessellationOptions&) { return 0; }

}  // namespace panwright::geometry::internal
