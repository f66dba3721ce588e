// Widgets of the window, which record their positions for scripts.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "base/math.h"

struct ImVec4;

namespace panwright::studio {

// Position of a widget, in pixels of the window.
struct WidgetRect {
  Vec2 low{0};
  Vec2 high{0};
  std::uint64_t frame = 0;  // in which it was drawn last
};

// Returns true where `text` contains `part`; case is ignored.
bool contains_text(std::string_view text, std::string_view part);

class Widgets {
 public:
  void begin_frame() { ++frame_; }
  // Records the position of the last widget under a name.
  void record(const std::string& name);
  void record(const std::string& name, const Vec2& low, const Vec2& high);
  // null: not in the last frame
  const WidgetRect* find(const std::string& name) const;
  // Most similar name in the last frame; empty: none is similar.
  std::string nearest(const std::string& name) const;

  // Each returns whether the value changed, or the button was pressed. name: in scripts; the label
  // is the part after the last '/', or after a '=', which is not part of the name. help: tooltip
  bool button(const std::string& name, const char* help = nullptr);
  bool check(const std::string& name, bool& value, const char* help = nullptr);
  // format: of printf, with the unit; bounded: typed values are clamped
  bool slider(const std::string& name, double& value, double low, double high, const char* format,
              bool logarithmic = false, const char* help = nullptr, bool bounded = true);
  bool drag(const std::string& name, double& value, double step, const char* format,
            const char* help = nullptr);
  // words: the values, each with an optional label after a '='
  bool choice(const std::string& name, std::string& value, const char* const* words,
              std::size_t count, const char* help = nullptr);
  bool text(const std::string& name, std::string& value, const char* hint,
            const char* help = nullptr);

  // Message about the last typed value where it was clamped; empty: it was not.
  const std::string& limited() const { return limited_; }

  // Text beside the panel while the mouse is over the last widget.
  void tooltip(const char* help);

 private:
  void finish(const std::string& name, const char* help);
  std::map<std::string, WidgetRect> rects_;
  std::uint64_t frame_ = 0;
  std::string limited_;
};

}  // namespace panwright::studio
