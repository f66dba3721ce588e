// Follows a script, frame by frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "studio/window.h"

namespace panwright::studio {

class Player {
 public:
  Player(std::vector<Step> steps, std::filesystem::path folder)
      : steps_(std::move(steps)), folder_(std::move(folder)) {}

  // Of the frame that begins.
  const Hand& hand() const { return hand_; }

  // Where no pointer is, whatever the display's own one does.
  static Hand beside_it() {
    Hand hand;
    hand.mouse = Vec2(-1);
    return hand;
  }

  // What the window itself is to do after a frame.
  struct Wish {
    std::optional<Vec2> size;
    std::filesystem::path screenshot;  // empty: none
    bool end = false;
  };
  // After a frame. Reports: E0203 where a step cannot be done.
  Wish next(Desk& desk, DiagnosticLog& log);

  bool good() const { return good_; }

 private:
  bool go(const Step& step, Desk& desk, Wish& wish);  // whether the step is done
  bool press(const Step& step, Desk& desk);
  bool move(const Step& step, Desk& desk);
  bool replace(const Step& step);
  bool expect(const Step& step, Desk& desk);
  void wrong(const std::string& what) { problem_ = what; }
  Vec2 on_image(const Vec2& part, const Desk& desk) const;

  std::vector<Step> steps_;
  std::filesystem::path folder_;
  std::size_t at_ = 0;
  int frame_ = 0;    // of the step
  int missing_ = 0;  // frames in which its widget was not there
  std::string problem_;
  Hand hand_ = beside_it();
  bool good_ = true;
};

}  // namespace panwright::studio
