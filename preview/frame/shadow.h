// Shadow maps of a world's targets. Private to preview.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "preview/context.h"
#include "preview/frame/caster_draws.h"
#include "preview/frame/frame_scene.h"
#include "preview/frame/light_space.h"
#include "preview/frame/light_view.h"
#include "preview/frame/shadow_tiles.h"
#include "preview/frame/sun_points.h"
#include "preview/frame/target_states.h"
#include "preview/gl/gl_objects.h"
#include "preview/gl/programs.h"
#include "preview/model/draw_list.h"

namespace panwright::preview {

// Returns a pose relative to another one: anchor_from_model of two world_from_model.
world::Pose relative_pose(const world::Pose& anchor, const world::Pose& model);

// Shadow maps: depths and slopes of the surfaces towards the Sun. A surface shadows a point if each
// lies on the far side of the other's plane (shaders/shadow.glsl), so surfaces shadow neither
// themselves nor their neighbours. Only an offset for relief finer than texels, 0.7 of one, moves
// shadows away from contacts.
//
// Each visible target has a map, fitted to it alone; other targets that may shadow it are drawn
// into it. Their parts sunward of the map's box are clamped to its border (depth clamp), where they
// occlude all below. Beyond the bound on memory neighbours share maps.
//
// If the texels of such a map are too wide for the pixels of the target (a wide model, a camera
// close by), the map consists of tiles that follow the view (shadow_tiles.h). Each holds all
// casters in its column towards the Sun.
//
// For a penumbra that may be wider than half a pixel, the map has layers of hard shadows for
// several points of the Sun's disc. They are sheared, so that one place in light space serves all
// (shaders/shadow.glsl). The visible share of the disc is the mean over them, for any combination
// of occluders.
class ShadowMaps {
 public:
  // Draws the missing maps. A map is kept while its receivers' shapes, the Sun in their frame, and
  // the shapes and relative poses of its casters stay the same. Expects the state left by
  // Renderer::Impl::set_state().
  //
  // Expects: targets in view.
  // Reports: W5012. Fails: E0001; E5003; E5001 when the driver refuses a shader.
  struct Limits {
    unsigned side = 2048;       // texels of a map or a cell of one, > 4; the context may have less
    unsigned soft_side = 2048;  // the same if the Sun has more than 8 points
    std::uint64_t bytes = 0;
    SunDisc disc;
  };
  bool update(Device::Impl& device, const FrameScene& scene, const Limits& limits,
              DiagnosticLog& log, const Job& job);

  // Begins another image, whose maps take precedence over older ones.
  void begin_image() { image_ = update_ + 1; }

  // Sets the map of a view. receiver: into those of the last update.
  void add_to(LightView& view, std::size_t receiver, const Mat4& model_from_sample) const;

  // Frees all maps: the next update redraws them.
  void forget() { maps_.clear(); }

  std::uint64_t drawn() const { return drawn_; }  // maps drawn so far

  // Of the last update: largest error of shadow edges, pixels (99 of 100 are nearer,
  // bench/case_shadows.cpp).
  double edge_error() const { return edge_error_; }

  // Of the last update: the widest possible penumbra, pixels, and the fewest points of the Sun's
  // disc used for it.
  double penumbra() const { return penumbra_; }
  unsigned disc_points() const { return disc_points_; }

  static constexpr std::uint64_t kTexelBytes = 8;

 private:
  // State of a target in a map, and its place.
  struct Member {
    world::Stamp shape_stamp = 0;
    std::size_t level = 0;  // TargetState::level
    world::Pose anchor_from_model;
    bool operator==(const Member&) const = default;
  };
  // Inputs of tiles besides the targets.
  struct ViewKey {
    Mat4 camera_from_model{1};  // of the anchor
    Vec2 focal{0};
    Vec2 principal{0};
    Vec2 size{0};  // pixels
    world::Projection projection = world::Projection::perspective;
    std::size_t cells = 0;  // at most
    unsigned side = 0;      // texels of one
    unsigned soft_side = 0;
    double pixel = 1;  // of the image, in those of the camera
    bool operator==(const ViewKey&) const = default;
  };
  // Layout of a map.
  struct Layout {
    LightSpace bare;       // fitted to the receivers
    LightSpace whole;      // the same, or wider for several points of the Sun
    unsigned points = 1;   // of the Sun's disc
    double penumbra = 0;   // the widest possible, pixels
    bool eclipse = false;  // it is wider than the receivers
    ViewKey view;
    ShadowTiles tiles;  // for this view
    double texel = 0;   // the coarsest relative to its pixel, metres
    double pixel = 0;
    double finest = 0;  // limit of single precision there
  };
  struct Map {
    // contents
    Vec3 to_sun{0};  // of the anchor's frame, unit
    std::vector<Member> receivers;
    std::vector<Member> casters;
    Layout layout;
    bool drawn = false;
    std::uint64_t last_use = 0;  // number of an update
    std::size_t columns = 0;     // cells of its textures; 0: none
    std::size_t rows = 0;
    std::uint64_t texels = 0;  // of these, all layers
    MapLayers layers;          // one for each point of the Sun's disc
    std::vector<Vec2> points;  // these
  };
  // Target, placed in the frame of a map's anchor.
  struct Drawn {
    std::uint32_t target = 0;
    bool anchor = false;
    bool caster = false;  // and no receiver
    Member member;
  };
  struct Place {
    Mat4 anchor_from_model{1};
    std::size_t map = 0;
  };

  static constexpr std::size_t kNone = ~std::size_t{0};
  // Receivers of one map.
  struct Group {
    std::vector<std::uint32_t> receivers;  // into those of the update
    std::vector<Drawn> targets;            // the same
    std::vector<Member> members;           // the same
    Vec3 to_sun{0};                        // of the anchor's frame, unit
    Layout layout;
    std::size_t map = kNone;
  };

  void group(const FrameScene& scene, std::size_t most);
  Group& add_group(std::size_t index);
  void add_to(Group& group, const FrameScene& scene, std::uint32_t receiver) const;
  double throw_in(const Group& group, const FrameScene& scene, const LightSpace& whole) const;
  void lay_out(Group& group, const FrameScene& scene, const TileLimits& limits, unsigned soft_side);
  void lay_out_all(const FrameScene& scene, const TileLimits& limits, unsigned soft_side,
                   std::uint64_t most, DiagnosticLog& log);
  static std::uint64_t texels_of(const Layout& layout);
  std::uint64_t stored_texels() const;
  bool assign(const ContextLimits& limits, const GladGLContext& gl, std::uint64_t most,
              DiagnosticLog& log);
  bool refresh(Device::Impl& device, const FrameScene& scene, Group& group, DiagnosticLog& log,
               const Job& job);
  static bool make(const ContextLimits& limits, const GladGLContext& gl, Map& map,
                   DiagnosticLog& log);
  void add_casters(const FrameScene& scene, std::span<const Drawn> receivers, bool soft);
  bool draw(Device::Impl& device, Map& map, const TargetStates& states, const Job& job);
  void add_draws(const GladGLContext& gl, const LightSpace& frame, const Vec2& sun_point,
                 std::uint32_t tile, bool all_receivers, const TargetStates& states);

  std::vector<Map> maps_;
  std::vector<Place> places_;
  std::uint64_t update_ = 0;
  std::uint64_t image_ = 0;  // the first update of it
  std::uint64_t drawn_ = 0;
  double edge_error_ = 0;
  double penumbra_ = 0;
  unsigned disc_points_ = 1;
  SunDisc disc_;
  // of one update, kept for the next one
  std::vector<Group> groups_;
  std::vector<Drawn> targets_;   // of one map: its receivers, then the other casters
  std::vector<Member> casters_;  // of these
  std::vector<DrawItem> placed_;
  std::vector<ShownItem> shown_;
  std::vector<LightSpace> frames_;  // of the tiles of one map, or of all of it
  ShadowTileFinder finder_;
  CasterDraws draws_;
};

// Returns the largest shear of rays to the disc.
double largest_shear(const LightSpace& frame, const SunDisc& disc);

// Returns true if a box may shadow the box of a map: it meets the cone from there to the Sun's
// disc, and is not entirely behind it.
//
//   shear  the largest of the points of the disc
bool meets_column(const Mat4& sun_from_box, const Vec3& low, const Vec3& high, double shear);

// Returns at most `most` groups of neighbours, each ascending, in the order of their first members.
std::vector<std::vector<std::uint32_t>> neighbour_groups(std::span<const Vec3> centres,
                                                         std::size_t most);

}  // namespace panwright::preview
