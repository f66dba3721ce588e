// Node matrices and bounds of a world, computed only where it changed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/axis_box.h"
#include "world/world.h"

namespace panwright::world {

// One target, evaluated. All in the model's frame: the pose is applied with the camera's, so that
// their large translations cancel in double before small ones are added.
struct EvaluatedInstance {
  Stamp shape_stamp = 0;                   // of the evaluated state
  std::vector<Mat4> model_from_nodes;      // one per node of the model
  std::vector<std::uint8_t> node_visible;  // 0 or 1, ancestors included
  // Union of the boxes of all visible meshes: not tight. None: nothing is visible.
  std::optional<AxisBox> bounds;
};

// Incremental evaluation of one target: recomputes only nodes below a joint or node that changed.
// The same bits as evaluated().
class InstanceEvaluation {
 public:
  // Cost: O(nodes + meshes placed) comparisons, and a matrix for each node that moved.
  void update(const Instance& instance);
  const EvaluatedInstance& result() const { return result_; }

 private:
  void begin(const Instance& instance);
  bool place(const Instance& instance);
  void bound();

  ModelPtr model_;
  geometry::JointSet joints_;
  std::vector<geometry::JointValues> initial_;
  std::vector<geometry::JointValues> values_;  // of the last update, as resolved
  std::vector<geometry::JointValues> next_;
  std::vector<NodeState> states_;  // of the last update
  std::vector<Mat4> at_rest_;      // parent_from_node of each, its joints at rest
  std::vector<Mat4> local_;        // the same with joints and states
  std::vector<char> moved_;        // by the update
  std::vector<AxisBox> boxes_;     // of each placed mesh, in the model's frame
  EvaluatedInstance result_;
};

// Evaluated state of one world, or of copies of it in turn.
class Evaluation {
 public:
  // Brings everything up to date. Cost: O(targets), and for each whose shape stamp is new that of
  // InstanceEvaluation::update().
  void update(const World& world);

  // Expects: index below the size of the world of the last update.
  const EvaluatedInstance& operator[](std::size_t index) const {
    return instances_[index].result();
  }
  std::size_t size() const { return instances_.size(); }
  Stamp stamp() const { return stamp_; }  // of that world; 0: none yet

 private:
  std::vector<InstanceEvaluation> instances_;
  Stamp stamp_ = 0;
};

// Evaluates one target.
EvaluatedInstance evaluated(const Instance& instance);

// Returns the tight box of a target's visible vertices in its model's frame; nothing when none is
// visible. Cost: O(vertices, meshes counted as often as they are placed).
std::optional<AxisBox> exact_bounds(const Instance& instance);

// Puts a camera into a named frame of a target.
//
// Fails: E5005.
bool place_in_frame(Camera& camera, const World& world, std::size_t index, std::string_view frame,
                    DiagnosticLog& log);

}  // namespace panwright::world
