// Library interface from files to images, shared by the program and other hosts.
//
//   DiagnosticLog log;
//   auto model = workspace::open("cubesat.pxn", {}, log);        // any file as a model
//   world::World world;                                          // any number of targets
//   world.add("cubesat", *model, log);
//   workspace::Frame frame;                                      // one moment
//   frame.instrument = camera;
//   frame.poses = {{"cubesat", pose}};
//   frame.outputs = {"image.exr"};
//   workspace::run_frames(world, {&frame, 1}, {}, log);          // images in files
//
// docs/using-the-library.md has a whole program.
#pragma once

#include "workspace/budget.h"
#include "workspace/drawer.h"
#include "workspace/frame.h"
#include "workspace/joints.h"
#include "workspace/open.h"
#include "workspace/record.h"
#include "workspace/run.h"
#include "workspace/session.h"
#include "workspace/sky_settings.h"
#include "workspace/targets.h"
#include "workspace/views.h"
