// Diagnostics below the image.
#pragma once

#include <string>
#include <vector>

#include "studio/window_state.h"

namespace panwright::studio {

class MessageList {
 public:
  explicit MessageList(WindowState& state) : state_(state) {}
  void draw(const Vec2& at, const Vec2& size);

 private:
  std::vector<Message> messages() const;
  void row(std::size_t index, const Message& message);
  void open_in_editor(const Message& message);

  WindowState& state_;
  std::string editor_problem_;
};

}  // namespace panwright::studio
