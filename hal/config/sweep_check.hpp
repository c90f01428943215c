// Whether the arm can carry the laser over the panel, wherever the docked vehicle may have brought the panel, without coming near to anything: what the
// mission's first motions ask for, worked out before they are ordered.
#pragma once

#include <optional>
#include <string>

#include "firmware/config.hpp"
#include "hal/config/panel_survey.hpp"
#include "shared/arm/joint_names.hpp"

namespace lf::config {

// One sentence without the file's name, or nothing. It names the part of the panel, the box or the capsule that is in the way. Takes some milliseconds.
std::optional<std::string> sweep_problem(const ControllerConfig& controller, const JointNames& names, const PanelSurvey& survey);

// The same of the folded pose alone, with the jaw at any angle: of an arm that is given no job.
std::optional<std::string> fold_problem(const ControllerConfig& controller, const PanelSurvey& survey);

}  // namespace lf::config
