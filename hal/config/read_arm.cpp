#include "hal/config/read_arm.hpp"

#include "shared/arm/make_model.hpp"

namespace lf::config {

arm::Arm read_arm(const std::string& urdf_file) { return arm::Arm(make_model(load_arm_urdf(urdf_file))); }

}  // namespace lf::config
