// Bar below the image: time of a scenario, play and stop.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "studio/window_state.h"
#include "workspace/frame.h"

namespace panwright::studio {

class Player {
 public:
  explicit Player(WindowState& state) : state_(state) {}

  // True: there is a scenario.
  bool shown() const { return state_.models.play != nullptr; }
  void draw(const Vec2& at, const Vec2& size);
  // Goes on while it plays, and sets the moment of the view. After models were read.
  void advance();
  void toggle();          // play or stop
  void step(int frames);  // forwards or, negative, backwards
  bool playing() const { return playing_; }

 private:
  std::uint64_t last() const;  // frame
  void make_moment();
  std::string time_text() const;

  WindowState& state_;
  std::uint64_t number_ = 0;
  bool playing_ = false;
  double start_ = 0;  // seconds of Dear ImGui, at which frame 0 would have been displayed
  double rate_ = 0;   // frames per second, of `start_`
  // of the last moment
  std::shared_ptr<const Play> play_;
  std::shared_ptr<const world::World> world_;
  std::optional<workspace::FrameMaker> maker_;  // of world_
  std::uint64_t made_ = 0;                      // its number
};

}  // namespace panwright::studio
