// Joints of a URDF, and what mimics what. Inside this folder only.
#pragma once

#include <string>
#include <vector>

#include "shared/urdf/element.hpp"

namespace lf::urdf {

// A joint as the file has it: links and the mimicked joint by name.
struct NamedJoint {
  Element element;
  Joint joint;
  std::string parent, child;
  std::string mimicked;  // "" when it mimics none
  int mimic_line = 0;
  bool as_fixed = false;  // written as a moving joint, but its range has no width
};

NamedJoint read_joint(const Element& element);

// Finds what each joint mimics and checks it: there is such a joint, it moves, nothing mimics itself through others, and the mimicking joint's own range holds what
// the mimicked one's range asks of it (told).
void join_mimics(std::vector<NamedJoint>& joints, Report& report);

}  // namespace lf::urdf
