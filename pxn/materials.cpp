#include "pxn/materials.h"

#include <fmt/core.h>

#include <algorithm>
#include <span>

#include "base/text.h"
#include "pxn/reader/files.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/presets.h"

namespace panwright::pxn {

std::vector<std::string_view> preset_names() {
  std::vector<std::string_view> names;
  for (const PresetText& text : std::span(kPresetTexts, kPresetCount)) names.push_back(text.name);
  return names;
}

std::optional<std::string_view> preset_text(std::string_view name) {
  for (const PresetText& text : std::span(kPresetTexts, kPresetCount))
    if (text.name == name) return text.text;
  return std::nullopt;
}

Result<DescribedMaterial> preset(std::string_view name, DiagnosticLog& log) {
  const Preset* found = find_preset(name);
  if (found == nullptr) {
    const auto near = nearest_name(name, preset_names());
    log.report(Code("E1311"), {}, fmt::format("the library has no material {}", in_quotes(name)),
               near ? fmt::format("did you mean '{}'?", *near) : "");
    return failed;
  }
  DescribedMaterial described{
      materials::resolved(found->fields, {}, log), found->provenance, {}, std::string(found->back)};
  described.material.name = name;
  return described;
}

Result<std::vector<DescribedMaterial>> read_materials(const std::filesystem::path& path,
                                                      const Options& options, DiagnosticLog& log,
                                                      const Job& job) {
  FoundFile top;
  const auto files = files_on_disk(path, options, top);
  return run_job(job, log, [&]() -> Result<std::vector<DescribedMaterial>> {
    Reporter reporter(log);
    scene::Scene scene;
    Loader loader(*files, options, reporter, scene, job);
    if (!loader.load_top(top)) return failed;
    std::vector<DescribedMaterial> all;
    for (const NamedMaterial& material : loader.materials()) {
      all.push_back(
          {materials::resolved(material.fields, material.place, log), material.provenance, {}, {}});
      all.back().back = material.back.named >= 0 ? loader.material(material.back.named).name
                                                 : std::string(material.back.library);
      all.back().material.name = material.name;
    }
    const auto textures =
        std::make_shared<const std::vector<scene::Texture>>(std::move(scene.textures));
    for (DescribedMaterial& each : all)
      if (each.material.maps.any()) each.textures = textures;
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return a.material.name < b.material.name;
    });
    return all;
  });
}

}  // namespace panwright::pxn
