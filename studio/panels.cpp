#include "studio/panels.h"

#include <imgui.h>

namespace panwright::studio {
namespace {

constexpr float kWidgetShare = 0.55f;  // of the width; the rest is for labels

}  // namespace

Panels::Panels(WindowState& state)
    : camera(state),
      sun(state),
      sky(state),
      image(state),
      parts(state),
      joints(state),
      materials(state),
      save(state),
      state_(state) {}

template <class Panel>
void Panels::tab(const char* name, Panel& panel) {
  const bool restored = first_frame_ && state_.layout.tab == name;
  const bool open =
      ImGui::BeginTabItem(name, nullptr, restored ? ImGuiTabItemFlags_SetSelected : 0);
  state_.widgets.record(std::string("tab/") + name);
  if (!open) return;
  if (!first_frame_) state_.layout.tab = name;
  ImGui::BeginChild(name);
  ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * kWidgetShare);
  panel.draw();
  ImGui::PopItemWidth();
  ImGui::EndChild();
  ImGui::EndTabItem();
}

void Panels::draw() {
  ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * kWidgetShare);
  if (ImGui::BeginTabBar("tabs")) {
    tab("Camera", camera);
    tab("Sun", sun);
    tab("Sky", sky);
    tab("Image", image);
    tab("Parts", parts);
    tab("Joints", joints);
    tab("Materials", materials);
    tab("Save", save);
    ImGui::EndTabBar();
    first_frame_ = false;
  }
  ImGui::PopItemWidth();
}

}  // namespace panwright::studio
