// Runner of scripts, frame by frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "studio/main_window.h"
#include "studio/script.h"

namespace panwright::studio {

class ScriptRunner {
 public:
  ScriptRunner(std::vector<Step> steps, std::filesystem::path folder)
      : steps_(std::move(steps)), folder_(std::move(folder)) {}

  // Input of the frame that begins.
  const ScriptedInput& input() const { return input_; }

  // Actions on the window after a frame.
  struct Actions {
    std::optional<Vec2> size;
    std::filesystem::path screenshot;  // empty: none
    bool end = false;                  // of the script
  };
  // Advances the script after a frame. Reports: E0203 where a step fails.
  Actions next(MainWindow& window, DiagnosticLog& log);

  bool ok() const { return ok_; }

 private:
  static ScriptedInput outside() {  // of the window, wherever the pointer of the display is
    ScriptedInput input;
    input.mouse = Vec2(-1);
    return input;
  }
  bool advance(const Step& step, MainWindow& window, Actions& actions);  // true: the step is done
  bool press(const Step& step, MainWindow& window);
  bool move(const Step& step, MainWindow& window);
  bool replace(const Step& step);
  bool expect(const Step& step, MainWindow& window);
  bool wait(const Step& step, MainWindow& window);
  void fail(const std::string& problem) { problem_ = problem; }
  Vec2 on_image(const Vec2& part, const MainWindow& window) const;

  std::vector<Step> steps_;
  std::filesystem::path folder_;
  std::size_t at_ = 0;
  int frame_ = 0;    // of the step
  int missing_ = 0;  // frames without its widget
  std::string problem_;
  ScriptedInput input_ = outside();
  bool ok_ = true;
};

}  // namespace panwright::studio
