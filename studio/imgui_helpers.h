// Vectors and fixed windows of Dear ImGui.
#pragma once

#include <imgui.h>

#include "base/math.h"

namespace panwright::studio {

inline ImVec2 to_imgui(const Vec2& v) { return {static_cast<float>(v.x), static_cast<float>(v.y)}; }
inline Vec2 from_imgui(const ImVec2& v) { return {v.x, v.y}; }

// ImGui::Begin() of a window that cannot be moved or resized. Pixels
inline void begin_window(const char* name, const Vec2& at, const Vec2& size,
                         ImGuiWindowFlags more = 0) {
  ImGui::SetNextWindowPos(to_imgui(at));
  ImGui::SetNextWindowSize(to_imgui(size));
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoSavedSettings | more);
}

}  // namespace panwright::studio
