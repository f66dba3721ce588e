// Contents of the window: status bar, panel, messages and image.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "studio/image_view.h"
#include "studio/measure.h"
#include "studio/message_list.h"
#include "studio/panels.h"
#include "studio/player.h"
#include "studio/window_state.h"

namespace panwright::studio {

class MainWindow {
 public:
  explicit MainWindow(const Options& options);

  struct Textures {
    std::uintptr_t image = 0, sample = 0;  // 0: none
  };
  // Draws one frame and handles its input. size: pixels of the window
  void frame(const Vec2& size, double scale, const Textures& textures);
  // Pixels that changed since the last call; null: none.
  const Canvas* new_canvas() { return image_.new_canvas(); }
  const Canvas* new_sample_canvas() { return panels_.materials.new_canvas(); }
  // Times of a saved file, once per file, when the canvas shows it.
  std::optional<SavedToImage> saved_to_image();

  // Value of a name of the script step `expect`; none: unknown name.
  std::optional<std::string> state(const std::string& name) const;
  bool settled() const;         // the image is exact, of the current models and view, or has failed
  std::string failure() const;  // why there is no image of the current view; empty: there is one
  bool saving() const { return panels_.save.saving(); }
  bool recording() const { return panels_.save.recording(); }
  bool playing() const { return player_.playing(); }
  bool sampling() const { return panels_.materials.sampling(); }
  bool idle() const;  // nothing changes without input
  std::string command() const { return panels_.save.command(); }
  Widgets& widgets() { return state_.widgets; }
  const Layout& layout() const { return state_.layout; }
  const RenderThread& renderer() const { return state_.renderer; }
  const Project& project() const { return state_.project; }
  const WidgetRect& image_rect() const { return image_.rect(); }
  // Adds files that were dropped onto the window.
  void drop(const std::vector<std::string>& files);

 private:
  void update_models();
  void status_bar(const Vec2& at, const Vec2& size);
  std::string status_text() const;
  void border(const Vec2& at, const Vec2& size, double scale);
  void handle_keys();
  void request_image();

  WindowState state_;
  Panels panels_;
  ImageView image_;
  Player player_;
  MessageList messages_;
  bool framed_ = false;          // the camera was fitted to the first models
  bool border_dragged_ = false;  // between panel and image
  std::int64_t measured_ = 0;    // Project::State::saved of the last measurement
};

}  // namespace panwright::studio
