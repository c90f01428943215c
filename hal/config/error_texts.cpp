#include "hal/config/error_texts.hpp"

#include <utility>

#include "firmware/canopen/emcy.hpp"

namespace lf::config {

void ErrorTexts::set(std::size_t joint, std::uint8_t node, std::map<std::uint16_t, std::string> texts) {
  drives_.at(joint) = {node, std::move(texts)};
}

std::string ErrorTexts::of_joint(std::int32_t joint, std::uint16_t code) const {
  if (joint < 0 || joint >= static_cast<std::int32_t>(names_.size())) return canopen::emcy_name(code);
  const auto& texts = drives_[static_cast<std::size_t>(joint)].texts;
  const auto found = texts.find(code);
  return found == texts.end() ? canopen::emcy_name(code) : found->second;
}

std::string ErrorTexts::node_name(std::int32_t index) const {
  const bool known = index >= 0 && index < static_cast<std::int32_t>(names_.node_count());
  return known ? names_.node(static_cast<std::size_t>(index)) : std::to_string(index);
}

std::string ErrorTexts::of_node(std::int32_t node, std::uint16_t code) const {
  for (std::size_t joint = 0; joint < names_.size(); ++joint) {
    if (drives_[joint].node == node) return of_joint(static_cast<std::int32_t>(joint), code);
  }
  return canopen::emcy_name(code);
}

}  // namespace lf::config
