// The tabs of the panel, and what stands over the image.
#include <fcntl.h>
#include <fmt/core.h>
#include <imgui.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "base/text.h"
#include "studio/window.h"
#include "workspace/run.h"
#include "world/evaluation.h"

extern char** environ;

namespace panwright::studio {
namespace {

ImVec2 im(const Vec2& v) { return {static_cast<float>(v.x), static_cast<float>(v.y)}; }

// How a value of a joint is shown.
struct Shown {
  double factor = 1;  // of what is stored
  const char* format = "%.6g";
  double reach = 1;  // of its slider to both sides, where the joint has no limits
};

Shown shown_of(geometry::JointUnit unit) {
  switch (unit) {
    case geometry::JointUnit::radians:
      return {1 / kDegree, "%.3f deg", 180};
    case geometry::JointUnit::metres:
      return {1, "%.4f m", 10};
    case geometry::JointUnit::factor:
      return {1, "%.4f", 4};
  }
  return {};
}

// Of joints of several values.
const char* part_of(geometry::JointKind kind, std::size_t index) {
  constexpr const char* kBall[] = {"about x", "about y", "about z"};
  constexpr const char* kGeneral[] = {"scale x", "scale y", "scale z", "about x", "about y",
                                      "about z", "along x", "along y", "along z"};
  return kind == geometry::JointKind::ball ? kBall[index] : kGeneral[index];
}

}  // namespace

void Desk::camera_tab() {
  widgets_.slider("camera/range", eye_.range, kNearest, kFarthest, "%.6g m", true,
                  "Metres from the point that is looked at. Wheel over the image. Ctrl and a click: type it");
  widgets_.slider("camera/azimuth", eye_.azimuth, -180, 180, "%.3f deg", false,
                  "From +x about +z. Left button over the image");
  widgets_.slider("camera/elevation", eye_.elevation, -89.9, 89.9, "%.3f deg");
  widgets_.slider("camera/field of view", eye_.fov, 0.001, 170, "%.5g deg", true,
                      "Full horizontal angle");
  double pixel = 2e3 * std::tan(eye_.fov * kDegree / 2) / std::max(image_size_.x, 1.0);
  if (widgets_.slider("camera/pixel", pixel, 1e-5, 20, "%.5g mrad", true,
                      "IFOV: the angle of the pixel on the axis"))
    eye_.fov = 2 * std::atan(pixel * 1e-3 * image_size_.x / 2) / kDegree;
  ImGui::TextDisabled(
      "a pixel covers %.4g m at the range",
      2 * eye_.range * std::tan(eye_.fov * kDegree / 2) / std::max(image_size_.x, 1.0));
  for (int k = 0; k < 3; ++k)
    widgets_.drag(fmt::format("camera/look at {}", "xyz"[k]), eye_.centre[k], 1e-3 * eye_.range,
                  "%.6g m", "World axes. Right or middle button over the image");
  if (widgets_.button("camera/all of it", "Key F")) frame_all();
  ImGui::Separator();
  ImGui::TextUnformatted("Camera in a frame of the model");
  if (eye_.frame.empty())
    ImGui::TextDisabled("none: it goes around");
  else if (widgets_.button("camera/leave the frame"))
    eye_.frame.clear();
  for (std::size_t i = 0; models_.world && i < models_.world->size(); ++i) {
    const world::Instance& target = (*models_.world)[i];
    for (std::size_t k = 0; k < target.model()->frames().size(); ++k) {
      const std::string name = target.name() + "/" + std::string(target.model()->frame_name(k));
      if (ImGui::Selectable(name.c_str(), eye_.frame == name)) eye_.frame = name;
      widgets_.seen("frame/" + name);
    }
  }
}

void Desk::sun_tab() {
  widgets_.slider("sun/azimuth", eye_.sun_azimuth, -180, 180, "%.3f deg", false,
                      "Of the direction to the Sun, from +x about +z. Shift and left button over the image");
  widgets_.slider("sun/elevation", eye_.sun_elevation, -90, 90, "%.3f deg");
  widgets_.slider("sun/distance", eye_.sun_distance, 0.05, 50, "%.4g AU", true);
  if (eye_.frame.empty()) ImGui::TextDisabled("phase angle %.3f deg", eye_.phase());
  if (widgets_.button("sun/behind the camera", "Phase angle 0")) {
    eye_.sun_azimuth = eye_.azimuth;
    eye_.sun_elevation = eye_.elevation;
  }
  ImGui::Separator();
  ImGui::TextUnformatted("Exposure");
  double stops = eye_.auto_ev && shown_ ? shown_->ev : eye_.ev;
  if (widgets_.check("exposure/auto", eye_.auto_ev,
                     "99 of 100 lit pixels lie below 0.8 of white, as the exact image has them"))
    eye_.ev = stops;
  ImGui::BeginDisabled(eye_.auto_ev);
  if (widgets_.slider("exposure/stops", stops, -12, 20, "%.3f")) eye_.ev = stops;
  ImGui::EndDisabled();
  if (!histogram_.empty())
    ImGui::PlotHistogram("##histogram", histogram_.data(), static_cast<int>(histogram_.size()), 0,
                         "codes 0 to 255, log of pixels", FLT_MAX, FLT_MAX,
                         {ImGui::GetContentRegionAvail().x, 90});
  ImGui::TextDisabled("%llu pixels at white", static_cast<unsigned long long>(saturated_));
  ImGui::Separator();
  static constexpr const char* kShadows[] = {"auto", "off", "hard", "soft"};
  static constexpr const char* kImposters[] = {"auto", "off", "always"};
  ImGui::TextUnformatted("Shadows, of the exact image");
  widgets_.choice("shadows", eye_.shadows, kShadows, std::size(kShadows));
  ImGui::TextUnformatted("Imposters, of the exact image");
  widgets_.choice("imposters", eye_.imposters, kImposters, std::size(kImposters));
  if (shown_ && shown_->exact) {
    const preview::SamplingReport& report = shown_->sampling;
    ImGui::TextDisabled("error of pixels %.2g %%, of the flux %.2g %%", 100 * report.rmse,
                        100 * report.flux);
    ImGui::TextDisabled("edges of shadows within %.2g pixels", report.shadow_edge);
    ImGui::TextDisabled("penumbra up to %.2g pixels, %u points of the Sun", report.penumbra,
                        report.sun_points);
    for (const preview::ImposterReport& each : report.imposters)
      ImGui::TextDisabled("imposter of %.3g pixels: %u x %u texels, flux within %.2g %%",
                          each.extent, each.width, each.height, 100 * each.flux_error);
  }
}

void Desk::node_row(std::size_t target, std::uint32_t node) {
  const world::Instance& instance = (*models_.world)[target];
  const std::string path = instance.name() + "/" + instance.model()->node_path(node);
  if (!search_.empty() && !holds(path, search_)) return;
  bool visible = !hidden_.count(path);
  ImGui::PushID(path.c_str());
  if (ImGui::Checkbox("##visible", &visible)) {
    if (visible)
      hidden_.erase(path);
    else
      hidden_.insert(path);
  }
  widgets_.seen("visible/" + path);
  ImGui::SameLine();
  std::size_t depth = 0;
  for (std::int32_t up = instance.model()->nodes()[node].parent; up >= 0 && search_.empty();
       up = instance.model()->nodes()[static_cast<std::size_t>(up)].parent)
    ++depth;
  const std::string_view name = instance.model()->node_name(node);
  const std::string label =
      std::string(2 * std::min<std::size_t>(depth, 12), ' ') +
      (node == 0 ? instance.name() : name.empty() ? fmt::format("[{}]", node) : std::string(name));
  if (ImGui::Selectable(label.c_str(), selected_ == path)) selected_ = path;
  widgets_.seen("part/" + path);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", path.c_str());
  ImGui::PopID();
}

void Desk::parts_tab() {
  if (!models_.world) return;
  widgets_.text("parts/search", search_, "part of a name");
  if (!selected_.empty()) {
    ImGui::TextWrapped("%s", selected_.c_str());
    if (widgets_.button("parts/hide", "Key H. Whatever is below it is hidden too"))
      hidden_.insert(selected_);
    ImGui::SameLine();
    if (widgets_.button("parts/isolate", "Hide its siblings, and those of what is around it")) {
      hidden_.clear();
      const auto slash = selected_.find('/');
      const auto target = models_.world->find(selected_.substr(0, slash));
      const std::string path = selected_.substr(slash + 1);
      for (std::uint32_t node = 0;
           target && node < (*models_.world)[*target].model()->nodes().size(); ++node) {
        const std::string other = (*models_.world)[*target].model()->node_path(node);
        const bool around = path == other || path.starts_with(other + "/");
        const auto parent = other.rfind('/');
        if (!around && parent != std::string::npos &&
            (path + "/").starts_with(other.substr(0, parent + 1)))
          hidden_.insert(selected_.substr(0, slash + 1) + other);
      }
    }
    ImGui::SameLine();
  }
  if (widgets_.button("parts/show all")) hidden_.clear();
  widgets_.check("parts/labels of frames", show_labels_, "And of keypoints. Key L");
  ImGui::SameLine();
  widgets_.check("parts/triangles", show_costs_,
                 "Triangles and errors by part, of the exact image, in place of the tree");
  if (widgets_.check("parts/without hidden geometry", prune_,
                     "Of CAD files, as import and compile leave it out: it takes a while. Images "
                     "stay as they are"))
    project_.set_prune(prune_);
  if (show_costs_) return budget_table();
  std::vector<std::pair<std::size_t, std::uint32_t>> rows;
  for (std::size_t i = 0; i < models_.world->size(); ++i)
    for (std::uint32_t node = 0; node < (*models_.world)[i].model()->nodes().size(); ++node)
      rows.emplace_back(i, node);
  ImGui::BeginChild("tree");
  if (search_.empty()) {
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(rows.size()));
    while (clipper.Step())
      for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i)
        node_row(rows[static_cast<std::size_t>(i)].first, rows[static_cast<std::size_t>(i)].second);
  } else {
    for (const auto& [target, node] : rows) node_row(target, node);
  }
  ImGui::EndChild();
}

void Desk::joint_row(std::size_t target, std::size_t index, const geometry::JointValues& now) {
  const world::Instance& instance = (*models_.world)[target];
  const pan::layout::Joint& joint = instance.model()->joints()[index];
  const auto kind = static_cast<geometry::JointKind>(joint.kind);
  const std::size_t count = geometry::value_count(kind);
  const std::string name = instance.name() + "/" + std::string(instance.model()->joint_name(index));
  if (count == 0 || joint.mimic >= 0) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextWrapped("%s: %s%s", name.c_str(), std::string(geometry::kind_name(kind)).c_str(),
                       joint.mimic >= 0 ? ", follows another one" : "");
    ImGui::PopStyleColor();
    return;
  }
  ImGui::TextUnformatted(name.c_str());
  ImGui::PushID(name.c_str());
  for (std::size_t k = 0; k < count; ++k) {
    const Shown shown = shown_of(geometry::unit_of(kind, k));
    const bool limited = joint.upper[k] > joint.lower[k];
    const bool factor = geometry::unit_of(kind, k) == geometry::JointUnit::factor;
    double value = now[k] * shown.factor;
    const double low = limited ? joint.lower[k] * shown.factor : factor ? 0 : -shown.reach;
    const double high = limited ? joint.upper[k] * shown.factor : shown.reach;
    const std::string widget =
        count == 1 ? "joint/" + name + "=" : fmt::format("joint/{}/{}={}", name, k, part_of(kind, k));
    // what has no limits may be typed beyond the slider's ends
    if (widgets_.slider(widget, value, low, high, shown.format, false, nullptr, limited)) {
      geometry::JointValues values = now;
      values[k] = value / shown.factor;
      eye_.joints[name] = workspace::exact_value(kind, values);
      playing_.clear();
    }
  }
  if (count == 1) {
    ImGui::SameLine();
    bool plays = playing_ == name;
    if (widgets_.check("play/" + name + "=play", plays, "Through its range and back in 6 s")) {
      playing_ = plays ? name : "";
      play_start_ = ImGui::GetTime();
    }
    ImGui::SameLine();
  }
  if (widgets_.button("reset/" + name + "=reset")) {
    eye_.joints.erase(name);
    if (playing_ == name) playing_.clear();
  }
  ImGui::PopID();
}

// Where the targets stand.
void Desk::poses() {
  const bool several = models_.world->size() > 1;
  ImGui::SetNextItemOpen(several, ImGuiCond_Once);
  const bool open = ImGui::CollapsingHeader("Poses of targets");
  widgets_.seen("poses");
  if (!open) return;
  for (const world::Instance& target : models_.world->instances()) {
    const std::string& name = target.name();
    Standing place;
    if (const auto at = eye_.poses.find(name); at != eye_.poses.end()) place = at->second;
    const Standing before = place;
    ImGui::TextUnformatted(name.c_str());
    ImGui::SameLine();
    if (widgets_.button("reset/" + name + "/pose=reset", "To the origin")) place = {};
    for (int k = 0; k < 3; ++k)
      widgets_.drag(fmt::format("pose/{}/{}", name, "xyz"[k]), place.position[k], 2e-3 * eye_.range,
                    "%.6g m", "World axes");
    static constexpr const char* kTurns[] = {"roll", "pitch", "yaw"};
    static constexpr const char* kHelp[] = {"About x of the world, first", "About y, second",
                                            "About z, last"};
    for (int k = 0; k < 3; ++k)
      widgets_.slider(fmt::format("pose/{}/{}", name, kTurns[k]), place.turned[k], -180, 180,
                      "%.4f deg", false, kHelp[k]);
    if (place == before) continue;
    if (place == Standing{})
      eye_.poses.erase(name);
    else
      eye_.poses[name] = place;
  }
  if (several && widgets_.button("poses/side by side", "Along +y, a tenth of their sizes apart")) {
    double edge = 0;
    for (std::size_t i = 0; i < models_.world->size(); ++i) {
      const world::Instance& target = (*models_.world)[i];
      const workspace::BoundingSphere sphere = spheres_.of(target);
      Standing& place = eye_.poses[target.name()];
      place = {};
      if (i > 0) place.position.y = edge + 1.1 * sphere.radius - sphere.centre.y;
      edge = place.position.y + sphere.centre.y + 1.1 * sphere.radius;
      if (i == 0) eye_.poses.erase(target.name());
    }
    frame_all();
  }
  ImGui::Separator();
}

void Desk::joints_tab() {
  if (!models_.world) return;
  std::size_t count = 0;
  // values as they are now: with those that follow, within limits
  const world::World posed = this->posed();
  poses();
  for (std::size_t i = 0; i < posed.size(); ++i) {
    const auto values = posed[i].joint_values();
    for (std::size_t k = 0; k < values.size(); ++k, ++count) joint_row(i, k, values[k]);
  }
  if (count == 0) ImGui::TextDisabled("no joints");
  if (count > 0 && widgets_.button("joints/reset all")) {
    eye_.joints.clear();
    playing_.clear();
  }
  if (count > 0 && widgets_.button("joints/copy", "As a JSON object, as --joints reads it")) {
    std::string json = "{";
    for (const auto& [joint, value] : eye_.joints)
      json += fmt::format("{}\n  \"{}\": \"{}\"", json.size() > 1 ? "," : "", joint, value);
    ImGui::SetClipboardText((json + "\n}\n").c_str());
  }
}

void Desk::save_tab() {
  widgets_.text("save/file", output_, "image.png", ".png, .exr, .npy or .npz");
  ImGui::BeginDisabled(saving_.valid() || !models_.world);
  if (widgets_.button("save/save", "What panwright render makes of the command below")) save(output_);
  ImGui::EndDisabled();
  ImGui::TextWrapped("%s", saving_.valid() ? "under way" : saved_.c_str());
  if (!hidden_.empty())
    ImGui::TextWrapped("%s hidden here; files and the command show them.",
                       counted(hidden_.size(), "part").c_str());
  ImGui::Separator();
  const std::string command = this->command();
  if (widgets_.button("save/copy the command")) ImGui::SetClipboardText(command.c_str());
  ImGui::TextWrapped("%s", command.c_str());
  ImGui::Separator();
  video_controls();
}

void Desk::video_controls() {
  const Video::Status status = video_.status();
  const bool joins = !find_program("ffmpeg").empty();
  ImGui::TextUnformatted("Video");
  ImGui::BeginDisabled(status.busy);
  widgets_.choice("video", video_plan_.kind, kVideoKinds, std::size(kVideoKinds),
                  "Once around what is looked at, or to another range in even ratios");
  widgets_.slider("video/frames", video_plan_.frames, 2, 5000, "%.0f");
  widgets_.slider("video/frames a second", video_plan_.rate, 1, 120, "%.0f");
  if (video_plan_.kind == kVideoKinds[1])
    widgets_.slider("video/to range", video_plan_.range, kNearest, kFarthest, "%.6g m", true,
                    "Of the last frame");
  ImGui::TextUnformatted("Each frame");
  widgets_.choice("video frame", video_plan_.frame, kVideoFrames, std::size(kVideoFrames),
                  "As the exact image, or as it is while something moves, with all pixels");
  widgets_.text("video/output", video_plan_.output, "video.mp4",
                ".mp4, .webm, .mkv: as ffmpeg takes it");
  ImGui::EndDisabled();
  if (status.busy) {
    if (widgets_.button("video/cancel")) video_.cancel();
    ImGui::SameLine();
    ImGui::ProgressBar(
        status.of > 0 ? static_cast<float>(status.done) / static_cast<float>(status.of) : 0,
        {-1, 0}, fmt::format("{} of {}", status.done, status.of).c_str());
  } else {
    const bool around = eye_.frame.empty();
    ImGui::BeginDisabled(!models_.world || !shown_ || !around || video_plan_.output.empty());
    if (widgets_.button(joins ? "video/make=make the video" : "video/make=draw the frames",
                        "With the exposure of the image that is shown")) {
      video_plan_.frames = std::round(video_plan_.frames);
      const double ev = eye_.auto_ev ? shown_->ev : eye_.ev;
      const std::filesystem::path path = options_.with_script
                                             ? options_.folder / video_plan_.output
                                             : std::filesystem::path(video_plan_.output);
      video_.make(video_plan_, path, models_.world, video_eyes(eye_, video_plan_, ev),
                  static_cast<std::uint32_t>(image_size_.x),
                  static_cast<std::uint32_t>(image_size_.y), options_.context);
    }
    ImGui::EndDisabled();
    if (!around) ImGui::TextWrapped("The camera is in a frame of the model: leave it for a video.");
  }
  if (!joins)
    ImGui::TextWrapped("Install ffmpeg for a video; without it, frames are written as PNG files.");
  ImGui::TextWrapped("%s", status.words.c_str());
}

std::string Desk::command() const {
  std::string words =
      command_line(eye_, static_cast<std::uint32_t>(image_size_.x),
                   static_cast<std::uint32_t>(image_size_.y), project_.files(), output_);
  // what draws it stands in the file
  if (options_.context == preview::ContextKind::egl) words += " --gl egl";
  if (options_.context == preview::ContextKind::osmesa) words += " --gl osmesa";
  return words;
}

void Desk::save(const std::string& file) {
  const std::filesystem::path path =
      options_.with_script ? options_.folder / file : std::filesystem::path(file);
  workspace::ViewText text = view_text(eye_, static_cast<std::uint32_t>(image_size_.x),
                                       static_cast<std::uint32_t>(image_size_.y));
  text.output = path.string();
  std::vector<std::string> files;
  for (const std::string& each : project_.files())
    files.push_back(workspace::target_file(each).file.string());
  saving_ = std::async(std::launch::async,
                       [text, world = models_.world, path, files = std::move(files),
                        open = options_.open, context = options_.context]() -> std::string {
                         DiagnosticLog log;
                         const auto view = workspace::ViewMaker(*world).view(text, log);
                         const auto draw = workspace::draw_options(text, context, log);
                         if (view && draw) {
                           workspace::RunOptions options{*draw, {}, {files, open}};
                           if (workspace::run_views(*world, std::span(&*view, 1), options, log))
                             return "saved " + path.string();
                         }
                         for (const Message& each : messages_of(log))
                           if (each.severity == Severity::error) return each.text;
                         return "not saved";
                       });
}

void Desk::open_in_editor(const Message& message) {
  if (message.file.empty()) return;
  const char* editor = std::getenv("VISUAL");
  if (editor == nullptr) editor = std::getenv("EDITOR");
  if (editor == nullptr) {
    saved_ = "neither VISUAL nor EDITOR names an editor";
    return;
  }
  // as most editors take a line
  const std::string line =
      fmt::format("exec {} +{} \"$1\" </dev/null", editor, std::max(message.line, 1u));
  const char* words[] = {"sh", "-c", line.c_str(), "sh", message.file.c_str(), nullptr};
  pid_t child = 0;
  ::posix_spawnp(&child, "sh", nullptr, nullptr, const_cast<char* const*>(words), environ);
}

// What is under the mouse, and its surroundings eight times as large.
void Desk::readings(const Vec2& mouse, const Vec2& at, std::uintptr_t texture) {
  if (!shown_ || texture == 0) return;
  const preview::Image& image = shown_->image;
  const Vec2 part = (mouse - at) / image_size_;
  if (part.x < 0 || part.y < 0 || part.x >= 1 || part.y >= 1) return;
  const auto x = static_cast<std::uint32_t>(part.x * image.width);
  const auto y = static_cast<std::uint32_t>(part.y * image.height);
  const std::size_t i = std::size_t{y} * image.width + x;
  ImGui::SetNextWindowBgAlpha(0.85f);
  ImGui::BeginTooltip();
  const double half = 5.5;
  const Vec2 low = (Vec2(x + 0.5, y + 0.5) - half) / Vec2(image.width, image.height);
  const Vec2 high = (Vec2(x + 0.5, y + 0.5) + half) / Vec2(image.width, image.height);
  ImGui::Image(reinterpret_cast<ImTextureID>(texture), {110, 110}, im(low), im(high));
  ImGui::SameLine();
  ImGui::BeginGroup();
  ImGui::Text("pixel %u, %u", x, y);
  ImGui::Text("%.4g %.4g %.4g %s", image.radiance[3 * i], image.radiance[3 * i + 1],
              image.radiance[3 * i + 2], image.unit.c_str());
  ImGui::Text("codes %d %d %d", shown_->rgba[4 * i], shown_->rgba[4 * i + 1],
              shown_->rgba[4 * i + 2]);
  if (!shown_->exact || !image.has_ground_truth()) {
    ImGui::TextDisabled("more once it is exact");
  } else if (image.target_id[i] == 0) {
    ImGui::TextDisabled("background");
  } else {
    const world::Instance& target = (*shown_->order.world)[image.target_id[i] - 1];
    const pan::Model& model = *target.model();
    ImGui::Text("range %.6g m, depth %.6g m", image.range[i], image.depth[i]);
    ImGui::Text("normal %.3f %.3f %.3f", image.normal[3 * i], image.normal[3 * i + 1],
                image.normal[3 * i + 2]);
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + 22 * ImGui::GetFontSize());
    ImGui::TextWrapped("%s/%s", target.name().c_str(),
                       model.node_path(image.node_id[i] - 1).c_str());
    ImGui::PopTextWrapPos();
    ImGui::Text("%s", std::string(model.material_name(image.material_id[i] - 1)).c_str());
  }
  ImGui::EndGroup();
  ImGui::EndTooltip();
}

// Names of frames and keypoints, where they are in the image.
void Desk::labels(const Vec2& at) {
  if (!shown_ || !models_.world) return;
  DiagnosticLog ignored;
  const auto view = workspace::ViewMaker(*models_.world)
                        .view(view_text(eye_, static_cast<std::uint32_t>(image_size_.x),
                                        static_cast<std::uint32_t>(image_size_.y)),
                              ignored);
  if (!view) return;
  world::World posed = *models_.world;
  workspace::show(*view, *models_.world, posed);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const auto label = [&](const Vec3& point, std::string_view name, ImU32 color) {
    const auto pixel = world::project(view->camera, point);
    if (!pixel || pixel->x < 0 || pixel->y < 0 || pixel->x > image_size_.x ||
        pixel->y > image_size_.y)
      return;
    const ImVec2 place = im(at + *pixel);
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
      label(place(model.keypoints()[k].node, model.keypoints()[k].position),
            model.keypoint_name(k), IM_COL32(255, 220, 120, 255));
  }
}

}  // namespace panwright::studio
