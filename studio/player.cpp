#include "studio/player.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "studio/imgui_helpers.h"
#include "studio/play.h"

namespace panwright::studio {

std::uint64_t Player::last() const { return state_.models.play->times.size() - 1; }

void Player::toggle() {
  if (!shown()) return;
  playing_ = !playing_;
  if (playing_ && number_ == last()) number_ = 0;
  rate_ = 0;
}

void Player::step(int frames) {
  if (!shown()) return;
  playing_ = false;
  const auto to = static_cast<std::int64_t>(number_) + frames;
  number_ = static_cast<std::uint64_t>(
      std::clamp<std::int64_t>(to, 0, static_cast<std::int64_t>(last())));
}

void Player::advance() {
  if (!shown()) {
    playing_ = false;
    state_.view.moment.reset();
    return;
  }
  number_ = std::min(number_, last());
  if (playing_) {
    const double now = ImGui::GetTime();
    // begun, or at another rate
    if (rate_ != state_.playback.rate) {
      rate_ = state_.playback.rate;
      start_ = now - static_cast<double>(number_) / rate_;
    }
    const double at = std::max(0.0, std::floor((now - start_) * rate_));
    number_ = static_cast<std::uint64_t>(std::min(at, static_cast<double>(last())));
    if (number_ == last()) playing_ = false;
  }
  make_moment();
}

void Player::make_moment() {
  const Project::State& models = state_.models;
  if (play_ == models.play && world_ == models.world && made_ == number_) return;
  const bool first = play_ == nullptr, same_world = world_ == models.world;
  if (!same_world) maker_.emplace(*models.world);
  play_ = models.play;
  world_ = models.world;
  made_ = number_;
  DiagnosticLog log;
  auto moment = moment_of(*play_, number_, *world_, *maker_, log);
  std::vector<Message>& messages = state_.playback.messages;
  messages = messages_of(log);
  if (play_->is_reduced() || (moment && (*moment)->frame.imager != nullptr))
    messages.push_back({Severity::note, "",
                        "frames are displayed at one time and by OpenGL, without motion blur, line "
                        "time and reference engine of the scenario",
                        "", 0, 0});
  // instead of a frame that cannot be displayed, the last one stays
  if (!moment) {
    if (!same_world) state_.view.moment.reset();
    return;
  }
  state_.view.moment = *std::move(moment);
  if (!first) return;
  const auto& ev = *state_.view.moment->view.settings.ev;
  state_.view.auto_ev = !ev.number;
  state_.view.ev = ev.number.value_or(0);
}

std::string Player::time_text() const {
  const Play& play = *state_.models.play;
  std::string out = counted(play.times.size(), "frame");
  if (!play.scenario.sequence.ordered())
    out = fmt::format("{:.9g} s, {}", play.times[number_], out);
  const Moment* moment = state_.view.moment.get();
  if (moment != nullptr && !moment->date.empty()) out += ", " + moment->date;
  return out;
}

void Player::draw(const Vec2& at, const Vec2& size) {
  begin_window("player", at, size, ImGuiWindowFlags_NoScrollbar);
  Widgets& widgets = state_.widgets;
  const auto arrow = [&](const char* name, ImGuiDir way, int frames, const char* help) {
    if (ImGui::ArrowButton(name, way)) step(frames);
    widgets.record(name);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", help);
    ImGui::SameLine();
  };
  // of one width, so that nothing moves
  const ImVec2 wide(ImGui::CalcTextSize("play").x + 4 * ImGui::GetStyle().FramePadding.x, 0);
  if (ImGui::Button(playing_ ? "stop###scenario/play" : "play###scenario/play", wide)) toggle();
  widgets.record("scenario/play");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Play or stop. Space bar");
  ImGui::SameLine();
  arrow("scenario/previous", ImGuiDir_Left, -1, "Previous frame. Left arrow");
  arrow("scenario/next", ImGuiDir_Right, 1, "Next frame. Right arrow");
  const std::string text = time_text();
  const float room = ImGui::GetContentRegionAvail().x;
  const float beside = ImGui::CalcTextSize(text.c_str()).x + ImGui::GetStyle().ItemSpacing.x;
  const float least = 6 * ImGui::GetFontSize();  // of the slider
  const bool fits = room - beside >= least;
  ImGui::SetNextItemWidth(fits ? room - beside : room);
  double number = static_cast<double>(number_);
  if (widgets.slider("scenario/frame=", number, 0, static_cast<double>(last()), "frame %.0f")) {
    playing_ = false;
    number_ = static_cast<std::uint64_t>(std::round(number));
  }
  if (!fits && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text.c_str());
  if (fits) {
    ImGui::SameLine();
    ImGui::TextUnformatted(text.c_str());
  }
  ImGui::End();
}

}  // namespace panwright::studio
