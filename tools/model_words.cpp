#include "tools/model_words.h"

#include <algorithm>
#include <array>

namespace panwright::tools {

namespace {

std::string with_hyphens(std::string_view name) {
  std::string words(name);
  std::replace(words.begin(), words.end(), '_', '-');
  return words;
}

}  // namespace

std::string diffuse_word(std::uint32_t model) {
  return with_hyphens(materials::info_of(static_cast<materials::DiffuseModel>(model)).name);
}

std::string specular_word(std::uint32_t model) {
  return with_hyphens(materials::info_of(static_cast<materials::SpecularModel>(model)).name);
}

std::string_view form_word(const pan::layout::Sheet& sheet) {
  constexpr std::string_view kForms[] = {"flat", "tube", "cone", "disc", "box", "wrap"};
  return sheet.form < std::size(kForms) ? kForms[sheet.form] : "unknown";
}

std::vector<std::pair<pan::layout::ToleranceReason, std::size_t>> decisions_of(
    const pan::Model& model) {
  std::array<std::size_t, 7> counts{};
  for (const auto& budget : model.mesh_tolerances()) ++counts[budget.reason];
  std::vector<std::pair<pan::layout::ToleranceReason, std::size_t>> out;
  for (std::uint32_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0) out.emplace_back(pan::layout::ToleranceReason{i}, counts[i]);
  return out;
}

}  // namespace panwright::tools
