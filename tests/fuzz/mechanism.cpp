// Any URDF: a mechanism that keeps what its header promises, or an InputError whose every line begins with the file.
#include <sstream>

#include "shared/input_error.hpp"
#include "shared/urdf/read_urdf.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/unit/urdf/motion.hpp"
#include "tests/unit/urdf/valid_mechanism.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static lf::fuzz::MemoryFile file;
  const std::string path = file.holding({data, size});
  try {
    const lf::urdf::Reading reading = lf::urdf::read_urdf(path);
    const lf::urdf::Mechanism& mechanism = reading.mechanism;
    const std::string fault = lf::urdf::test::fault_of(mechanism);
    lf::fuzz::expect(fault.empty(), fault.c_str());
    for (const lf::urdf::Note& note : reading.notes) lf::fuzz::expect(note.line > 0 && !note.text.empty(), "a note has a line and a text");
    const std::vector<lf::urdf::Step> way = mechanism.path(lf::urdf::Mechanism::root, mechanism.links.size() - 1);
    const std::vector<double> q = lf::urdf::coordinates(mechanism, {}, {});
    lf::fuzz::expect(lf::urdf::begin_from_end(mechanism, way, q).matrix().allFinite(), "a link is somewhere");
    lf::fuzz::expect(lf::urdf::jacobian(mechanism, way, q).allFinite(), "a link moves somehow");
  } catch (const lf::InputError& refused) {
    std::istringstream lines(refused.what());
    std::string line;
    lf::fuzz::expect(static_cast<bool>(std::getline(lines, line)), "a refusal says why");
    do lf::fuzz::expect(line.starts_with(path + ":") && line.size() > path.size() + 8, "a refusal says where");
    while (std::getline(lines, line));
  }
  return 0;
}
