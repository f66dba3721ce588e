// Scripts of the window: steps that move the mouse and press keys.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"

namespace panwright::studio {

// Step of a script (docs/studio-scripts.md).
struct Step {
  enum class Kind {
    click,       // a widget
    type,        // a value into a slider or text field, as with Ctrl + click
    drag,        // the mouse over the image
    scroll,      // the wheel over the image
    key,         // a key, by its name
    wait,        // for a state, such as an exact image, or a number of frames
    resize,      // the window
    replace,     // text in a file
    screenshot,  // the window into a PNG
    expect,      // a value of MainWindow::state()
  };
  Kind kind = Kind::wait;
  std::string name;     // of the widget, key, file or state
  std::string value;    // typed, replaced or expected text
  std::string with;     // replacement
  Vec2 from{0}, to{0};  // fractions of the image from its upper left corner; of resize: pixels
  int button = 0;       // 0: left, 1: right, 2: middle
  double amount = 0;    // steps of the wheel; frames of a wait or drag
};

// Reads a script: a JSON list of objects of one member each. Steps of `repeat` are unrolled.
//
// Fails: E0101, E0102, E0104, E0203.
Result<std::vector<Step>> read_script(const std::filesystem::path& path, DiagnosticLog& log);

// State of mouse and keys in a frame of a script.
struct ScriptedInput {
  std::optional<Vec2> mouse;  // pixels of the window; none: unchanged
  bool buttons[3] = {};
  double wheel = 0;
  int key = 0;  // GLFW's; 0: none
  bool control = false;
  std::string typed;
};

}  // namespace panwright::studio
