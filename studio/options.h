// Options of the window.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "preview/context.h"
#include "studio/layout.h"
#include "studio/script.h"
#include "workspace/targets.h"

namespace panwright::studio {

struct Options {
  std::vector<std::string> files;  // FILE or NAME=FILE; one may be a scenario
  std::string owner;               // of a trajectory alone: as of open_play()
  std::string camera_file;         // size, lens and detector of the image; empty: none
  workspace::OpenOptions open;
  preview::ContextKind context = preview::ContextKind::automatic;  // of the render thread
  Layout layout;                                                   // initial
  std::filesystem::path layout_file;  // written at the end; empty: not written
  std::string layout_problem;         // reported in the window
  double scale = 0;                   // of text and widgets; 0: that of the screen
  std::vector<Step> script;
  std::filesystem::path script_folder;  // paths of the script are relative to it
  bool scripted = false;                // the window follows the script and closes at its end
};

}  // namespace panwright::studio
