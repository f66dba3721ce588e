// Rendered image in the window, with its mouse control, pixel values and labels.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "studio/window_state.h"

namespace panwright::studio {

class ImageView {
 public:
  explicit ImageView(WindowState& state) : state_(state) {}

  // size: of the area for it. mouse_taken: by something else, such as the border of the panel
  void draw(const Vec2& at, const Vec2& size, std::uintptr_t texture, bool mouse_taken);
  // Pixels of the newest result with the current settings, where they changed; null: they did not.
  const Canvas* new_canvas();
  bool dragged() const { return dragged_; }
  const WidgetRect& rect() const { return rect_; }

 private:
  bool take_result();
  void paint();
  void paint_reference();
  void paint_edges();
  std::string caption() const;
  void draw_caption(const Vec2& at) const;
  void place(const Vec2& at, const Vec2& area);
  void handle_mouse(bool mouse_taken);
  void select_part();
  std::optional<Vec2> image_part(const Vec2& mouse) const;
  void pixel_values(const Vec2& mouse, std::uintptr_t texture) const;
  void draw_tracks() const;
  void draw_labels() const;
  void draw_progress(const Vec2& at, const Vec2& size);

  WindowState& state_;
  Canvas canvas_;
  std::string painted_as_;    // settings of the canvas
  double drawing_since_ = 0;  // seconds; the last time without an image under way
  WidgetRect rect_;           // of the image: of a scenario's camera, a part of the area
  bool dragged_ = false;
};

// Of the comparison "flicker": whether the reference is displayed now.
bool flicker_shows_reference();

}  // namespace panwright::studio
