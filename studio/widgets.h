// Widgets of the window that remember where they are, so that a script can use them as a hand does.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "base/math.h"

struct ImVec4;

namespace panwright::studio {

// Where things of the last frame are, in pixels of the window.
struct Place {
  Vec2 low{0};
  Vec2 high{0};
  std::uint64_t frame = 0;
};

// Whether a name has a text in it, in capitals or not.
bool holds(std::string_view name, std::string_view wanted);

class Widgets {
 public:
  void begin_frame() { ++frame_; }
  // The widget that was made last is called so.
  void seen(const std::string& name);
  void seen(const std::string& name, const Vec2& low, const Vec2& high);
  // null: it is not in the last frame
  const Place* find(const std::string& name) const;
  std::string nearest(const std::string& name) const;

  // Each returns whether the value changed. name: what scripts call it; what is shown stands behind
  // its last '/', or behind a '=' at its end. help: shown when the mouse rests on it.
  bool button(const std::string& name, const char* help = nullptr);
  bool check(const std::string& name, bool& value, const char* help = nullptr);
  // format: printf's, with its unit; not bounded: numbers beyond may be typed
  bool slider(const std::string& name, double& value, double low, double high, const char* format,
              bool logarithmic = false, const char* help = nullptr, bool bounded = true);
  bool drag(const std::string& name, double& value, double step, const char* format,
            const char* help = nullptr);
  bool choice(const std::string& name, std::string& value, const char* const* words,
              std::size_t count, const char* help = nullptr);
  bool text(const std::string& name, std::string& value, const char* hint,
            const char* help = nullptr);

  // What was typed last, where it was out of range; empty: it was not, or something else was
  // changed since.
  const std::string& limited() const { return limited_; }

  // Words beside the panel while the mouse is over what was drawn last.
  void tip(const char* help);

 private:
  void explain(const std::string& name, const char* help);
  std::map<std::string, Place> places_;
  std::uint64_t frame_ = 0;
  std::string limited_;
};

}  // namespace panwright::studio
