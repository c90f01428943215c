// A scene's file: read, or refused with an InputError.
#include "host_sim/scenario/scene_file.hpp"
#include "shared/input_error.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static lf::fuzz::MemoryFile file;
  try {
    const lf::scenario::SceneFile scene = lf::scenario::read_scene_file(file.holding({data, size}));
    for (const lf::scene::Body& body : lf::scenario::placed_objects(scene, lf::Pose::Identity())) {
      lf::fuzz::expect(!body.name.empty() && body.shapes.size() == 1, "an object has a name and a shape");
      lf::fuzz::expect(body.base_from_body.matrix().allFinite(), "its place is a number");
    }
  } catch (const lf::InputError& refused) {
    lf::fuzz::expect(refused.what()[0] != '\0', "a refusal says why");
  }
  return 0;
}
