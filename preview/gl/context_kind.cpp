#include "preview/context.h"

namespace panwright::preview {

std::optional<ContextKind> context_kind_from_name(std::string_view name) {
  if (name == "auto") return ContextKind::automatic;
  if (name == "egl") return ContextKind::egl;
  if (name == "osmesa") return ContextKind::osmesa;
  return std::nullopt;
}

}  // namespace panwright::preview
