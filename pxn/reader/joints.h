// Joints of the whole scene, and which of them follow or aim with which.
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
  // Appends a joint to the scene, called by the prefix and its own name. The document outlives
  // this. Returns false, with nothing done, where another has the name.
  bool add(const PartJoint& joint, std::int32_t node, const std::string& prefix, SourceSpan where,
           const xml::Document& document, std::uint32_t element, scene::Scene& scene);

  // A copy of a joint for another node: by another name, it follows the leader one to one; balls
  // and general joints take the name alone.
  PartJoint follower(const PartJoint& joint, const std::string& leader);

  // Once all joints are there, finds those that they name: in the same use, else in what is around
  // it. Joints that follow what they cannot follow become free. Then they stand in the order of
  // their nodes.
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
