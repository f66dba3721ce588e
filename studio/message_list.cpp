#include "studio/message_list.h"

#include <fmt/core.h>
#include <imgui.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "base/text.h"
#include "studio/imgui_helpers.h"

namespace panwright::studio {
namespace {

ImVec4 severity_color(Severity severity) {
  return severity == Severity::error     ? ImVec4(1, 0.6f, 0.2f, 1)
         : severity == Severity::warning ? ImVec4(0.95f, 0.85f, 0.4f, 1)
                                         : ImVec4(0.75f, 0.75f, 0.75f, 1);
}

}  // namespace

void MessageList::draw(const Vec2& at, const Vec2& size) {
  begin_window("messages", at, size);
  const std::vector<Message> all = messages();
  const Project::State& models = state_.models;
  const auto count = [&](Severity severity) {
    return static_cast<std::uint64_t>(std::count_if(
        all.begin(), all.end(), [&](const Message& each) { return each.severity == severity; }));
  };
  if (models.failed) {
    ImGui::PushStyleColor(ImGuiCol_Text, severity_color(Severity::error));
    ImGui::TextWrapped("%s", models.partial ? "The image shows the models that could be read."
                             : models.world ? "The image shows the last version without an error."
                                            : "There is no version without an error yet.");
    ImGui::PopStyleColor();
  }
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  ImGui::TextWrapped("%s, %s, %s; read in %.0f ms, %s watched",
                     counted(count(Severity::error), "error").c_str(),
                     counted(count(Severity::warning), "warning").c_str(),
                     counted(count(Severity::note), "note").c_str(), 1e3 * models.seconds,
                     counted(models.watched.size(), "file").c_str());
  ImGui::PopStyleColor();
  for (std::size_t i = 0; i < all.size(); ++i) row(i, all[i]);
  ImGui::End();
}

void MessageList::row(std::size_t index, const Message& message) {
  const std::string where =
      message.file.empty() ? ""
      : message.line == 0  ? message.file + ": "
                           : fmt::format("{}:{}:{}: ", message.file, message.line, message.column);
  const std::string line =
      fmt::format("{}{}: {}{}", where, severity_word(message.severity), message.text,
                  message.code.empty() ? "" : " [" + message.code + "]");
  const ImVec2 start = ImGui::GetCursorPos();
  const float height =
      ImGui::CalcTextSize(line.c_str(), nullptr, false, ImGui::GetContentRegionAvail().x).y;
  const bool chosen =
      ImGui::Selectable(fmt::format("##message{}", index).c_str(), false, 0, {0, height});
  state_.widgets.record(fmt::format("message/{}", index + 1));
  if (!message.file.empty() && ImGui::IsItemHovered())
    ImGui::SetTooltip("Opens the location in $VISUAL or $EDITOR");
  if (chosen) open_in_editor(message);
  ImGui::SetCursorPos(start);
  ImGui::PushStyleColor(ImGuiCol_Text, severity_color(message.severity));
  ImGui::TextWrapped("%s", line.c_str());
  ImGui::PopStyleColor();
}

std::vector<Message> MessageList::messages() const {
  std::vector<Message> all = state_.models.messages;
  if (!state_.options.layout_problem.empty())
    all.push_back({Severity::note, "", state_.options.layout_problem, "", 0, 0});
  for (const std::string& problem : {editor_problem_, state_.widgets.limited()})
    if (!problem.empty()) all.insert(all.begin(), {Severity::warning, "", problem, "", 0, 0});
  const std::vector<Message>& of_frame = state_.playback.messages;
  if (!state_.models.reading) all.insert(all.end(), of_frame.begin(), of_frame.end());
  if (state_.result && !state_.models.reading)
    all.insert(all.end(), state_.result->messages.begin(), state_.result->messages.end());
  return all;
}

void MessageList::open_in_editor(const Message& message) {
  editor_problem_.clear();
  if (message.file.empty()) return;
  const char* editor = std::getenv("VISUAL");
  if (editor == nullptr) editor = std::getenv("EDITOR");
  if (editor == nullptr) {
    editor_problem_ = "neither VISUAL nor EDITOR names an editor";
    return;
  }
  // most editors take a line so
  const std::string line =
      fmt::format("exec {} +{} \"$1\" </dev/null", editor, std::max(message.line, 1u));
  const char* words[] = {"sh", "-c", line.c_str(), "sh", message.file.c_str(), nullptr};
  pid_t child = 0;
  ::posix_spawnp(&child, "sh", nullptr, nullptr, const_cast<char* const*>(words), environ);
}

}  // namespace panwright::studio
