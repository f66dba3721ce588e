#include <fmt/core.h>

#include <array>
#include <cmath>

#include "base/text.h"
#include "importers/gltf/document.h"

namespace panwright::importers::gltf {

namespace {

using Kind = Json::Kind;

constexpr std::size_t kNobody = ~std::size_t{0};
// what rounding to bytes does to the length of a quaternion, as the validator allows it
constexpr double kSmallUnit = 0.00769;

// The largest sum of the magnitudes in a column.
double norm_of(const std::array<float, 16>& m) {
  double norm = 0;
  for (std::size_t c = 0; c < 16; c += 4)
    norm = std::fmax(norm, std::fabs(static_cast<double>(m[c])) +
                               std::fabs(static_cast<double>(m[c + 1])) +
                               std::fabs(static_cast<double>(m[c + 2])) +
                               std::fabs(static_cast<double>(m[c + 3])));
  return norm;
}

// Whether a matrix is a translation, rotation and scale as the validator sees it: taken apart and
// put together in single precision it has the same norm. Shears that keep the norm go unseen.
bool is_trs(const std::vector<Json>& numbers) {
  std::array<float, 16> m{};
  for (std::size_t i = 0; i < 16; ++i) m[i] = static_cast<float>(numbers[i].number);
  Mat3 columns;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 3; ++k)
      columns[static_cast<int>(c)][static_cast<int>(k)] = static_cast<double>(m[4 * c + k]);
  const double determinant = glm::determinant(columns);
  if (determinant == 0) return false;
  double scale[3];
  for (int c = 0; c < 3; ++c) scale[c] = glm::length(columns[c]);
  if (determinant < 0) scale[0] = -scale[0];
  float r[3][3];  // columns
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 3; ++k) r[c][k] = static_cast<float>(columns[c][k] / scale[c]);
  // Shoemake, "Animating rotation with quaternion curves", 1985
  float q[4];
  const double trace =
      static_cast<double>(r[0][0]) + static_cast<double>(r[1][1]) + static_cast<double>(r[2][2]);
  const auto difference = [&](int a, int b) {
    return static_cast<double>(r[a][b]) - static_cast<double>(r[b][a]);
  };
  if (trace > 0) {
    const double root = std::sqrt(trace + 1);
    q[3] = static_cast<float>(root / 2);
    for (int k = 0; k < 3; ++k)
      q[k] = static_cast<float>(difference((k + 1) % 3, (k + 2) % 3) / (2 * root));
  } else {
    const int i = r[0][0] < r[1][1] ? (r[1][1] < r[2][2] ? 2 : 1) : (r[0][0] < r[2][2] ? 2 : 0);
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double root = std::sqrt(2 * static_cast<double>(r[i][i]) - trace + 1);
    q[i] = static_cast<float>(root / 2);
    q[3] = static_cast<float>(difference(j, k) / (2 * root));
    for (const int other : {j, k})
      q[other] = static_cast<float>(
          (static_cast<double>(r[i][other]) + static_cast<double>(r[other][i])) / (2 * root));
  }
  const double x = static_cast<double>(q[0]), y = static_cast<double>(q[1]),
               z = static_cast<double>(q[2]), w = static_cast<double>(q[3]);
  const double turned[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                               {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                               {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
  std::array<float, 16> again = m;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 3; ++k)
      again[4 * c + k] = static_cast<float>(static_cast<double>(static_cast<float>(turned[c][k])) *
                                            static_cast<double>(static_cast<float>(scale[c])));
  constexpr double kClose = 5e-5;  // the validator's
  return std::fabs(norm_of(again) - norm_of(m)) < kClose;
}

std::size_t index_in(const Json& json) { return static_cast<std::size_t>(json.number); }

class NodePass {
 public:
  explicit NodePass(Document& document) : d_(document), nodes_(document.root.find("nodes")) {}

  void run() {
    if (nodes_ && nodes_->is(Kind::array)) {
      find_parents();
      break_loops();
      check_scenes();
      for (std::size_t i = 0; i < nodes_->items.size(); ++i) check_transform(i);
      for (std::size_t i = 0; i < nodes_->items.size(); ++i) check_mesh_use(i);
    }
    check_skins();
  }

 private:
  void find_parents() {
    parent_.assign(nodes_->items.size(), kNobody);
    for (std::size_t i = 0; i < nodes_->items.size(); ++i) {
      Json* children = nodes_->items[i].find("children");
      if (!children) continue;
      std::vector<Json> kept;
      for (const Json& child : children->items) {
        const std::size_t c = index_in(child);
        if (parent_[c] != kNobody) {
          d_.report(Code("E6208"), &child, pointer("nodes", i) + "/children",
                    fmt::format("node {} is a child of node {} already", c, parent_[c]));
        } else {
          parent_[c] = i;
          kept.push_back(child);
        }
      }
      children->items = std::move(kept);
    }
  }

  // Each node has one parent now, so that a loop is a ring that nothing leads into.
  void break_loops() {
    std::vector<std::uint8_t> seen(parent_.size());  // 1: on the way, 2: leads to a root
    for (std::size_t start = 0; start < parent_.size(); ++start) {
      std::size_t at = start;
      while (at != kNobody && seen[at] == 0) {
        seen[at] = 1;
        at = parent_[at];
      }
      if (at != kNobody && seen[at] == 1) {
        for (std::size_t in_ring = at;;) {
          d_.report(Code("E6208"), &nodes_->items[in_ring], pointer("nodes", in_ring),
                    "the node is below itself");
          const std::size_t up = parent_[in_ring];
          seen[in_ring] = 2;
          if (up == at) break;
          in_ring = up;
        }
        cut(at);
      }
      for (at = start; at != kNobody && seen[at] == 1; at = parent_[at]) seen[at] = 2;
    }
  }

  void cut(std::size_t node) {
    std::vector<Json>& children = nodes_->items[parent_[node]].find("children")->items;
    std::erase_if(children, [&](const Json& child) { return index_in(child) == node; });
    parent_[node] = kNobody;
  }

  void check_scenes() {
    const std::vector<Json>& scenes = d_.root.list("scenes");
    for (std::size_t i = 0; i < scenes.size(); ++i)
      for (const Json& node : scenes[i].list("nodes"))
        if (parent_[index_in(node)] != kNobody)
          d_.report(Code("E6208"), &node, pointer("scenes", i) + "/nodes",
                    fmt::format("node {} is a child of node {}, not a root", index_in(node),
                                parent_[index_in(node)]));
  }

  void check_transform(std::size_t index) {
    Json& node = nodes_->items[index];
    const std::string at = pointer("nodes", index);
    if (const Json* matrix = node.find("matrix")) {
      for (const char* key : {"translation", "rotation", "scale"})
        if (const Json* other = node.find(key)) {
          d_.report(Code("E6204"), other, at,
                    fmt::format("a node with both 'matrix' and '{}'", key));
          node.erase(key);
        }
      matrix = node.find("matrix");
      const std::vector<Json>& m = matrix->items;
      if (m[3].number != 0 || m[7].number != 0 || m[11].number != 0 || m[15].number != 1) {
        d_.report(Code("E6207"), matrix, at + "/matrix",
                  "the last row of the matrix is not 0 0 0 1");
        node.erase("matrix");
      } else if (!is_trs(m)) {
        d_.report(Code("E6207"), matrix, at + "/matrix",
                  "the matrix is not a translation, rotation and scale: it shears or flattens");
      }
    }
    if (const Json* rotation = node.find("rotation")) {
      double squared = 0;
      for (const Json& x : rotation->items) squared += x.number * x.number;
      if (std::fabs(std::sqrt(squared) - 1) > kSmallUnit)
        d_.report(Code("E6204"), rotation, at + "/rotation",
                  fmt::format("a quaternion of length {:.6g}, expected 1", std::sqrt(squared)));
      if (!(squared > 0)) node.erase("rotation");
    }
  }

  static std::size_t target_count(const Json& mesh) {
    const std::vector<Json>& primitives = mesh.list("primitives");
    return primitives.empty() ? 0 : primitives[0].list("targets").size();
  }

  void check_mesh_use(std::size_t index) {
    const Json& node = nodes_->items[index];
    const Json* mesh = node.find("mesh");
    if (!mesh) return;
    const Json& used = d_.root.list("meshes")[index_in(*mesh)];
    const Json* weights = node.find("weights");
    if (weights && weights->items.size() != target_count(used))
      d_.report(
          Code("E6211"), weights, pointer("nodes", index) + "/weights",
          fmt::format("{} weights for {} targets", weights->items.size(), target_count(used)));
    if (!node.find("skin")) return;
    bool skinned = true;
    for (const Json& primitive : used.list("primitives")) {
      const Json* attributes = primitive.find("attributes");
      skinned = skinned && attributes && attributes->find("JOINTS_0");
    }
    if (!skinned)
      d_.report(Code("W6215"), &node, pointer("nodes", index),
                "a skin over a mesh without joints; the mesh is not posed");
  }

  void check_skins() {
    const std::vector<Json>& skins = d_.root.list("skins");
    for (std::size_t i = 0; i < skins.size(); ++i) {
      const Json* matrices = skins[i].find("inverseBindMatrices");
      const Json* joints = skins[i].find("joints");
      if (!joints) continue;
      if (!one_root(*joints))
        d_.report(Code("W6215"), joints, pointer("skins", i) + "/joints",
                  "the joints have no common root");
      if (!matrices) continue;
      const Accessor& a = d_.accessors[index_in(*matrices)];
      if (a.view >= 0 && d_.views[static_cast<std::size_t>(a.view)].stride > 0)
        d_.report(Code("E6206"), matrices, pointer("skins", i) + "/inverseBindMatrices",
                  "the view of matrices has a byteStride");
      if (!a.json->find("componentType") || !a.json->find("type"))
        d_.report(Code("E6206"), matrices, pointer("skins", i) + "/inverseBindMatrices",
                  "the accessor has no type that is known");
      if (!a.json->broken && (a.width != 16 || !a.is_float()))
        d_.report(Code("E6206"), matrices, pointer("skins", i) + "/inverseBindMatrices",
                  "the accessor does not hold matrices of single precision");
      else if (!a.json->broken && a.count < joints->items.size())
        d_.report(Code("E6206"), matrices, pointer("skins", i) + "/inverseBindMatrices",
                  fmt::format("{} matrices for {} joints", a.count, joints->items.size()));
    }
  }

  bool one_root(const Json& joints) {
    std::size_t root = kNobody;
    for (const Json& joint : joints.items) {
      const std::size_t top = top_of(index_in(joint));
      if (root != kNobody && top != root) return false;
      root = top;
    }
    return true;
  }

  // The root above a node; found once for each node.
  std::size_t top_of(std::size_t node) {
    if (top_.empty()) top_.assign(parent_.size(), kNobody);
    std::vector<std::size_t> way;
    while (top_[node] == kNobody && parent_[node] != kNobody) {
      way.push_back(node);
      node = parent_[node];
    }
    const std::size_t top = top_[node] == kNobody ? node : top_[node];
    for (const std::size_t below : way) top_[below] = top;
    return top;
  }

  Document& d_;
  Json* nodes_;
  std::vector<std::size_t> parent_;
  std::vector<std::size_t> top_;
};

}  // namespace

void check_nodes(Document& document) { NodePass(document).run(); }

}  // namespace panwright::importers::gltf
