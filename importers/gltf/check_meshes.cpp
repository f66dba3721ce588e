#include <fmt/core.h>

#include <algorithm>
#include <charconv>

#include "base/text.h"
#include "importers/gltf/primitives.h"
#include "importers/gltf/read.h"

namespace panwright::importers::gltf {

namespace {

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
              kUnsignedInt = 5125, kFloat = 5126;

std::size_t number_in(const Json& json) { return static_cast<std::size_t>(json.number); }

// "TEXCOORD_12" → "TEXCOORD" and 12.
struct Semantic {
  std::string_view base;
  int set = -1;  // −1: the name has none
  bool custom = false;
  bool known = false;
};

Semantic semantic_of(std::string_view name) {
  if (name.starts_with('_')) return {name, -1, true, true};
  for (const std::string_view single : {"POSITION", "NORMAL", "TANGENT"})
    if (name == single) return {name, -1, false, true};
  const std::size_t bar = name.find('_');
  const std::string_view base = name.substr(0, bar);
  const bool numbered =
      base == "TEXCOORD" || base == "COLOR" || base == "JOINTS" || base == "WEIGHTS";
  if (!numbered || bar == name.npos) return {name};
  const std::string_view digits = name.substr(bar + 1);
  int set = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), set);
  if (error != std::errc() || end != digits.data() + digits.size() || set < 0 ||
      (digits.size() > 1 && digits[0] == '0'))
    return {name};
  return {base, set, false, true};
}

bool has_width(const Semantic& semantic, int width, bool target) {
  if (semantic.base == "POSITION" || semantic.base == "NORMAL") return width == 3;
  if (semantic.base == "TANGENT") return width == (target ? 3 : 4);
  if (semantic.base == "TEXCOORD") return width == 2;
  if (semantic.base == "COLOR") return width == 3 || width == 4;
  return width == 4;
}

// Number types that an attribute may have; `quantised` adds those of KHR_mesh_quantization.
bool has_component(const Semantic& semantic, const Accessor& a, bool quantised) {
  const bool small = a.component == kByte || a.component == kShort;
  const bool small_unsigned = a.component == kUnsignedByte || a.component == kUnsignedShort;
  if (semantic.base == "JOINTS") return small_unsigned && !a.normalised;
  if (a.component == kFloat) return true;
  if (semantic.base == "POSITION") return quantised && (small || small_unsigned);
  if (semantic.base == "NORMAL" || semantic.base == "TANGENT")
    return quantised && small && a.normalised;
  if (semantic.base == "TEXCOORD" && quantised) return small || small_unsigned;
  return small_unsigned && a.normalised;
}

class MeshCheck {
 public:
  explicit MeshCheck(Document& document)
      : d_(document), quantised_(document.uses("KHR_mesh_quantization")) {}

  void run() {
    count_users();
    find_uses();
    find_not_finite();
    Json* meshes = d_.root.find("meshes");
    if (!meshes) return;
    for (std::size_t m = 0; m < meshes->items.size(); ++m) {
      Json* primitives = meshes->items[m].find("primitives");
      if (!primitives || !primitives->is(Json::Kind::array)) continue;
      for (std::size_t p = 0; p < primitives->items.size(); ++p) {
        at_ = fmt::format("/meshes/{}/primitives/{}", m, p);
        primitive(primitives->items[p]);
      }
      targets_agree(meshes->items[m], pointer("meshes", m));
    }
  }

 private:
  bool wrong(const Json* at, std::string_view below, std::string message,
             Code code = Code("E6211")) {
    d_.report(code, at, fmt::format("{}{}", at_, below), std::move(message));
    return false;
  }

  // How many accessors of vertices stand in each view: two or more need a stride.
  void count_users() {
    users_.resize(d_.views.size());
    std::vector<bool> counted(d_.accessors.size());
    const auto count = [&](const Json* attributes) {
      if (!attributes) return;
      for (const Json& accessor : attributes->items) {
        const std::size_t i = number_in(accessor);
        if (counted[i] || d_.accessors[i].view < 0) continue;
        counted[i] = true;
        ++users_[static_cast<std::size_t>(d_.accessors[i].view)];
      }
    };
    for (const Json& mesh : d_.root.list("meshes"))
      for (const Json& primitive : mesh.list("primitives")) {
        count(primitive.find("attributes"));
        for (const Json& target : primitive.list("targets")) count(&target);
      }
  }

  // An accessor holds vertices, indices, matrices of skins or keys of animations, one of these.
  void find_uses() {
    std::vector<std::string_view> uses(d_.accessors.size());
    const auto use = [&](const Json* item, std::string_view as) {
      if (!item) return;
      std::string_view& known = uses[number_in(*item)];
      if (!known.empty() && known != as)
        d_.report(Code("E6211"), item, pointer("accessors", number_in(*item)),
                  fmt::format("the accessor holds {} and {}", known, as));
      known = as;
    };
    const auto use_all = [&](const Json* attributes) {
      if (!attributes) return;
      for (const Json& accessor : attributes->items) use(&accessor, "vertices");
    };
    for (const Json& mesh : d_.root.list("meshes"))
      for (const Json& primitive : mesh.list("primitives")) {
        use_all(primitive.find("attributes"));
        use(primitive.find("indices"), "indices");
        for (const Json& target : primitive.list("targets")) use_all(&target);
      }
    for (const Json& skin : d_.root.list("skins"))
      use(skin.find("inverseBindMatrices"), "matrices of a skin");
    for (const Json& animation : d_.root.list("animations"))
      for (const Json& sampler : animation.list("samplers")) {
        use(sampler.find("input"), "times of an animation");
        use(sampler.find("output"), "values of an animation");
      }
  }

  // Numbers that are not read, or only in part, are looked at as well: tangents, other sets of
  // texture coordinates and colours, custom attributes, morph targets, animations.
  void find_not_finite() {
    std::vector<bool> seen(d_.accessors.size());
    const auto look = [&](const Json& item) {
      const std::size_t i = number_in(item);
      if (seen[i]) return;
      seen[i] = true;
      if (const std::size_t bad = count_not_finite(d_, d_.accessors[i]); bad > 0)
        d_.report(Code("E6207"), &item, pointer("accessors", i),
                  fmt::format("{} not finite", counted(bad, "number")));
    };
    for (const Json& mesh : d_.root.list("meshes"))
      for (const Json& primitive : mesh.list("primitives")) {
        if (const Json* attributes = primitive.find("attributes"))
          for (std::size_t i = 0; i < attributes->items.size(); ++i) {
            const std::string& name = attributes->keys[i];
            if (name != "POSITION" && name != "NORMAL" && !name.starts_with("WEIGHTS_"))
              look(attributes->items[i]);
          }
        for (const Json& target : primitive.list("targets"))
          for (const Json& item : target.items) look(item);
      }
    for (const Json& animation : d_.root.list("animations"))
      for (const Json& sampler : animation.list("samplers"))
        for (const char* key : {"input", "output"})
          if (const Json* item = sampler.find(key)) look(*item);
  }

  // A number type or shape that is unknown was taken out, as a deviation; who reads it cannot.
  static bool has_format(const Accessor& a) {
    return a.json->find("componentType") && a.json->find("type");
  }

  static bool is_packed(const Json& primitive) {
    const Json* extensions = primitive.find("extensions");
    return extensions && extensions->find("KHR_draco_mesh_compression");
  }

  void primitive(Json& json) {
    Json* attributes = json.find("attributes");
    if (!attributes) return;
    // its compressed data are lost, and without them it would be all 0
    if (json.broken) attributes->erase("POSITION");
    const bool packed = is_packed(json);
    check_names(*attributes);
    const Json* position = attributes->find("POSITION");
    const std::uint64_t count = position ? d_.accessors[number_in(*position)].count : 0;
    std::vector<std::string> drop;
    for (std::size_t i = 0; i < attributes->items.size(); ++i) {
      const Json& item = attributes->items[i];
      const std::string& name = attributes->keys[i];
      const bool readable = attribute(item, name, packed, false);
      const std::uint64_t own = d_.accessors[number_in(item)].count;
      if (position && own != count && !d_.accessors[number_in(item)].json->broken)
        wrong(&item, "/attributes/" + name,
              fmt::format("{} elements for {} positions", own, count));
      if (!readable || (position && own != count)) drop.push_back(name);
    }
    if (!position)
      d_.report(Code("W6009"), attributes, at_, "the primitive has no positions and is left out");
    indices(json);
    targets(json, *attributes, count);
    material(json, *attributes);
    for (const std::string& name : drop) attributes->erase(name);
  }

  void check_names(const Json& attributes) {
    std::map<std::string_view, std::vector<int>> sets;
    for (std::size_t i = 0; i < attributes.keys.size(); ++i) {
      const Semantic semantic = semantic_of(attributes.keys[i]);
      if (!semantic.known)
        wrong(&attributes.items[i], "/attributes",
              fmt::format("{} is not a glTF attribute; others begin with '_'",
                          in_quotes(attributes.keys[i])),
              Code("W6215"));
      if (semantic.set >= 0) sets[semantic.base].push_back(semantic.set);
    }
    for (auto& [base, list] : sets) {
      std::sort(list.begin(), list.end());
      if (list.back() + 1 != static_cast<int>(list.size()))
        wrong(&attributes, "/attributes",
              fmt::format("the sets of {} are not numbered from 0 on", base), Code("W6215"));
    }
    if (sets["JOINTS"].size() != sets["WEIGHTS"].size())
      wrong(&attributes, "/attributes",
            fmt::format("{} sets of joints and {} of weights", sets["JOINTS"].size(),
                        sets["WEIGHTS"].size()));
  }

  // Whether numbers can be taken from the accessor for this attribute.
  bool attribute(const Json& item, const std::string& name, bool packed, bool target) {
    const Semantic semantic = semantic_of(name);
    const Accessor& a = d_.accessors[number_in(item)];
    if (!semantic.known) return false;
    const std::string below = (target ? "/" : "/attributes/") + name;
    if (!has_format(a)) return wrong(&item, below, "the accessor has no type that is known");
    if (a.json->broken) return false;
    if (semantic.custom) {
      if (a.component == kUnsignedInt)
        wrong(&item, below, "32-bit integers are not allowed in vertices");
      return true;
    }
    const bool width = has_width(semantic, a.width, target) && !a.matrix;
    if (!width || !has_component(semantic, a, quantised_))
      wrong(&item, below,
            fmt::format("{} numbers of type {}{} are not allowed for {}", a.width, a.component,
                        a.normalised ? ", normalised," : "", name));
    if (semantic.base == "POSITION" && (!a.json->find("min") || !a.json->find("max")))
      wrong(&item, below, "positions without 'min' and 'max'", Code("W6212"));
    if (packed || a.view < 0) return width && (a.sound || packed);
    const View& view = d_.views[static_cast<std::size_t>(a.view)];
    if ((view.offset + a.offset) % 4 != 0 || a.stride % 4 != 0)
      wrong(&item, below,
            fmt::format("vertices at offset {} and {} bytes apart do not lie at "
                        "multiples of 4",
                        view.offset + a.offset, a.stride),
            Code("E6206"));
    if (view.stride == 0 && !view.compressed && users_[static_cast<std::size_t>(a.view)] > 1)
      wrong(&item, below, "the view holds several attributes and has no byteStride", Code("E6206"));
    return width && a.sound;
  }

  void indices(Json& json) {
    const Json* item = json.find("indices");
    if (!item) return;
    const Accessor& a = d_.accessors[number_in(*item)];
    const bool integers = a.component == kUnsignedByte || a.component == kUnsignedShort ||
                          a.component == kUnsignedInt;
    bool readable = !a.json->broken && (a.sound || is_packed(json));
    if (!has_format(a)) wrong(item, "/indices", "the accessor has no type that is known");
    if (!a.json->broken && (a.width != 1 || !integers || a.normalised)) {
      wrong(item, "/indices", "indices are single unsigned integers");
      readable = false;
    }
    if (a.view >= 0 && d_.views[static_cast<std::size_t>(a.view)].stride > 0)
      wrong(item, "/indices", "the view of indices has a byteStride", Code("E6206"));
    // without them the triangles would be others
    if (!readable) json.find("attributes")->erase("POSITION");
  }

  void targets(Json& json, const Json& attributes, std::uint64_t count) {
    Json* list = json.find("targets");
    if (!list) return;
    for (std::size_t t = 0; t < list->items.size(); ++t) {
      Json& target = list->items[t];
      const std::string outer = at_;
      at_ += fmt::format("/targets/{}", t);
      std::vector<std::string> drop;
      for (std::size_t i = 0; i < target.items.size(); ++i) {
        const std::string& name = target.keys[i];
        const Accessor& a = d_.accessors[number_in(target.items[i])];
        bool readable = true;
        if (!semantic_of(name).known || semantic_of(name).base == "JOINTS" ||
            semantic_of(name).base == "WEIGHTS")
          readable = wrong(&target.items[i], "",
                           fmt::format("{} cannot be morphed", in_quotes(name)), Code("W6215"));
        if (!attributes.find(name))
          readable = wrong(&target.items[i], "/" + name, "the primitive has no such attribute");
        else if (readable)
          readable = attribute(target.items[i], name, false, true);
        if (readable && count > 0 && a.count != count)
          readable = wrong(&target.items[i], "/" + name,
                           fmt::format("{} elements for {} vertices", a.count, count));
        if (!readable) drop.push_back(name);
      }
      for (const std::string& name : drop) target.erase(name);
      at_ = outer;
    }
  }

  void material(const Json& json, const Json& attributes) {
    const Json* item = json.find("material");
    if (!item) return;
    int sets = 0;
    while (attributes.find(fmt::format("TEXCOORD_{}", sets))) ++sets;
    const Json& material = d_.root.list("materials")[number_in(*item)];
    const Json* pbr = material.find("pbrMetallicRoughness");
    for (const Json* texture :
         {pbr ? pbr->find("baseColorTexture") : nullptr,
          pbr ? pbr->find("metallicRoughnessTexture") : nullptr, material.find("normalTexture"),
          material.find("emissiveTexture"), material.find("occlusionTexture")}) {
      if (!texture) continue;
      const Json* set = texture->find("texCoord");
      const double wanted = set ? set->number : 0;
      if (wanted < sets) continue;
      wrong(item, "/material",
            fmt::format("the material has a texture over coordinates {}, which the primitive does "
                        "not have",
                        format_double(wanted)),
            Code("W6215"));
      return;
    }
  }

  void targets_agree(const Json& mesh, const std::string& at) {
    const std::vector<Json>& primitives = mesh.list("primitives");
    if (primitives.empty()) return;
    const std::size_t targets = primitives[0].list("targets").size();
    for (const Json& primitive : primitives)
      if (primitive.list("targets").size() != targets)
        d_.report(Code("E6211"), &primitive, at + "/primitives",
                  fmt::format("{} targets in one primitive, {} in the first",
                              primitive.list("targets").size(), targets));
    const Json* weights = mesh.find("weights");
    if (weights && weights->items.size() != targets)
      d_.report(Code("E6211"), weights, at + "/weights",
                fmt::format("{} weights for {} targets", weights->items.size(), targets));
  }

  Document& d_;
  bool quantised_;
  std::string at_;
  std::vector<std::uint32_t> users_;
};

}  // namespace

void check_meshes(Document& document) { MeshCheck(document).run(); }

}  // namespace panwright::importers::gltf
