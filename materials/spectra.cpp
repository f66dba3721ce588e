#include "materials/spectra.h"

#include <array>

namespace panwright::materials {
namespace {

constexpr std::array<std::string_view, 3> kNames{"Ag", "Al", "Au"};
const std::array<Conductor, 3> kMetals{{{{.16262, .14512, .13550}, {4.0728, 3.19, 2.1997}},
                                        {{1.5196, .96565, .53124}, {7.6635, 6.4581, 5.0699}},
                                        {{.18299, .42108, 1.3734}, {3.4242, 2.3459, 1.7704}}}};

}  // namespace

std::optional<Conductor> metal(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return kMetals[i];
  return std::nullopt;
}

std::span<const std::string_view> metal_names() { return kNames; }

}  // namespace panwright::materials
