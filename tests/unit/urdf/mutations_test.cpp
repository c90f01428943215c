// Two hundred files that are wrong in one place each: refused with file and line, or read into a mechanism that keeps its promises.
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <sstream>

#include "tests/unit/urdf/urdf_text.hpp"
#include "tests/unit/urdf/valid_mechanism.hpp"

namespace lf::urdf::test {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return (std::stringstream() << file.rdbuf()).str();
}

// With what none of the arms has: a mesh, a mimic of a mimic.
std::string hand() {
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child, const std::string& mimic) {
    return "<joint name=\"" + name + "\" type=\"revolute\">\n<parent link=\"" + parent + "\"/>\n<child link=\"" + child +
           "\"/>\n<axis xyz=\"0 1 0\"/>\n<limit lower=\"-1\" upper=\"1\" effort=\"2\" velocity=\"3\"/>\n" + mimic + "</joint>\n";
  };
  return with(body, "</robot>",
              "<link name=\"a\">\n<collision><geometry>\n<mesh filename=\"hand.stl\" scale=\"1 1 "
              "1\"/></geometry></collision></link>\n<link name=\"b\"/>\n<link name=\"c\"/>\n" +
                  joint("ja", "base", "a", "") + joint("jb", "base", "b", "<mimic joint=\"ja\" multiplier=\"-1\" offset=\"0\"/>\n") +
                  joint("jc", "a", "c", "<mimic joint=\"jb\" multiplier=\"1\" offset=\"0\"/>\n") + "</robot>");
}

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::size_t below(std::size_t end) { return end == 0 ? 0 : random_() % end; }

  // The places of `what` in a text, behind its first comment's end.
  static std::vector<std::size_t> places(const std::string& text, const std::string& what) {
    std::vector<std::size_t> found;
    const std::size_t comment = text.find("-->");
    for (std::size_t at = text.find(what, comment == std::string::npos ? 0 : comment); at != std::string::npos;
         at = text.find(what, at + 1))
      found.push_back(at);
    return found;
  }
  // One of them.
  std::size_t place(const std::string& text, const std::string& what) {
    const std::vector<std::size_t> all = places(text, what);
    EXPECT_FALSE(all.empty()) << what;
    return all.empty() ? 0 : all[below(all.size())];
  }
  // An attribute that is a number, at its first digit: [begin, end).
  std::pair<std::size_t, std::size_t> number(const std::string& text) {
    for (;;) {
      const std::size_t begin = place(text, "=\"") + 2;
      const std::size_t end = text.find_first_of(" \"", begin);
      if (text.find_first_not_of("0123456789.+-eE", begin) == end && end > begin) return {begin, end};
    }
  }
  // The value of one attribute `key`.
  std::pair<std::size_t, std::size_t> value(const std::string& text, const std::string& key) {
    const std::size_t begin = place(text, key + "=\"") + key.size() + 2;
    return {begin, text.find('"', begin)};
  }
  // Replaces the value of one `key` by that of another.
  std::string exchanged(std::string text, const std::string& key) {
    for (;;) {
      const auto [begin, end] = value(text, key);
      const auto [from, to] = value(text, key);
      const std::string other = text.substr(from, to - from);
      if (other != text.substr(begin, end - begin)) return text.replace(begin, end - begin, other);
    }
  }

 private:
  std::mt19937_64 random_;
};

struct Kind {
  const char* name;
  bool always_refused;
  std::function<std::string(std::string, Mutator&)> change;
};

std::string replaced(std::string text, std::pair<std::size_t, std::size_t> place, const std::string& by) {
  return text.replace(place.first, place.second - place.first, by);
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"a key is dropped", false,
       [](std::string text, Mutator& m) {
         const std::size_t quote = m.place(text, "=\""), begin = text.rfind(' ', quote), end = text.find('"', quote + 2) + 1;
         return text.erase(begin, end - begin);
       }},
      {"an element is dropped", false,
       [](std::string text, Mutator& m) {
         const std::size_t end = m.place(text, "/>") + 2, begin = text.rfind('<', end - 1);
         return text.erase(begin, end - begin);
       }},
      {"a number is negative", false,
       [](std::string text, Mutator& m) {
         const auto [begin, end] = m.number(text);
         return text[begin] == '-' ? text.erase(begin, 1) : text.insert(begin, 1, '-');
       }},
      {"a number is zero", false, [](std::string text, Mutator& m) { return replaced(text, m.number(text), "0"); }},
      {"a number is NaN", true, [](std::string text, Mutator& m) { return replaced(text, m.number(text), "nan"); }},
      {"a number is huge", true, [](std::string text, Mutator& m) { return replaced(text, m.number(text), "1e300"); }},
      {"a number is infinite", true, [](std::string text, Mutator& m) { return replaced(text, m.number(text), "1e999"); }},
      {"a decimal comma", true, [](std::string text, Mutator& m) { return replaced(text, m.number(text), "0,5"); }},
      {"xacro", true, [](std::string text, Mutator& m) { return replaced(text, m.number(text), "${x}"); }},
      {"a link's name twice", true,
       [](std::string text, Mutator& m) {
         const auto [begin, end] = m.value(text, "<link name");
         return text.insert(text.rfind("</robot>"), "<link name=\"" + text.substr(begin, end - begin) + "\"/>");
       }},
      {"a joint's name twice", true, [](std::string text, Mutator& m) { return m.exchanged(std::move(text), "<joint name"); }},
      {"a link carried twice", true, [](std::string text, Mutator& m) { return m.exchanged(std::move(text), "<child link"); }},
      {"a ring", true,
       [](std::string text, Mutator& m) {
         const auto [begin, end] = m.value(text, "<child link");
         const std::string child = text.substr(begin, end - begin);
         const std::size_t parent = text.rfind("<parent link=\"", begin) + 14;
         return text.replace(parent, text.find('"', parent) - parent, child);
       }},
      {"a mesh is missing", true,
       [](std::string text, Mutator& m) {
         const std::size_t begin = m.place(text, "<collision"), shape = text.find("<geometry>", begin) + 10,
                           end = text.find("</geometry>", shape);
         return text.replace(shape, end - shape, "<mesh filename=\"package://arm/nowhere.stl\"/>");
       }},
      {"a type is another", false,
       [](std::string text, Mutator& m) {
         const char* const types[] = {"fixed", "continuous", "prismatic", "floating", "Revolute", ""};
         return replaced(text, m.value(text, "type"), types[m.below(6)]);
       }},
      {"an unknown key", true, [](std::string text, Mutator& m) { return text.insert(m.place(text, "=\""), "x"); }},
      {"the file is cut off", true, [](std::string text, Mutator& m) { return text.substr(0, m.below(text.rfind("</robot>"))); }},
      {"bytes are noise", false,
       [](std::string text, Mutator& m) {
         for (int i = 0; i < 3; ++i) text[m.below(text.size())] = static_cast<char>(m.below(256));
         return text;
       }},
  };
  return all;
}

// Every line begins with the file; all but those that are about the whole file have a line.
bool has_places(const std::string& error, const std::string& file) {
  std::istringstream lines(error);
  bool all = !error.empty();
  for (std::string line; std::getline(lines, line);) {
    const bool whole_file = line.find("is empty") != std::string::npos || line.find("has no element") != std::string::npos ||
                            line.find("more problems") != std::string::npos;
    all = all && line.starts_with(file + ":") && (whole_file || std::isdigit(static_cast<unsigned char>(line[file.size() + 1])) != 0);
  }
  return all;
}

TEST(UrdfMutations, TwoHundredAreRefusedWithTheirPlaceOrReadIntoAValidMechanism) {
  constexpr std::uint64_t seed = 11;
  constexpr int wanted = 200;
  const lf::test::TemporaryFolder folder;
  folder.write("hand.stl", "solid x\nendsolid x\n");
  std::vector<std::string> originals{hand(), text_of(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf")};
  for (const std::string name : {"oberon7", "predator", "ur5", "panda", "open_manipulator_x"})
    originals.push_back(text_of(LANTERNFISH_TEST_DATA "/arms/" + name + "/" + name + ".urdf"));
  for (const std::string& original : originals) ASSERT_NO_THROW(read_urdf(folder.write("arm.urdf", original).string()));
  Mutator mutator(seed);
  int refused = 0, read = 0;
  std::map<std::string, std::pair<int, int>> by_kind;  // refused, read
  for (int i = 0; i < wanted; ++i) {
    const Kind& kind = kinds()[static_cast<std::size_t>(i) % kinds().size()];
    const std::string& original = originals[mutator.below(originals.size())];
    const std::string text = kind.change(original, mutator);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", change " + std::to_string(i) + ": " + kind.name);
    const std::string file = folder.write("arm.urdf", text).string();
    try {
      const Mechanism mechanism = read_urdf(file).mechanism;
      ++read;
      ++by_kind[kind.name].second;
      EXPECT_FALSE(kind.always_refused) << text;
      EXPECT_EQ(fault_of(mechanism), "");
    } catch (const InputError& error) {
      ++refused;
      ++by_kind[kind.name].first;
      EXPECT_TRUE(has_places(error.what(), file)) << error.what();
    }
  }
  EXPECT_EQ(refused + read, wanted);
  EXPECT_GE(refused, 130);  // eleven kinds in eighteen are refused always
  EXPECT_GE(read, 20);
  for (const auto& [kind, count] : by_kind)
    RecordProperty(kind, std::to_string(count.first) + " refused, " + std::to_string(count.second) + " read");
}

}  // namespace
}  // namespace lf::urdf::test
