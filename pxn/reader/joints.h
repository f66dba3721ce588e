// Joints of the whole scene, and their references to each other.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pxn/reader/part.h"
#include "pxn/text/reporter.h"

namespace panwright::pxn {

class Joints {
 public:
  // Appends a joint to the scene, named by the prefix and its own name. The document outlives this.
  // Returns false, without a change, if the name is taken.
  bool add(const PartJoint& joint, std::int32_t node, const std::string& prefix, SourceSpan where,
           const xml::Document& document, std::uint32_t element, scene::Scene& scene);

  // Returns a copy of a joint for another node: under another name, it follows the leader one to
  // one; balls and general joints only take the name.
  PartJoint follower(const PartJoint& joint, const std::string& leader);

  // Resolves references after the last joint: in the same use, else around it. Joints that cannot
  // follow their leader become free. Then sorts them by their nodes.
  //
  // Reports: E1232.
  void connect(scene::Scene& scene, Reporter& reporter) const;

 private:
  struct Known {
    std::int32_t index;  // of the scene's
    std::string prefix, mimic, gimbal;
    SourceSpan where;
    const xml::Document* document;
    std::uint32_t element;
  };
  std::int32_t find(const Known& from, const std::string& name) const;

  std::vector<Known> known_;
  std::map<std::string, std::int32_t> by_name_;
  std::map<std::string, std::uint32_t> copies_;
};

}  // namespace panwright::pxn
