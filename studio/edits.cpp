#include "studio/edits.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/file.h"

namespace panwright::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxMaterialFileBytes = 64 << 20;

std::vector<std::string> text_lines(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    out.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

const pxn::EditableNumber* find_number(const MaterialFile& file, const Edit& edit) {
  for (const pxn::EditableMaterial& material : file.materials)
    for (const auto* numbers : {&material.numbers, &material.inherited})
      for (const pxn::EditableNumber& number : *numbers)
        if (material.name == edit.material && number.element == edit.element &&
            number.attribute == edit.attribute && number.index == edit.index)
          return &number;
  return nullptr;
}

bool read_materials(MaterialFile& file) {
  DiagnosticLog ignored;
  auto found = pxn::editable_materials(file.path.string(), file.text, ignored);
  auto foils = pxn::editable_foils(file.path.string(), file.text, ignored);
  file.materials = found ? *std::move(found) : std::vector<pxn::EditableMaterial>();
  file.foils = foils ? foils->size() : 0;
  for (std::size_t i = 0; i < file.foils; ++i) {
    file.materials.push_back(std::move((*foils)[i]));
    file.materials.back().name = "foil " + file.materials.back().name;
  }
  return static_cast<bool>(found);
}

}  // namespace

bool Edit::same_place(const Edit& other) const {
  return path == other.path && material == other.material && element == other.element &&
         attribute == other.attribute && index == other.index;
}

void Edits::update(const std::vector<fs::path>& files) {
  std::vector<MaterialFile> now;
  for (const fs::path& path : files) {
    if (path.extension() != ".pxn") continue;
    std::error_code error;
    MaterialFile file{fs::weakly_canonical(path, error), "", "", {}, 0};
    if (std::any_of(now.begin(), now.end(),
                    [&](const MaterialFile& other) { return other.path == file.path; }))
      continue;
    DiagnosticLog ignored;
    auto bytes = read_file(file.path, kMaxMaterialFileBytes, ignored);
    if (!bytes) continue;
    file.saved = *std::move(bytes);
    file.text = file.saved;
    // a text with an error keeps its last materials, so that no edit is lost
    const auto old = std::find_if(files_.begin(), files_.end(), [&](const MaterialFile& other) {
      return other.path == file.path;
    });
    if (!read_materials(file) && old != files_.end()) {
      now.push_back(*old);
      continue;
    }
    now.push_back(std::move(file));
  }
  files_ = std::move(now);
  message_.clear();
  apply();
}

void Edits::apply() {
  for (MaterialFile& file : files_) {
    const bool was = file.text != file.saved;
    file.text = file.saved;
    if (was) read_materials(file);
  }
  std::erase_if(edits_, [&](const Edit& edit) {
    for (MaterialFile& file : files_) {
      if (file.path != edit.path) continue;
      if (const pxn::EditableNumber* number = find_number(file, edit)) {
        file.text = pxn::with_number(file.text, *number, edit.value);
        read_materials(file);
        return false;
      }
    }
    message_ = fmt::format("{} of '{}' no longer exists in {}: its change was dropped",
                           edit.element, edit.material, edit.path.filename().string());
    return true;
  });
}

void Edits::change(const MaterialFile& file, const pxn::EditableMaterial& material,
                   const pxn::EditableNumber& number, double value) {
  if (!std::isfinite(value)) return;
  const Edit edit{file.path, material.name, number.element, number.attribute, number.index, value};
  if (open_ && !edits_.empty() && edits_.back().same_place(edit))
    edits_.back() = edit;
  else
    edits_.push_back(edit);
  open_ = true;
  apply();
}

bool Edits::undo() {
  if (edits_.empty()) return false;
  edits_.pop_back();
  open_ = false;
  apply();
  return true;
}

std::map<fs::path, std::shared_ptr<const std::string>> Edits::unsaved() const {
  std::map<fs::path, std::shared_ptr<const std::string>> out;
  for (const MaterialFile& file : files_)
    if (file.text != file.saved) out[file.path] = std::make_shared<const std::string>(file.text);
  return out;
}

std::vector<std::pair<fs::path, std::vector<ChangedLine>>> Edits::difference() const {
  std::vector<std::pair<fs::path, std::vector<ChangedLine>>> out;
  for (const MaterialFile& file : files_) {
    if (file.text == file.saved) continue;
    // numbers and elements of presets have no line ends: lines stay where they are
    const auto before = text_lines(file.saved), after = text_lines(file.text);
    std::vector<ChangedLine> lines;
    for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i)
      if (before[i] != after[i])
        lines.push_back({static_cast<std::uint32_t>(i + 1), before[i], after[i]});
    out.emplace_back(file.path, std::move(lines));
  }
  return out;
}

bool Edits::save(DiagnosticLog& log) {
  bool good = true;
  for (MaterialFile& file : files_) {
    if (file.text == file.saved) continue;
    const auto now = read_file(file.path, kMaxMaterialFileBytes, log);
    if (now && *now != file.saved) {
      log.report_file(Code("E0103"), file.path.string(),
                      "the file has changed on disk; it is read again, and the changes stay");
      good = false;
      continue;
    }
    if (!now || !write_file(file.path, as_bytes(file.text), log)) {
      good = false;
      continue;
    }
    file.saved = file.text;
    std::erase_if(edits_, [&](const Edit& edit) { return edit.path == file.path; });
  }
  open_ = false;
  return good;
}

}  // namespace panwright::studio
