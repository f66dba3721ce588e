// What a script does in the window in place of a hand: it moves the mouse and presses keys.
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

// One step of a script, as docs/studio-scripts.md has it.
struct Step {
  enum class Kind {
    click,       // a widget
    type,        // a value into a slider or field of numbers: as with Ctrl and a click
    drag,        // the mouse over the image, from place to place
    scroll,      // the wheel over the image
    key,         // a key, by its name
    wait,        // until the image is exact, the models are read, the file is saved, or for frames
    resize,      // the window
    replace,     // text in a file, as an editor does
    screenshot,  // the window into a PNG
    expect,      // something of the state: see Window::state()
  };
  Kind kind = Kind::wait;
  std::string name;   // of the widget, key, file, or what is waited for or expected
  std::string value;  // typed; what is replaced; what is expected
  std::string with;   // what it is replaced with
  Vec2 from{0}, to{0};  // parts of the image's sides from its upper left; of resize: pixels
  int button = 0;       // 0: left, 1: right, 2: middle
  double amount = 0;    // of the wheel; frames, of a drag those of its way
};

// Reads a script: a JSON list of objects of one member each. Steps of `repeat` stand there as often
// as they are done.
//
// Fails: E0101, E0102, E0104, E0203.
Result<std::vector<Step>> read_script(const std::filesystem::path& path, DiagnosticLog& log);

// How the mouse and keys are to be in a frame. Nothing: as they are.
struct Hand {
  std::optional<Vec2> mouse;  // pixels of the window
  bool buttons[3] = {};
  double wheel = 0;
  int key = 0;  // GLFW's; 0: none
  bool control = false;
  std::string typed;
};

}  // namespace panwright::studio
