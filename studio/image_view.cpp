#include "studio/image_view.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "studio/imgui_helpers.h"
#include "studio/play.h"
#include "studio/tracks.h"
#include "workspace/frame.h"
#include "world/evaluation.h"

namespace panwright::studio {
namespace {

constexpr double kFlickerSeconds = 0.6;  // of each of the two images

Histogram histogram_of(const RenderResult& result) {
  Histogram out;
  out.bins.assign(64, 0);
  const bool of_numbers = result.imager != nullptr;
  const std::uint32_t most = of_numbers ? result.imager->detector.most_dn() : 255;
  for (std::size_t i = 0; i < result.image.pixels(); ++i) {
    const std::uint8_t* p = &result.rgba[4 * i];
    const std::uint32_t value = of_numbers ? result.image.dn[i] : std::max({p[0], p[1], p[2]});
    out.saturated += !of_numbers && value == 255;
    if (value > 0) out.bins[std::size_t{64} * value / (most + 1)] += 1;
  }
  if (of_numbers) out.saturated = result.detected.saturated;
  for (float& each : out.bins) each = std::log1p(each);
  out.most = most;
  return out;
}

}  // namespace

bool flicker_shows_reference() {
  return std::fmod(ImGui::GetTime(), 2 * kFlickerSeconds) >= kFlickerSeconds;
}

void ImageView::draw(const Vec2& at, const Vec2& size, std::uintptr_t texture, bool mouse_taken) {
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  begin_window("image", at, size,
               ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  const Vec2 pixels(std::floor(std::max(size.x, 16.0)), std::floor(std::max(size.y, 16.0)));
  state_.image_size = pixels;
  place(at, pixels);
  if (state_.result && texture != 0) {
    ImGui::SetCursorScreenPos(to_imgui(rect_.low));
    ImGui::Image(reinterpret_cast<ImTextureID>(texture), to_imgui(rect_.high - rect_.low));
    if (rect_.high - rect_.low != pixels)
      ImGui::GetWindowDrawList()->AddRect(to_imgui(rect_.low - 1.0), to_imgui(rect_.high + 1.0),
                                          IM_COL32(90, 90, 100, 255));
    draw_tracks();
    draw_caption(at);
  } else {
    ImGui::SetCursorPos({24, 24});
    ImGui::TextDisabled("%s", state_.models.reading ? "reading"
                              : state_.models.world ? "drawing"
                                                    : "nothing to show");
  }
  draw_progress(at, pixels);
  if (ImGui::IsWindowHovered() || dragged_) handle_mouse(mouse_taken);
  if (state_.layout.labels) draw_labels();
  if (ImGui::IsWindowHovered() && !dragged_)
    pixel_values(from_imgui(ImGui::GetIO().MousePos), texture);
  ImGui::End();
  ImGui::PopStyleVar();
}

// Places the image. That of a scenario's camera or of a camera file keeps its shape: a pixel is one
// of the screen or several, or less than one where it would not fit.
void ImageView::place(const Vec2& at, const Vec2& area) {
  Vec2 low = at, size = area;
  const bool sized = state_.result && state_.result->request.view.sized();
  if (sized) {
    const Vec2 pixels(state_.result->request.width, state_.result->request.height);
    const double fit = std::min(area.x / pixels.x, area.y / pixels.y);
    size = glm::max(glm::floor(pixels * (fit >= 1 ? std::floor(fit) : fit)), Vec2(1));
    low = glm::floor(at + 0.5 * (area - size));
  }
  state_.widgets.record("image", low, low + size);
  rect_ = *state_.widgets.find("image");
}

// Lines over the image from outside.
void ImageView::draw_tracks() const {
  const ViewState& view = state_.result->request.view;
  if (!state_.playback.tracks || !state_.models.play || !view.moment || view.own() != nullptr)
    return;
  DiagnosticLog ignored;
  const RenderRequest& request = state_.result->request;
  const auto frame = state_.maker_of(request.world)
                         .frame(settings_of(view, request.width, request.height), ignored);
  if (!frame) return;
  const Vec3 centre = workspace::BoundingSpheres(state_.spheres).of(state_.posed()).centre;
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (const TrackLine& line :
       track_lines(frame->camera(), *state_.models.play, *view.moment, centre)) {
    using Kind = TrackLine::Kind;
    const ImU32 color = line.kind == Kind::past     ? IM_COL32(255, 176, 60, 255)
                        : line.kind == Kind::future ? IM_COL32(255, 176, 60, 110)
                        : line.kind == Kind::target ? IM_COL32(120, 220, 130, 200)
                                                    : IM_COL32(110, 190, 255, 230);
    const bool track = line.kind != Kind::field_of_view;
    list->AddLine(to_imgui(rect_.low + line.from), to_imgui(rect_.low + line.to), color,
                  track ? 2.0f : 1.2f);
  }
  if (const auto at = world::project(frame->camera(), view.moment->frame.camera().position))
    if (at->x >= 0 && at->y >= 0 && at->x < request.width && at->y < request.height)
      list->AddCircleFilled(to_imgui(rect_.low + *at), 4, IM_COL32(110, 190, 255, 255));
}

// A bar that moves along the upper edge while an image is being drawn, with the time so far.
void ImageView::draw_progress(const Vec2& at, const Vec2& size) {
  constexpr double kAfter = 0.3;  // seconds: shorter work shows nothing
  constexpr double kPeriod = 1.6;
  const double now = ImGui::GetTime();
  const bool drawing = state_.models.world && state_.renderer.status().drawing;
  if (!drawing) drawing_since_ = now;
  const double seconds = now - drawing_since_;
  if (!drawing || seconds < kAfter) return;
  const double height = std::max(3.0, 0.2 * ImGui::GetFontSize()), share = 0.25;
  const double phase = std::fabs(2 * std::fmod(seconds / kPeriod, 1.0) - 1);
  const double left = at.x + (1 - share) * phase * size.x;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(to_imgui(at), to_imgui(at + Vec2(size.x, height)), IM_COL32(30, 50, 80, 160));
  list.AddRectFilled(to_imgui({left, at.y}), to_imgui({left + share * size.x, at.y + height}),
                     IM_COL32(102, 179, 255, 255));
  const std::string text = fmt::format("drawing, {:.1f} s", seconds);
  const Vec2 wide(ImGui::CalcTextSize(text.c_str()).x + 12, 0);
  list.AddText(to_imgui(at + Vec2(size.x, height + 4) - wide), IM_COL32(200, 215, 235, 255),
               text.c_str());
}

const Canvas* ImageView::new_canvas() {
  const bool changed = take_result();
  if (!state_.result || state_.result->rgba.empty()) return nullptr;
  const ImageSettings& image = state_.image;
  const std::string settings =
      fmt::format("{} {} {} {} {} {}", state_.layout.layer, state_.layout.mark_white,
                  image.comparison, image.split, image.difference_range,
                  image.comparison == "flicker" && flicker_shows_reference());
  if (!changed && settings == painted_as_) return nullptr;
  painted_as_ = settings;
  paint();
  return &canvas_;
}

bool ImageView::take_result() {
  std::shared_ptr<const RenderResult> made = state_.renderer.take();
  if (!made) return false;
  auto& result = state_.result;
  if (made->failed) {
    // the last image stays, with the new messages
    auto both = std::make_shared<RenderResult>(result ? *result : *made);
    both->messages = made->messages;
    both->request = made->request;
    both->exact = made->exact;
    both->failed = true;
    result = both;
    return false;
  }
  result = std::move(made);
  state_.histogram = histogram_of(*result);
  return true;
}

void ImageView::paint() {
  const RenderResult& result = *state_.result;
  const ImageSettings& image = state_.image;
  const std::string& layer = state_.layout.layer;
  Pixels& scale = state_.color_scale;
  canvas_.width = result.image.width;
  canvas_.height = result.image.height;
  canvas_.smooth =
      canvas_.width < result.request.width || canvas_.width > rect_.high.x - rect_.low.x;
  scale = {};
  if (image.comparison == "difference" && result.reference) {
    scale = difference_pixels(result.image, result.reference->image, result.comparison.rms,
                              image.difference_range);
    canvas_.rgba = std::move(scale.rgba);
  } else if (layer != "light" && (layer == "false colours" || result.image.has_ground_truth())) {
    scale = layer == "levels" ? level_pixels(result.image, result.details)
                              : layer_pixels(result.image, layer);
    canvas_.rgba = std::move(scale.rgba);
  } else {
    canvas_.rgba = result.rgba;
  }
  paint_reference();
  paint_edges();
  if (!state_.layout.mark_white || layer != "light" || image.comparison == "difference") return;
  if (result.imager != nullptr)
    mark_pixels(canvas_.width,
                saturated_pixels(result.imager->detector, result.image.dn, result.image.electrons),
                canvas_.rgba);
  else
    mark_white(canvas_.width, canvas_.rgba);
}

// The reference image over the right part, or all of it.
void ImageView::paint_reference() {
  const RenderResult& result = *state_.result;
  const ImageSettings& image = state_.image;
  const std::string& layer = state_.layout.layer;
  const bool split = image.comparison == "split", flicker = image.comparison == "flicker";
  if (!(split || flicker) || !result.reference) return;
  if (layer != "light" && layer != "false colours") return;
  const image::Image& reference = result.reference->image;
  const std::vector<std::uint8_t> other = layer == "light" ? srgb_pixels(reference, result.exposure)
                                                           : layer_pixels(reference, layer).rgba;
  const std::size_t width = canvas_.width;
  const std::size_t from = flicker ? (flicker_shows_reference() ? 0 : width)
                                   : static_cast<std::size_t>(image.split * canvas_.width);
  for (std::size_t y = 0; y < canvas_.height; ++y) {
    for (std::size_t x = from; x < width; ++x)
      std::copy_n(&other[4 * (y * width + x)], 4, &canvas_.rgba[4 * (y * width + x)]);
    if (split && from > 0 && from < width) {
      std::uint8_t* line = &canvas_.rgba[4 * (y * width + from)];
      line[0] = line[1] = line[2] = 160;
    }
  }
}

void ImageView::paint_edges() {
  const RenderResult& result = *state_.result;
  if (result.edges.size() != result.image.pixels()) return;
  constexpr std::uint8_t kLine[] = {0, 220, 220};
  for (std::size_t i = 0; i < result.edges.size(); ++i) {
    std::uint8_t* p = &canvas_.rgba[4 * i];
    for (std::size_t k = 0; k < 3 && result.edges[i] != 0; ++k)
      p[k] = static_cast<std::uint8_t>((p[k] + kLine[k]) / 2);
  }
}

// Content of the canvas, where it is not the light that is saved.
std::string ImageView::caption() const {
  const RenderResult* result = state_.result.get();
  if (result == nullptr || result->rgba.empty()) return "";
  const ImageSettings& image = state_.image;
  if (image.comparison == "difference" && result->reference)
    return fmt::format("preview - reference: blue {:.3g} %, orange +{:.3g} % of the RMS radiance",
                       -100 * image.difference_range, 100 * image.difference_range);
  std::string out = state_.layout.layer == "light" ? "" : state_.layout.layer;
  if ((image.comparison == "split" || image.comparison == "flicker") && result->reference)
    out += (out.empty() ? "" : ", ") + std::string(image.comparison == "split"
                                                       ? "left preview, right reference"
                                                   : flicker_shows_reference() ? "reference"
                                                                               : "preview");
  return out;
}

void ImageView::draw_caption(const Vec2& at) const {
  const std::string text = caption();
  if (text.empty()) return;
  const ImVec2 place = to_imgui(at + Vec2(10, 8)), size = ImGui::CalcTextSize(text.c_str());
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled({place.x - 4, place.y - 2}, {place.x + size.x + 4, place.y + size.y + 2},
                      IM_COL32(0, 0, 0, 170));
  list->AddText(place, IM_COL32(230, 230, 230, 255), text.c_str());
}

void ImageView::handle_mouse(bool mouse_taken) {
  const ImGuiIO& io = ImGui::GetIO();
  const Vec2 way = from_imgui(io.MouseDelta) / state_.image_size.y;
  const bool any = ImGui::IsMouseDown(0) || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2);
  if (ImGui::IsWindowHovered() && any && !mouse_taken) dragged_ = true;
  if (!any) {
    // a click without movement selects
    const ImVec2 from = io.MouseClickedPos[0];
    if (dragged_ && ImGui::IsMouseReleased(0) && state_.result && state_.result->exact &&
        std::hypot(io.MousePos.x - from.x, io.MousePos.y - from.y) < 3)
      select_part();
    dragged_ = false;
  }
  // the scenario moves its camera
  if (state_.view.own() != nullptr) return;
  OrbitCamera& camera = state_.view.camera;
  if (dragged_ && (way.x != 0 || way.y != 0)) {
    camera.frame.clear();
    if (ImGui::IsMouseDown(0) && io.KeyShift && !state_.view.moment)
      state_.view.turn_sun(way.x, way.y);
    else if (ImGui::IsMouseDown(0))
      camera.turn(way.x, way.y);
    else
      camera.shift(way.x, way.y);
  }
  if (io.MouseWheel != 0) camera.zoom(std::pow(1.15, -io.MouseWheel));
}

// The place of the mouse in parts of the image's sides; none: beside it.
std::optional<Vec2> ImageView::image_part(const Vec2& mouse) const {
  const Vec2 part = (mouse - rect_.low) / (rect_.high - rect_.low);
  if (part.x < 0 || part.y < 0 || part.x >= 1 || part.y >= 1) return std::nullopt;
  return part;
}

void ImageView::select_part() {
  const RenderResult& result = *state_.result;
  const image::Image& image = result.image;
  std::string& selected = state_.parts.selected;
  selected.clear();
  const auto part = image_part(from_imgui(ImGui::GetIO().MousePos));
  if (!part || !image.has_ground_truth()) return;
  const auto x = static_cast<std::size_t>(part->x * image.width);
  const auto y = static_cast<std::size_t>(part->y * image.height);
  const std::size_t i = y * image.width + x;
  if (image.target_id[i] == 0) return;
  const world::Instance& target = (*result.request.world)[image.target_id[i] - 1];
  selected = target.name() + "/" + target.model()->node_path(image.node_id[i] - 1);
}

// The pixel under the mouse, and its surroundings magnified.
void ImageView::pixel_values(const Vec2& mouse, std::uintptr_t texture) const {
  if (!state_.result || texture == 0) return;
  const RenderResult& result = *state_.result;
  const image::Image& image = result.image;
  const auto part = image_part(mouse);
  if (!part) return;
  const auto x = static_cast<std::uint32_t>(part->x * image.width);
  const auto y = static_cast<std::uint32_t>(part->y * image.height);
  const std::size_t i = std::size_t{y} * image.width + x;
  ImGui::SetNextWindowBgAlpha(0.85f);
  ImGui::BeginTooltip();
  const double half = 5.5;
  const Vec2 low = (Vec2(x + 0.5, y + 0.5) - half) / Vec2(image.width, image.height);
  const Vec2 high = (Vec2(x + 0.5, y + 0.5) + half) / Vec2(image.width, image.height);
  ImGui::Image(reinterpret_cast<ImTextureID>(texture), {110, 110}, to_imgui(low), to_imgui(high));
  ImGui::SameLine();
  ImGui::BeginGroup();
  ImGui::Text("pixel %u, %u", x, y);
  ImGui::Text("%.4g %.4g %.4g %s", image.radiance[3 * i], image.radiance[3 * i + 1],
              image.radiance[3 * i + 2], image.unit.c_str());
  if (result.imager != nullptr)
    ImGui::Text("number %d of %u, %.5g electrons", image.dn[i], result.imager->detector.most_dn(),
                image.electrons[i]);
  else
    ImGui::Text("codes %d %d %d", result.rgba[4 * i], result.rgba[4 * i + 1],
                result.rgba[4 * i + 2]);
  if (!result.exact || !image.has_ground_truth()) {
    ImGui::TextDisabled("more once the image is exact");
  } else if (image.target_id[i] == 0) {
    ImGui::TextDisabled("background");
  } else {
    const world::Instance& target = (*result.request.world)[image.target_id[i] - 1];
    const pan::Model& model = *target.model();
    ImGui::Text("range %.6g m, depth %.6g m", image.range[i], image.depth[i]);
    ImGui::Text("normal %.3f %.3f %.3f", image.normal[3 * i], image.normal[3 * i + 1],
                image.normal[3 * i + 2]);
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + 22 * ImGui::GetFontSize());
    ImGui::TextWrapped("%s/%s", target.name().c_str(),
                       model.node_path(image.node_id[i] - 1).c_str());
    ImGui::PopTextWrapPos();
    const std::uint32_t material = image.material_id[i];  // 0: of terrain
    ImGui::Text("%s",
                material > 0 ? std::string(model.material_name(material - 1)).c_str() : "terrain");
  }
  ImGui::EndGroup();
  ImGui::EndTooltip();
}

// Names of frames and keypoints at their positions.
void ImageView::draw_labels() const {
  if (!state_.result || !state_.models.world) return;
  DiagnosticLog ignored;
  world::Camera camera;
  if (const Moment* own = state_.view.own()) {
    camera = own->frame.camera();
  } else {
    const auto frame = state_.maker_of(state_.models.world).frame(state_.settings(), ignored);
    if (!frame) return;
    camera = frame->camera();
  }
  const world::World posed = state_.posed();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const Vec2 size(camera.width, camera.height), scale = (rect_.high - rect_.low) / size;
  const auto label = [&](const Vec3& point, std::string_view name, ImU32 color) {
    const auto pixel = world::project(camera, point);
    if (!pixel || pixel->x < 0 || pixel->y < 0 || pixel->x > size.x || pixel->y > size.y) return;
    const ImVec2 place = to_imgui(rect_.low + scale * *pixel);
    draw->AddCircle(place, 3, color);
    draw->AddText({place.x + 6, place.y - 8}, color, name.data(), name.data() + name.size());
  };
  for (const world::Instance& target : posed.instances()) {
    const auto state = world::evaluated(target);
    const Mat4 world_from_model = target.pose().matrix();
    const auto place = [&](std::uint32_t node, const double* p) {
      return Vec3(world_from_model * state.model_from_nodes[node] * Vec4(p[0], p[1], p[2], 1));
    };
    const pan::Model& model = *target.model();
    for (std::size_t k = 0; k < model.frames().size(); ++k)
      label(place(model.frames()[k].node, model.frames()[k].origin), model.frame_name(k),
            IM_COL32(120, 200, 255, 255));
    for (std::size_t k = 0; k < model.keypoints().size(); ++k)
      label(place(model.keypoints()[k].node, model.keypoints()[k].position), model.keypoint_name(k),
            IM_COL32(255, 220, 120, 255));
  }
}

}  // namespace panwright::studio
