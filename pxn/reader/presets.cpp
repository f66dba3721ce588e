#include "pxn/reader/presets.h"

#include <cassert>
#include <map>
#include <mutex>
#include <span>

#include "pxn/reader/files.h"
#include "pxn/reader/loader.h"

namespace panwright::pxn {
namespace {

Preset read_preset(const PresetText& text) {
  DiagnosticLog log;
  Reporter reporter(log);
  const MemoryFile file{std::string(text.name) + ".pxn", std::string(text.text)};
  FoundFile top;
  const Options options;
  const auto files = files_in_memory({&file, 1}, options, top);
  scene::Scene scene;
  Loader loader(*files, options, reporter, scene, {});
  (void)loader.load_top(top);
  // note: a test reads every one of them without a diagnostic
  assert(loader.materials().size() == 1);
  const NamedMaterial& material = loader.materials().front();
  return {material.fields, material.provenance, material.back.library};
}

}  // namespace

const Preset* find_preset(std::string_view name) {
  static std::mutex guard;
  static std::map<std::string_view, Preset> known;
  for (const PresetText& text : std::span(kPresetTexts, kPresetCount)) {
    if (text.name != name) continue;
    {
      const std::lock_guard lock(guard);
      if (const auto found = known.find(name); found != known.end()) return &found->second;
    }
    Preset preset = read_preset(text);
    const std::lock_guard lock(guard);
    return &known.emplace(text.name, std::move(preset)).first->second;
  }
  return nullptr;
}

}  // namespace panwright::pxn
