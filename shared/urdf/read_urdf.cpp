#include "shared/urdf/read_urdf.hpp"

#include <algorithm>
#include <map>

#include "shared/input_error.hpp"
#include "shared/regular_file.hpp"
#include "shared/urdf/element.hpp"
#include "shared/urdf/read_joint.hpp"
#include "shared/urdf/read_link.hpp"

namespace lf::urdf {
namespace {

using tinyxml2::XMLElement;

constexpr std::size_t most_bytes = std::size_t{16} << 20;  // a URDF of 100 links has 100 kB
constexpr std::size_t most_links = 4096;

std::string load(const std::string& file) {
  std::string text = bytes_of_regular_file(file, most_bytes);
  if (text.size() > most_bytes) throw InputError(file, 0, "has more than 16 MB: is it a URDF? Meshes belong into files of their own");
  if (text.empty()) throw InputError(file, 0, "is empty: write a <robot>");
  return text;
}

int line_at(const std::string& text, std::size_t place) {
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
}

void parse(const std::string& file, const std::string& text, tinyxml2::XMLDocument& document) {
  if (const std::size_t nul = text.find('\0'); nul != std::string::npos)
    throw InputError(file, line_at(text, nul), "holds a byte 0: save it as UTF-8 text");
  const tinyxml2::XMLError result = document.Parse(text.data(), text.size());
  if (result == tinyxml2::XML_SUCCESS) return;
  std::string message = "is not well-formed XML";
  if (result == tinyxml2::XML_ERROR_EMPTY_DOCUMENT)
    message = "has no element: write a <robot>";
  else if (result == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED)
    message = "has elements more than 100 deep: links and joints stand side by side below <robot>";
  else if (text.find("</robot>") == std::string::npos && text.find("<robot") != std::string::npos)
    message += ": it has no </robot>; was it cut off?";
  else if (result == tinyxml2::XML_ERROR_PARSING_ATTRIBUTE)
    message += ": an attribute is there twice, or lacks its = or a quote; correct it";
  else
    message += std::string(" (") + tinyxml2::XMLDocument::ErrorIDToName(result) + "): correct it, or check it with xmllint";
  throw InputError(file, document.ErrorLineNum(), message);
}

[[noreturn]] void refuse_xacro(const std::string& file, int line, const std::string& what) {
  throw InputError(file, line, "holds " + what + ": it is a xacro that is not expanded. Run: xacro arm.urdf.xacro > arm.urdf");
}

bool is_macro(const char* text) {
  const std::string_view view = text == nullptr ? "" : text;
  return view.find("${") != std::string_view::npos || view.find("$(") != std::string_view::npos;
}

// Throws at the first macro.
void refuse_macros(const std::string& file, const XMLElement* root) {
  // Document order, without recursion.
  for (const XMLElement* e = root; e != nullptr;) {
    if (std::string_view(e->Name()).starts_with("xacro:")) refuse_xacro(file, e->GetLineNum(), "<" + std::string(e->Name()) + ">");
    for (const auto* a = e->FirstAttribute(); a != nullptr; a = a->Next())
      if (is_macro(a->Value())) refuse_xacro(file, a->GetLineNum(), shown(a->Value()));
    for (const auto* node = e->FirstChild(); node != nullptr; node = node->NextSibling())
      if (node->ToText() != nullptr && is_macro(node->Value())) refuse_xacro(file, node->GetLineNum(), shown(node->Value()));
    const XMLElement* next = e->FirstChildElement();
    while (next == nullptr && e != nullptr && e != root) {
      next = e->NextSiblingElement();
      if (next == nullptr) e = e->Parent()->ToElement();
    }
    e = next;
  }
}

// Links and joints in the file's order, by index once the names are known.
class Tree {
 public:
  Tree(std::vector<Link> links, std::vector<NamedJoint> joints, Report& report)
      : links_(std::move(links)), joints_(std::move(joints)), report_(report) {}

  // Fills the mechanism, root first; with any problem it does not.
  void build(Mechanism& mechanism) {
    refuse_twins();
    tell_slashes();
    const bool joined = join_links();
    join_mimics(joints_, report_);
    if (!joined || !check_roots() || report_.problems() > 0) return;
    order(mechanism);
  }

 private:
  void refuse_twins() {
    for (std::size_t i = 0; i < links_.size(); ++i) refuse_twin(link_by_name_, "link", links_[i].name, i, links_[i].line);
    std::map<std::string, std::size_t, std::less<>> joint_by_name;
    for (std::size_t i = 0; i < joints_.size(); ++i) refuse_twin(joint_by_name, "joint", joints_[i].joint.name, i, joints_[i].joint.line);
  }

  void refuse_twin(std::map<std::string, std::size_t, std::less<>>& by_name, const std::string& what, const std::string& name,
                   std::size_t i, int line) {
    if (!name.empty() && !by_name.emplace(name, i).second) report_.problem(line, what + " " + shown(name) + " is there twice: rename one");
  }

  // A slash is a name's own here. Other programs cut what stands before it, and then two names may be one.
  void tell_slashes() {
    std::map<std::string, std::string> links, joints;
    for (const Link& link : links_) tell_slash(links, "link", link.name, link.line);
    for (const NamedJoint& named : joints_) tell_slash(joints, "joint", named.joint.name, named.joint.line);
  }

  void tell_slash(std::map<std::string, std::string>& cut, const std::string& what, const std::string& name, int line) {
    const std::size_t slash = name.rfind('/');
    const auto [other, is_new] = cut.emplace(slash == std::string::npos ? name : name.substr(slash + 1), name);
    if (!is_new && other->second != name)
      report_.note(line, what + " " + shown(name) + " and " + shown(other->second) +
                             " differ only before a slash. They are two here; some programs take them as one");
    else if (slash != std::string::npos)
      report_.note(line,
                   what + " " + shown(name) + " has a slash in its name. It is used as it is; some programs cut what stands before it");
  }

  std::optional<std::size_t> end(const NamedJoint& named, const char* which, const std::string& name) {
    if (name.empty()) return std::nullopt;  // told where it was read
    const auto found = link_by_name_.find(name);
    if (found != link_by_name_.end()) return found->second;
    report_.problem(named.element.child(which)->line(), named.element.label() + " has the " + which + " " + shown(name) +
                                                            ", which is no link of this file: correct the name, or add the link");
    return std::nullopt;
  }

  // False when links or joints stay without a place.
  bool join_links() {
    bool joined = true;
    carrier_.assign(links_.size(), std::nullopt);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      NamedJoint& named = joints_[i];
      const auto parent = end(named, "parent", named.parent), child = end(named, "child", named.child);
      joined = joined && parent && child;
      if (!parent || !child) continue;
      named.joint.parent = *parent;
      named.joint.child = *child;
      if (carrier_[*child]) {
        report_.problem(named.joint.line, named.element.label() + " carries link " + shown(named.child) + ", which joint " +
                                              shown(joints_[*carrier_[*child]].joint.name) +
                                              " carries, too: a mechanism is a tree, remove one of the two");
        joined = false;
      } else {
        carrier_[*child] = i;
      }
    }
    return joined && link_by_name_.size() == links_.size();
  }

  // Exactly one link that nothing carries, and from it a way to all others. What the way does not reach hangs on a ring of joints.
  bool check_roots() {
    const std::size_t before = report_.problems();
    std::vector<std::size_t> roots;
    for (std::size_t i = 0; i < links_.size(); ++i)
      if (!carrier_[i]) roots.push_back(i);
    for (std::size_t i = 1; i < roots.size(); ++i)
      report_.problem(links_[roots[i]].line, "link " + shown(links_[roots[i]].name) + " is a second root beside " +
                                                 shown(links_[roots[0]].name) + ": no joint carries it. Join it to the tree, or remove it");
    std::vector<int> state(links_.size(), 0);  // 1: on the way that is being followed, 2: done
    for (std::size_t i = 0; i < links_.size(); ++i) {
      std::size_t at = i;
      std::vector<std::size_t> way;
      while (state[at] == 0) {
        state[at] = 1;
        way.push_back(at);
        if (!carrier_[at]) break;
        at = joints_[*carrier_[at]].joint.parent;
      }
      if (state[at] == 1 && carrier_[at]) {
        const NamedJoint& closing = joints_[*carrier_[at]];
        report_.problem(closing.joint.line, closing.element.label() + " closes a ring of joints through link " + shown(links_[at].name) +
                                                ": a mechanism is a tree, remove one joint of the ring");
      }
      for (const std::size_t link : way) state[link] = 2;
    }
    if (roots.empty() && report_.problems() == before) report_.problem(0, "has no link: write one");
    return report_.problems() == before;
  }

  // Depth first. joints[i] carries links[i + 1].
  void order(Mechanism& mechanism) {
    std::vector<std::vector<std::size_t>> below(links_.size());  // joints, the file's last first
    for (std::size_t i = joints_.size(); i-- > 0;) below[joints_[i].joint.parent].push_back(i);
    const auto root = std::find(carrier_.begin(), carrier_.end(), std::nullopt);
    std::vector<std::size_t> new_link(links_.size()), new_joint(joints_.size());
    std::vector<std::size_t> waiting{static_cast<std::size_t>(root - carrier_.begin())};
    while (!waiting.empty()) {
      const std::size_t old = waiting.back();
      waiting.pop_back();
      new_link[old] = mechanism.links.size();
      mechanism.links.push_back(std::move(links_[old]));
      if (const auto carrier = carrier_[old]) {
        new_joint[*carrier] = mechanism.joints.size();
        mechanism.joints.push_back(std::move(joints_[*carrier].joint));
      }
      for (const std::size_t joint : below[old]) waiting.push_back(joints_[joint].joint.child);
    }
    for (Joint& joint : mechanism.joints) {
      joint.parent = new_link[joint.parent];
      joint.child = new_link[joint.child];
      if (joint.mimic) joint.mimic->joint = new_joint[joint.mimic->joint];
    }
  }

  std::vector<Link> links_;
  std::vector<NamedJoint> joints_;
  Report& report_;
  std::map<std::string, std::size_t, std::less<>> link_by_name_;
  std::vector<std::optional<std::size_t>> carrier_;  // the joint that carries a link
};

void check_robot(const Element& robot) {
  if (robot.name() != "robot")
    throw InputError(robot.report().file(), robot.line(),
                     "begins with <" + std::string(robot.name().substr(0, 60)) + ">, not with <robot>: is it a URDF?");
  robot.check({.attributes = {"name", "version"},
               .many = {"link", "joint", "material"},
               .unused = {"transmission", "gazebo", "ros2_control", "sensor", "mujoco"}});
  if (robot.has("version") && robot.text("version") != "1.0" && robot.text("version") != "1")
    robot.problem("has version " + shown(robot.text("version")) + ": this reader knows 1.0");
}

}  // namespace

std::string Reading::told(const Note& note) const { return InputError(mechanism.file, note.line, note.text).what(); }

Reading read_urdf(const std::string& file, const ReadOptions& options) {
  const std::string text = load(file);
  tinyxml2::XMLDocument document;
  parse(file, text, document);
  const XMLElement* const root = document.RootElement();
  if (root == nullptr) throw InputError(file, 0, "has no element: write a <robot>");
  if (const XMLElement* const next = root->NextSiblingElement())
    throw InputError(file, next->GetLineNum(),
                     "a second element stands beside <" + std::string(root->Name()) + ">: write one robot a file");
  refuse_macros(file, root);
  Report report(file);
  const Element robot(root, report);
  check_robot(robot);
  Reading reading;
  reading.mechanism.name = robot.needed_name();
  reading.mechanism.file = file;
  const std::vector<Element> links = robot.children("link"), joints = robot.children("joint");
  if (std::max(links.size(), joints.size()) > most_links)
    throw InputError(file, 0,
                     "has " + std::to_string(links.size()) + " links and " + std::to_string(joints.size()) + " joints; " +
                         std::to_string(most_links) + " of each are read: is it one mechanism?");
  const Materials materials = read_materials(robot);
  std::vector<Link> read_links;
  read_links.reserve(links.size());
  for (const Element& link : links) read_links.push_back(read_link(link, materials, options));
  std::vector<NamedJoint> read_joints;
  read_joints.reserve(joints.size());
  for (const Element& joint : joints) read_joints.push_back(read_joint(joint));
  Tree(std::move(read_links), std::move(read_joints), report).build(reading.mechanism);
  report.refuse();
  reading.notes = report.notes();
  return reading;
}

}  // namespace lf::urdf
