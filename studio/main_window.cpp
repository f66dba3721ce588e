#include "studio/main_window.h"

#include <GLFW/glfw3.h>
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "base/text.h"
#include "studio/imgui_helpers.h"
#include "studio/play.h"
#include "workspace/drawer.h"
#include "workspace/lamp_text.h"

namespace panwright::studio {
namespace {

constexpr double kMaxPanelShare = 0.5;  // of the width of the window
constexpr double kMinPanelWidth = 160;  // pixels at a scale of 1
constexpr std::uint32_t kReferenceBounces = 3;

}  // namespace

MainWindow::MainWindow(const Options& options)
    : state_(options), panels_(state_), image_(state_), player_(state_), messages_(state_) {}

void MainWindow::frame(const Vec2& size, double screen_scale, const Textures& textures) {
  panels_.materials.set_texture(textures.sample);
  state_.widgets.begin_frame();
  update_models();
  Layout& layout = state_.layout;
  layout.width = static_cast<std::uint32_t>(size.x);
  layout.height = static_cast<std::uint32_t>(size.y);
  ImGui::GetIO().FontGlobalScale = static_cast<float>(layout.text);
  const double scale = screen_scale * layout.text;
  const double left =
      layout.panel_shown ? std::min(layout.panel * scale, kMaxPanelShare * size.x) : 0;
  const double top = 34 * scale;
  // the same with and without messages, so that the image keeps its size
  const double bottom = std::min(104 * scale, 0.2 * size.y);
  status_bar({0, 0}, {size.x, top});
  if (layout.panel_shown) {
    begin_window("panel", {0, top}, {left, size.y - top});
    panels_.draw();
    ImGui::End();
    border({left, top}, {size.x, size.y - top}, scale);
  }
  messages_.draw({left, size.y - bottom}, {size.x - left, bottom});
  const double bar = player_.shown() ? top : 0;
  if (player_.shown()) player_.draw({left, size.y - bottom - bar}, {size.x - left, bar});
  image_.draw({left, top}, {size.x - left, size.y - top - bottom - bar}, textures.image,
              border_dragged_);
  handle_keys();
  panels_.joints.advance();
  player_.advance();
  request_image();
  panels_.save.poll();
}

void MainWindow::update_models() {
  const Project::State now = state_.project.state();
  Project::State& models = state_.models;
  const bool world_changed = now.world != models.world;
  const bool read = now.readings != models.readings;
  if (world_changed && now.spheres) state_.spheres = *now.spheres;
  models = now;
  if (read) panels_.materials.models_read();
  if (!models.world) return;
  if (world_changed) player_.advance();
  if (world_changed) state_.take_camera();
  if (!framed_ && state_.image_size.x > 0) {
    state_.frame_all();
    state_.view.raise_sun(state_.spheres.of(state_.posed()).up);
    framed_ = true;
  }
  if (!world_changed) return;
  state_.take_scene();
  // lamps, joints and targets that no longer exist
  std::erase_if(state_.view.joints, [&](const auto& each) {
    DiagnosticLog ignored;
    return !workspace::find_joint(each.first, *models.world, ignored);
  });
  std::erase_if(state_.view.sky.lamps, [&](const auto& each) {
    return std::ranges::none_of(models.world->lamps(), [&](const world::Lamp& lamp) {
      return workspace::lamp_path(lamp) == each.first;
    });
  });
  std::erase_if(state_.view.poses,
                [&](const auto& each) { return !models.world->find(each.first); });
}

void MainWindow::status_bar(const Vec2& at, const Vec2& size) {
  begin_window("bar", at, size, ImGuiWindowFlags_NoScrollbar);
  bool& panel_shown = state_.layout.panel_shown;
  if (ImGui::ArrowButton("##panel", panel_shown ? ImGuiDir_Left : ImGuiDir_Right))
    panel_shown = !panel_shown;
  state_.widgets.record("panel/shown");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Hide or show the panel. Key P");
  ImGui::SameLine();
  const std::string status = status_text();
  std::string paths, names;
  for (const std::string& file : state_.project.files()) {
    paths += (paths.empty() ? "" : "  ") + file;
    names += (names.empty() ? "" : "  ") + std::filesystem::path(file).filename().string();
  }
  // the status has precedence over paths, and over names
  const float room = ImGui::GetContentRegionAvail().x - 24 - ImGui::CalcTextSize(status.c_str()).x;
  if (ImGui::CalcTextSize(paths.c_str()).x <= room) names = paths;
  const float wide = ImGui::CalcTextSize(names.c_str()).x;
  if (wide <= room) {
    ImGui::TextUnformatted(names.c_str());
    ImGui::SameLine(0, 24);
  }
  ImGui::TextDisabled("%s", status.c_str());
  if ((names != paths || wide > room) && ImGui::IsItemHovered())
    ImGui::SetTooltip("%s\n%s", paths.c_str(), status.c_str());
  ImGui::End();
}

// Work in progress, or the quality of the image.
std::string MainWindow::status_text() const {
  const RenderThread::Status status = state_.renderer.status();
  const RenderResult* result = state_.result.get();
  if (state_.models.reading) return state_.models.world ? "reading again" : "reading";
  if (!status.problem.empty()) return status.problem;
  if (result == nullptr) return "";
  if (result->exact && status.drawing) return "drawing";
  if (result->exact) {
    const preview::SamplingReport& sampling = result->sampling;
    double flux = sampling.flux;
    for (const preview::ImposterReport& each : sampling.imposters)
      flux = std::max(flux, each.flux_error);
    return fmt::format(
        "exact: {}{}flux error {:.2g} %, {:.0f} ms",
        sampling.samples >= 1 ? fmt::format("{:.1f} samples per pixel, ", sampling.samples) : "",
        sampling.imposters.empty() ? "" : counted(sampling.imposters.size(), "imposter") + ", ",
        100 * flux, 1e3 * result->seconds);
  }
  return fmt::format(
      "interactive: {:.0f} % of the pixels, one sample each, {}hard shadows, {:.0f} ms{}",
      100.0 * static_cast<double>(result->image.pixels()) /
          (result->request.width * result->request.height),
      result->level_scale > 1
          ? fmt::format("levels of detail {:g} x coarser, ", result->level_scale)
          : "",
      1e3 * result->seconds, status.exact ? "; drawing the exact image" : "");
}

// Border between panel and image, dragged to resize the panel. size: of the window below `at`
void MainWindow::border(const Vec2& at, const Vec2& size, double scale) {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const double reach = 4 * scale;
  state_.widgets.record("border", at - Vec2(reach, 0), {at.x + reach, at.y + size.y});
  const bool over = std::fabs(mouse.x - at.x) < reach && mouse.y > at.y &&
                    !ImGui::IsAnyItemActive() && !image_.dragged();
  if (over && ImGui::IsMouseClicked(0)) border_dragged_ = true;
  if (!ImGui::IsMouseDown(0)) border_dragged_ = false;
  if (over || border_dragged_) {
    ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    ImGui::GetForegroundDrawList()->AddLine(
        to_imgui(at), {static_cast<float>(at.x), static_cast<float>(at.y + size.y)},
        IM_COL32(90, 150, 220, 255), 2);
  }
  const double widest = kMaxPanelShare * size.x;
  if (border_dragged_)
    state_.layout.panel =
        std::clamp<double>(mouse.x, std::min(kMinPanelWidth * scale, widest), widest) / scale;
}

void MainWindow::handle_keys() {
  const ImGuiIO& io = ImGui::GetIO();
  double& text = state_.layout.text;
  if (io.KeyCtrl && !io.WantTextInput) {
    const bool more = ImGui::IsKeyPressed(GLFW_KEY_EQUAL) || ImGui::IsKeyPressed(GLFW_KEY_KP_ADD);
    const bool less =
        ImGui::IsKeyPressed(GLFW_KEY_MINUS) || ImGui::IsKeyPressed(GLFW_KEY_KP_SUBTRACT);
    if (more || less) text = std::clamp(text + (more ? 0.1 : -0.1), kSmallestText, kLargestText);
    if (ImGui::IsKeyPressed(GLFW_KEY_0)) text = 1;
  }
  if (io.WantTextInput || io.KeyCtrl) return;
  const auto pressed = [](int key) { return ImGui::IsKeyPressed(key, false); };
  if (pressed(GLFW_KEY_SPACE)) player_.toggle();
  if (ImGui::IsKeyPressed(GLFW_KEY_LEFT)) player_.step(-1);
  if (ImGui::IsKeyPressed(GLFW_KEY_RIGHT)) player_.step(1);
  if (pressed(GLFW_KEY_C) && player_.shown()) state_.view.from_outside = !state_.view.from_outside;
  const double step = 2.0 * std::min(io.DeltaTime, 0.05f);
  const auto down = [](int key) { return ImGui::IsKeyDown(key); };
  state_.view.camera.fly(step * (down(GLFW_KEY_W) - down(GLFW_KEY_S)),
                         step * (down(GLFW_KEY_D) - down(GLFW_KEY_A)),
                         step * (down(GLFW_KEY_E) - down(GLFW_KEY_Q)));
  if (pressed(GLFW_KEY_F)) state_.frame_all();
  if (pressed(GLFW_KEY_R)) state_.project.reload();
  if (pressed(GLFW_KEY_P)) state_.layout.panel_shown = !state_.layout.panel_shown;
  if (pressed(GLFW_KEY_L)) state_.layout.labels = !state_.layout.labels;
  PartSelection& parts = state_.parts;
  if (pressed(GLFW_KEY_H) && !parts.selected.empty())
    if (!parts.hidden.erase(parts.selected)) parts.hidden.insert(parts.selected);
}

void MainWindow::request_image() {
  const auto& world = state_.models.world;
  if (!world || state_.image_size.x < 1) return;
  RenderRequest request;
  request.world = world;
  request.view = state_.view;
  request.width = static_cast<std::uint32_t>(state_.pixels().x);
  request.height = static_cast<std::uint32_t>(state_.pixels().y);
  // in steps, so that no change of the window makes another image
  const Vec2 shrunk = state_.pixels() / state_.image_size;
  request.shown_scale = 1 / std::ceil(std::max({1.0, shrunk.x, shrunk.y}) - 1e-9);
  const auto& hidden = state_.parts.hidden;
  for (std::size_t i = 0; i < world->size() && !hidden.empty(); ++i) {
    const world::Instance& target = (*world)[i];
    for (std::uint32_t node = 0; node < target.model()->nodes().size(); ++node)
      if (hidden.count(target.name() + "/" + target.model()->node_path(node)))
        request.hidden.emplace_back(i, node);
  }
  request.edges = state_.image.edges;
  if (state_.image.comparison != "off" && state_.imager() == nullptr)
    request.reference_bounces = state_.image.interreflections ? kReferenceBounces : 0u;
  state_.renderer.request(std::move(request));
}

std::optional<SavedToImage> MainWindow::saved_to_image() {
  const Project::State& models = state_.models;
  if (models.saved == measured_ || !state_.result || state_.result->request.world != models.world)
    return {};
  measured_ = models.saved;
  if (models.saved == 0) return {};
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto later =
      std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() - models.saved;
  return SavedToImage{models.noticed, models.read, 1e-9 * static_cast<double>(later)};
}

bool MainWindow::settled() const {
  const Project::State& models = state_.models;
  const RenderResult* result = state_.result.get();
  return !models.reading && models.readings > 0 &&
         (!models.world ||
          (result != nullptr && result->exact && !state_.renderer.status().drawing &&
           result->request.world == models.world && result->request.view == state_.view));
}

std::string MainWindow::failure() const {
  const RenderResult* result = state_.result.get();
  if (result == nullptr || !result->failed) return {};
  return result->messages.empty() ? "it could not be drawn" : result->messages[0].text;
}

bool MainWindow::idle() const {
  return settled() && !playing() && !panels_.joints.playing() && !saving() && !recording() &&
         !sampling() && !state_.renderer.status().comparing && state_.image.comparison != "flicker";
}

void MainWindow::drop(const std::vector<std::string>& files) {
  for (const std::string& file : files) state_.project.add(file);
}

}  // namespace panwright::studio
