// Data sets: frames drawn from distributions, each a view. Syntax of plans: docs/datasets.md.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "workspace/labelling.h"
#include "workspace/session.h"

namespace panwright::workspace {

// Law of one number, or of a choice among values.
struct Distribution {
  enum class Kind { uniform, log_uniform, normal, choice } kind = Kind::uniform;
  double a = 0, b = 0;               // bounds; of normal: mean and standard deviation
  std::vector<std::string> choices;  // JSON of each, equally likely
};

struct NamedRecipe;

// Value of a member of a view whose parts may be drawn.
struct Recipe {
  // JSON of a constant; a law; members in order; those of an object, by name
  std::variant<std::string, Distribution, std::vector<Recipe>, std::vector<NamedRecipe>> of;
};

struct NamedRecipe {
  std::string name;
  Recipe recipe;
};

struct Cone {
  Vec3 axis{0, 0, 1};  // unit, axes of the target
  double within = 0;   // radians
};

// Plan of a data set, as its file has it. Angles in radians.
struct DatasetPlan {
  std::uint32_t frames = 0;
  std::uint64_t seed = 0;
  std::vector<std::pair<std::string, std::string>> targets;  // name; file, relative to the plan's
  std::string view = "{}";                                   // settings of every frame, JSON
  std::vector<std::string> types{"png"};
  std::shared_ptr<const Labelling> labels;  // null: none
  std::string labels_json = "null";         // of it, for records

  std::string target;  // seen by the camera
  Vec3 point{0};       // of it, in its axes, metres
  bool turns = false;  // the target's attitude is drawn, evenly over all rotations
  Distribution range;  // metres from the point
  Cone direction{{0, 0, 1}, kPi};
  std::vector<Cone> keep_out;  // directions without cameras
  double placement = 0;        // share of the image's sides that the point lies within
  Distribution roll{Distribution::Kind::uniform, -kPi, kPi, {}};
  std::array<double, 2> pixels{0, HUGE_VAL};  // of the target's convex outline
  bool has_sun = false;
  Distribution phase;       // angle at the point between Sun and camera; unless even:
  bool even_phase = true;   // evenly by solid angle between phase.a and phase.b
  double sun_keep_out = 0;  // least angle from the boresight
  bool has_lens = false;    // focal lengths and principal point differ from the camera's
  Distribution focal{Distribution::Kind::normal, 1, 0, {}};  // factor
  std::array<Distribution, 2> principal{};                   // pixels right and down
  std::vector<NamedRecipe> sample;                           // members of views

  std::string title;
  std::vector<std::pair<std::string, std::string>> licences;  // of models by target, of the set
  std::vector<std::string> limits;                            // sentences for the data card
};

// Reads a plan (.toml). Fails: E0101, E0102, E0104, E8017.
Result<DatasetPlan> read_dataset_plan(const std::filesystem::path& path, DiagnosticLog& log);

// Geometry of a planned frame, before it is rendered.
struct PlannedFrame {
  std::string view;   // JSON object, on one line
  double range = 0;   // metres from the point
  double phase = 0;   // degrees; NaN: the view's own Sun
  double pixels = 0;  // area of the target's convex outline within the image
  Vec2 place{0};      // of the point, pixels
};

// Frames of a plan. Frame k is a function of plan, seed and k; a law that changes leaves the
// others' numbers as they are.
//
//   folder   of the plan's file
//   session  which opens the targets, with the parameters of the first frame
//   view     of every frame: becomes the settings without those that rows give
//   returns  plan.frames frames
// Fails: E8017 for constraints that leave out every camera; as ViewSession.
Result<std::vector<PlannedFrame>> plan_frames(const DatasetPlan& plan,
                                              const std::filesystem::path& folder,
                                              ViewSession& session, std::string& view,
                                              DiagnosticLog& log, const Job& job = {});

// Reads a row of the table, with the settings of every frame, whose files are relative to `folder`.
// Fails: E0203.
bool read_planned_view(std::string_view row, std::size_t number, const Settings& defaults,
                       View& view, DiagnosticLog& log);
// Reads the settings of every frame. Fails: E0203.
Result<Settings> dataset_settings(const std::string& view,
                                  const std::vector<std::pair<std::string, std::string>>& targets,
                                  const std::filesystem::path& folder, DiagnosticLog& log);

}  // namespace panwright::workspace
