#include <GLFW/glfw3.h>
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/text.h"
#include "studio/window.h"
#include "workspace/drawer.h"

namespace panwright::studio {
namespace {

constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                    ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                    ImGuiWindowFlags_NoBringToFrontOnFocus |
                                    ImGuiWindowFlags_NoSavedSettings;

ImVec2 im(const Vec2& v) { return {static_cast<float>(v.x), static_cast<float>(v.y)}; }

constexpr double kMostOfPanel = 0.5;  // of the window's width
constexpr double kLeastPanel = 160;   // pixels at a scale of 1

void begin(const char* name, const Vec2& at, const Vec2& size, ImGuiWindowFlags more = 0) {
  ImGui::SetNextWindowPos(im(at));
  ImGui::SetNextWindowSize(im(size));
  ImGui::Begin(name, nullptr, kFixed | more);
}

}  // namespace

Desk::Desk(const Options& options)
    : options_(options),
      layout_(options.layout),
      project_(options.files, options.open, glfwPostEmptyEvent),
      artist_(options.context, glfwPostEmptyEvent),
      layer_(options.layout.layer),
      mark_white_(options.layout.mark_white),
      show_labels_(options.layout.labels) {}

Layout Desk::layout() const {
  Layout out = layout_;
  out.layer = layer_;
  out.mark_white = mark_white_;
  out.labels = show_labels_;
  return out;
}

void Desk::frame(const Vec2& size, double screen_scale, const Textures& textures) {
  sample_texture_ = textures.sample;
  widgets_.begin_frame();
  take_models();
  layout_.width = static_cast<std::uint32_t>(size.x);
  layout_.height = static_cast<std::uint32_t>(size.y);
  ImGui::GetIO().FontGlobalScale = static_cast<float>(layout_.text);
  const double scale = screen_scale * layout_.text;
  const double left =
      layout_.panel_shown ? std::min(layout_.panel * scale, kMostOfPanel * size.x) : 0;
  const double top = 34 * scale;
  // the same with and without errors: the image stays as it is
  const double low = std::min(104 * scale, 0.2 * size.y);
  bar({0, 0}, {size.x, top});
  if (layout_.panel_shown) {
    panel({0, top}, {left, size.y - top});
    border({left, top}, {size.x, size.y - top}, scale);
  }
  messages({left, size.y - low}, {size.x - left, low});
  image_view({left, top}, {size.x - left, size.y - top - low}, textures.image);
  keys();
  order();
  if (saving_.valid() &&
      saving_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    saved_ = saving_.get();
}

void Desk::take_models() {
  const Project::State now = project_.state();
  const bool other = now.world != models_.world;
  if (now.readings != models_.readings) edits_.look(now.watched);
  if (now.world != models_.world && now.spheres) spheres_ = *now.spheres;
  models_ = now;
  if (!models_.world) return;
  if (!framed_ && image_size_.x > 0) {
    frame_all();
    framed_ = true;
  }
  if (!other) return;
  // what the new models do not have any more
  std::erase_if(eye_.joints, [&](const auto& each) {
    DiagnosticLog ignored;
    return !workspace::find_joint(each.first, *models_.world, ignored);
  });
  std::erase_if(eye_.poses, [&](const auto& each) { return !models_.world->find(each.first); });
}

world::World Desk::posed() const {
  world::World out = *models_.world;
  for (const auto& [name, place] : eye_.poses)
    if (const auto target = out.find(name))
      out.set_pose(*target, {place.position, place.rotation()});
  workspace::JointSetter setter(out);
  DiagnosticLog ignored;
  for (const auto& [joint, value] : eye_.joints) setter.set({joint, value}, ignored);
  return out;
}

void Desk::frame_all() {
  if (!models_.world) return;
  eye_.frame_all(spheres_.of(posed()), image_size_.y / std::max(image_size_.x, 1.0));
}

void Desk::bar(const Vec2& at, const Vec2& size) {
  begin("bar", at, size, ImGuiWindowFlags_NoScrollbar);
  if (ImGui::ArrowButton("##panel", layout_.panel_shown ? ImGuiDir_Left : ImGuiDir_Right))
    layout_.panel_shown = !layout_.panel_shown;
  widgets_.seen("panel/shown");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Hides the panel, or shows it again. Key P");
  ImGui::SameLine();
  const std::string words = status_words();
  std::string names, shown;
  for (const std::string& file : project_.files()) {
    names += (names.empty() ? "" : "  ") + file;
    shown += (shown.empty() ? "" : "  ") + std::filesystem::path(file).filename().string();
  }
  // names give way to what happens
  const float room = ImGui::GetContentRegionAvail().x - 24 - ImGui::CalcTextSize(words.c_str()).x;
  if (ImGui::CalcTextSize(names.c_str()).x <= room) shown = names;
  const float wide = ImGui::CalcTextSize(shown.c_str()).x;
  if (wide <= room) {
    ImGui::TextUnformatted(shown.c_str());
    ImGui::SameLine(0, 24);
  }
  ImGui::TextDisabled("%s", words.c_str());
  if ((shown != names || wide > room) && ImGui::IsItemHovered())
    ImGui::SetTooltip("%s\n%s", names.c_str(), words.c_str());
  ImGui::End();
}

// What is under way, or what the image is.
std::string Desk::status_words() const {
  const Artist::Status status = artist_.status();
  std::string words;
  if (models_.reading)
    words = models_.world ? "reading again" : "reading";
  else if (!status.problem.empty())
    words = status.problem;
  else if (shown_ && shown_->exact && !status.drawing) {
    double flux = shown_->sampling.flux;
    for (const preview::ImposterReport& each : shown_->sampling.imposters) flux = std::max(flux, each.flux_error);
    words = fmt::format("exact: {}{}flux within {:.2g} %, {:.0f} ms",
                        shown_->sampling.samples >= 1 ? fmt::format("{:.1f} samples a pixel, ", shown_->sampling.samples) : "",
                        shown_->sampling.imposters.empty()
                            ? ""
                            : counted(shown_->sampling.imposters.size(), "imposter") + ", ",
                        100 * flux, 1e3 * shown_->seconds);
  }
  else if (shown_ && shown_->exact)
    words = "drawing";
  else if (shown_)
    words = fmt::format(
        "following: {:.0f} % of the pixels, one sample each, {}hard shadows, {:.0f} ms{}",
        100.0 * static_cast<double>(shown_->image.pixels()) /
            (shown_->order.width * shown_->order.height),
        shown_->coarser > 1 ? fmt::format("levels of detail {:g} x coarser, ", shown_->coarser)
                            : "",
        1e3 * shown_->seconds, status.exact ? "; exact image under way" : "");
  return words;
}

void Desk::panel(const Vec2& at, const Vec2& size) {
  begin("panel", at, size);
  ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.55f);
  if (ImGui::BeginTabBar("tabs")) {
    const auto tab = [&](const char* name, void (Desk::*body)()) {
      const bool remembered = first_frame_ && layout_.tab == name;
      const bool open =
          ImGui::BeginTabItem(name, nullptr, remembered ? ImGuiTabItemFlags_SetSelected : 0);
      widgets_.seen(std::string("tab/") + name);
      if (!open) return;
      if (!first_frame_) layout_.tab = name;
      ImGui::BeginChild(name);
      ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.55f);
      (this->*body)();
      ImGui::PopItemWidth();
      ImGui::EndChild();
      ImGui::EndTabItem();
    };
    tab("Camera", &Desk::camera_tab);
    tab("Sun", &Desk::sun_tab);
    tab("Image", &Desk::image_tab);
    tab("Parts", &Desk::parts_tab);
    tab("Joints", &Desk::joints_tab);
    tab("Materials", &Desk::materials_tab);
    tab("Save", &Desk::save_tab);
    ImGui::EndTabBar();
    first_frame_ = false;
  }
  ImGui::PopItemWidth();
  ImGui::End();
}

// Between panel and image: it is taken to make the panel wider. size: of the window below `at`
void Desk::border(const Vec2& at, const Vec2& size, double scale) {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const double reach = 4 * scale;
  widgets_.seen("border", at - Vec2(reach, 0), {at.x + reach, at.y + size.y});
  const bool over = std::fabs(mouse.x - at.x) < reach && mouse.y > at.y &&
                    !ImGui::IsAnyItemActive() && !dragging_;
  if (over && ImGui::IsMouseClicked(0)) bordering_ = true;
  if (!ImGui::IsMouseDown(0)) bordering_ = false;
  if (over || bordering_) {
    ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    ImGui::GetForegroundDrawList()->AddLine(
        im(at), {static_cast<float>(at.x), static_cast<float>(at.y + size.y)},
        IM_COL32(90, 150, 220, 255), 2);
  }
  if (bordering_)
    layout_.panel =
        std::clamp<double>(mouse.x, std::min(kLeastPanel * scale, kMostOfPanel * size.x),
                           kMostOfPanel * size.x) /
        scale;
}

void Desk::messages(const Vec2& at, const Vec2& size) {
  begin("messages", at, size);
  const std::vector<Message> all = all_messages();
  const auto count = [&](Severity severity) {
    return static_cast<std::uint64_t>(
        std::count_if(all.begin(), all.end(),
                      [&](const Message& each) { return each.severity == severity; }));
  };
  if (models_.failed) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.6f, 0.2f, 1));
    ImGui::TextWrapped("%s", models_.partial ? "The image is of what can be read."
                             : models_.world ? "The image is of the last version without an error."
                                             : "There is no version without an error yet.");
    ImGui::PopStyleColor();
  }
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  ImGui::TextWrapped("%s, %s, %s; read in %.0f ms, %s watched",
                     counted(count(Severity::error), "error").c_str(),
                     counted(count(Severity::warning), "warning").c_str(),
                     counted(count(Severity::note), "note").c_str(), 1e3 * models_.seconds,
                     counted(models_.watched.size(), "file").c_str());
  ImGui::PopStyleColor();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Message& each = all[i];
    const char* word = each.severity == Severity::error     ? "error"
                       : each.severity == Severity::warning ? "warning"
                                                            : "note";
    const std::string where =
        each.file.empty() ? ""
        : each.line == 0  ? each.file + ": "
                          : fmt::format("{}:{}:{}: ", each.file, each.line, each.column);
    const std::string line = fmt::format("{}{}: {}{}", where, word, each.text,
                                         each.code.empty() ? "" : " [" + each.code + "]");
    const ImVec2 start = ImGui::GetCursorPos();
    const float height =
        ImGui::CalcTextSize(line.c_str(), nullptr, false, ImGui::GetContentRegionAvail().x).y;
    const bool chosen =
        ImGui::Selectable(fmt::format("##message{}", i).c_str(), false, 0, {0, height});
    widgets_.seen(fmt::format("message/{}", i + 1));
    if (!each.file.empty() && ImGui::IsItemHovered())
      ImGui::SetTooltip("Opens the place in $VISUAL or $EDITOR");
    if (chosen) open_in_editor(each);
    ImGui::SetCursorPos(start);
    ImGui::PushStyleColor(ImGuiCol_Text, each.severity == Severity::error
                                             ? ImVec4(1, 0.6f, 0.2f, 1)
                                         : each.severity == Severity::warning
                                             ? ImVec4(0.95f, 0.85f, 0.4f, 1)
                                             : ImVec4(0.75f, 0.75f, 0.75f, 1));
    ImGui::TextWrapped("%s", line.c_str());
    ImGui::PopStyleColor();
  }
  ImGui::End();
}

std::vector<Message> Desk::all_messages() const {
  std::vector<Message> all = models_.messages;
  if (!options_.layout_problem.empty())
    all.push_back({Severity::note, "", options_.layout_problem, "", 0, 0});
  if (!widgets_.limited().empty())
    all.insert(all.begin(), {Severity::warning, "", widgets_.limited(), "", 0, 0});
  if (shown_ && !models_.reading)
    all.insert(all.end(), shown_->messages.begin(), shown_->messages.end());
  return all;
}

void Desk::image_view(const Vec2& at, const Vec2& size, std::uintptr_t texture) {
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  begin("image", at, size, ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  const Vec2 whole(std::floor(std::max(size.x, 16.0)), std::floor(std::max(size.y, 16.0)));
  image_size_ = whole;
  widgets_.seen("image", at, at + whole);
  image_place_ = *widgets_.find("image");
  if (shown_ && texture != 0) {
    ImGui::Image(reinterpret_cast<ImTextureID>(texture), im(whole));
    if (const std::string words = canvas_words(); !words.empty()) {
      const ImVec2 place = im(at + Vec2(10, 8)), size_of = ImGui::CalcTextSize(words.c_str());
      ImDrawList* list = ImGui::GetWindowDrawList();
      list->AddRectFilled({place.x - 4, place.y - 2}, {place.x + size_of.x + 4, place.y + size_of.y + 2}, IM_COL32(0, 0, 0, 170));
      list->AddText(place, IM_COL32(230, 230, 230, 255), words.c_str());
    }
  } else {
    ImGui::SetCursorPos({24, 24});
    ImGui::TextDisabled("%s", models_.reading ? "reading" : models_.world ? "drawing" : "nothing to show");
  }
  if (ImGui::IsWindowHovered() || dragging_) hand_on_image(at, whole);
  if (show_labels_) labels(at);
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (ImGui::IsWindowHovered() && !dragging_) readings({mouse.x, mouse.y}, at, texture);
  ImGui::End();
  ImGui::PopStyleVar();
}

void Desk::hand_on_image(const Vec2& at, const Vec2& size) {
  const ImGuiIO& io = ImGui::GetIO();
  const Vec2 way = Vec2(io.MouseDelta.x, io.MouseDelta.y) / size.y;
  const bool any = ImGui::IsMouseDown(0) || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2);
  if (ImGui::IsWindowHovered() && any && !bordering_) dragging_ = true;
  if (!any) {
    // a click without a way: what is there is selected
    const ImVec2 from = io.MouseClickedPos[0];
    if (dragging_ && ImGui::IsMouseReleased(0) && shown_ && shown_->exact &&
        std::hypot(io.MousePos.x - from.x, io.MousePos.y - from.y) < 3) {
      const auto x = static_cast<std::size_t>(std::max(0.0, io.MousePos.x - at.x));
      const auto y = static_cast<std::size_t>(std::max(0.0, io.MousePos.y - at.y));
      const preview::Image& image = shown_->image;
      selected_.clear();
      if (x < image.width && y < image.height && image.has_ground_truth()) {
        const std::size_t i = y * image.width + x;
        if (image.target_id[i] > 0) {
          const world::Instance& target = (*shown_->order.world)[image.target_id[i] - 1];
          selected_ = target.name() + "/" + target.model()->node_path(image.node_id[i] - 1);
        }
      }
    }
    dragging_ = false;
  }
  if (dragging_ && (way.x != 0 || way.y != 0)) {
    eye_.frame.clear();
    if (ImGui::IsMouseDown(0) && io.KeyShift)
      eye_.turn_sun(way.x, way.y);
    else if (ImGui::IsMouseDown(0))
      eye_.turn(way.x, way.y);
    else
      eye_.shift(way.x, way.y);
  }
  if (io.MouseWheel != 0) eye_.zoom(std::pow(1.15, -io.MouseWheel));
}

void Desk::keys() {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.KeyCtrl && !io.WantTextInput) {
    const bool more = ImGui::IsKeyPressed(GLFW_KEY_EQUAL) || ImGui::IsKeyPressed(GLFW_KEY_KP_ADD);
    const bool less =
        ImGui::IsKeyPressed(GLFW_KEY_MINUS) || ImGui::IsKeyPressed(GLFW_KEY_KP_SUBTRACT);
    if (more || less)
      layout_.text = std::clamp(layout_.text + (more ? 0.1 : -0.1), kSmallestText, kLargestText);
    if (ImGui::IsKeyPressed(GLFW_KEY_0)) layout_.text = 1;
  }
  if (io.WantTextInput || io.KeyCtrl) return;
  const double step = 2.0 * std::min(io.DeltaTime, 0.05f);
  const auto down = [](int key) { return ImGui::IsKeyDown(key); };
  eye_.fly(step * (down(GLFW_KEY_W) - down(GLFW_KEY_S)),
           step * (down(GLFW_KEY_D) - down(GLFW_KEY_A)),
           step * (down(GLFW_KEY_E) - down(GLFW_KEY_Q)));
  if (ImGui::IsKeyPressed(GLFW_KEY_F, false)) frame_all();
  if (ImGui::IsKeyPressed(GLFW_KEY_R, false)) project_.read_again();
  if (ImGui::IsKeyPressed(GLFW_KEY_P, false)) layout_.panel_shown = !layout_.panel_shown;
  if (ImGui::IsKeyPressed(GLFW_KEY_L, false)) show_labels_ = !show_labels_;
  if (ImGui::IsKeyPressed(GLFW_KEY_H, false) && !selected_.empty())
    if (!hidden_.erase(selected_)) hidden_.insert(selected_);
}

void Desk::order() {
  if (!playing_.empty() && models_.world) {
    DiagnosticLog ignored;
    const auto place = workspace::find_joint(playing_, *models_.world, ignored);
    if (place) {
      const pan::layout::Joint& joint =
          (*models_.world)[place->target].model()->joints()[place->joint];
      const double low = joint.upper[0] > joint.lower[0] ? joint.lower[0] : -kPi;
      const double high = joint.upper[0] > joint.lower[0] ? joint.upper[0] : kPi;
      const double share = 0.5 - 0.5 * std::cos(2 * kPi * (ImGui::GetTime() - play_start_) / 6);
      geometry::JointValues values{};
      values[0] = low + share * (high - low);
      eye_.joints[playing_] =
          workspace::exact_value(static_cast<geometry::JointKind>(joint.kind), values);
    }
  }
  if (!models_.world || image_size_.x < 1) return;
  Order order{models_.world,
              eye_,
              static_cast<std::uint32_t>(image_size_.x),
              static_cast<std::uint32_t>(image_size_.y),
              {},
              {},
              false};
  for (std::size_t i = 0; i < models_.world->size() && !hidden_.empty(); ++i) {
    const world::Instance& target = (*models_.world)[i];
    for (std::uint32_t node = 0; node < target.model()->nodes().size(); ++node)
      if (hidden_.count(target.name() + "/" + target.model()->node_path(node)))
        order.hidden.emplace_back(i, node);
  }
  order.edges = show_edges_;
  if (compare_ != "off") order.reference_bounces = bounces_ ? 3u : 0u;
  artist_.draw(std::move(order));
}

bool Desk::take_image() {
  std::shared_ptr<const DrawnImage> made = artist_.take();
  if (!made) return false;
  if (made->failed) {
    // what went wrong is said beside the image that there is
    auto both = std::make_shared<DrawnImage>(shown_ ? *shown_ : *made);
    both->messages = made->messages;
    shown_ = both;
    return false;
  }
  shown_ = std::move(made);
  histogram_.assign(64, 0);
  saturated_ = 0;
  for (std::size_t i = 0; i < shown_->image.pixels(); ++i) {
    const std::uint8_t* p = &shown_->rgba[4 * i];
    const std::uint8_t most = std::max({p[0], p[1], p[2]});
    saturated_ += most == 255;
    if (most > 0) histogram_[most / 4] += 1;
  }
  for (float& each : histogram_) each = std::log1p(each);
  return true;
}

bool Desk::settled() const {
  const Artist::Status status = artist_.status();
  return !models_.reading && models_.readings > 0 &&
         (!models_.world || (shown_ && shown_->exact && !status.drawing &&
                             shown_->order.world == models_.world && shown_->order.eye == eye_));
}

bool Desk::idle() const {
  return settled() && playing_.empty() && !saving_.valid() && !filming() && !samples_.busy() &&
         !artist_.status().comparing && compare_ != "flicker";
}

void Desk::drop(const std::vector<std::string>& files) {
  for (const std::string& file : files) project_.add(file);
}

std::optional<std::string> Desk::state(const std::string& name) const {
  const Artist::Status status = artist_.status();
  if (name == "readings") return std::to_string(models_.readings);
  if (name == "failed") return models_.failed ? "true" : "false";
  if (name == "exact") return shown_ && shown_->exact ? "true" : "false";
  if (name == "range") return fmt::format("{}", eye_.range);
  if (name == "fov") return fmt::format("{}", eye_.fov);
  if (name == "selected") return selected_;
  if (name == "layer") return layer_;
  if (name == "compare") return compare_;
  if (name == "edges")
    return std::to_string(shown_ ? std::count(shown_->edges.begin(), shown_->edges.end(), 255) : 0);
  if (name == "reference samples")
    return shown_ && shown_->reference ? std::to_string(shown_->reference_samples) : "";
  if (name == "sample") return samples_.last() ? samples_.last()->name : "";
  if (name == "triangles") {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; shown_ && i < shown_->details.size(); ++i)
      if (shown_->details[i].visible) sum += shown_->details[i].triangles;
    return std::to_string(sum);
  }
  if (name == "white") return std::to_string(saturated_);
  if (name == "limited") return widgets_.limited();
  if (name == "panel") return layout_.panel_shown ? fmt::format("{}", layout_.panel) : "hidden";
  if (name == "hidden") return std::to_string(hidden_.size());
  if (name == "saved") return saved_;
  if (name == "video") return video_.status().words;
  if (name == "edits") return std::to_string(edits_.size());
  if (name == "problem") return status.problem;
  if (name == "targets")
    return std::to_string(models_.world ? models_.world->size() : std::size_t{0});
  if (name == "errors")
    return std::to_string(
        std::count_if(models_.messages.begin(), models_.messages.end(),
                      [](const Message& each) { return each.severity == Severity::error; }));
  if (name == "pixels")
    return shown_ && shown_->image.width > 0
               ? fmt::format("{}x{}", shown_->image.width, shown_->image.height)
               : "";
  if (name.starts_with("pose/")) {
    const auto at = eye_.poses.find(name.substr(5));
    if (at == eye_.poses.end()) return "";
    const Vec3 &p = at->second.position, &t = at->second.turned;
    return fmt::format("{} {} {} {} {} {}", p.x, p.y, p.z, t.x, t.y, t.z);
  }
  if (name.starts_with("joint/")) {
    const auto at = eye_.joints.find(name.substr(6));
    return at == eye_.joints.end() ? "" : at->second;
  }
  return std::nullopt;
}

}  // namespace panwright::studio
