// campaign.json: a campaign as data, to be read by scripts and compared with later ones.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "host_sim/campaign/campaign.hpp"

namespace lf::campaign {

inline constexpr const char* campaign_file = "campaign.json";

// Keys in the order that a reader wants them; a figure that a run does not have is null.
nlohmann::ordered_json json_of(const Campaign& campaign);

// `path`: the file, or the folder that holds it. Throws InputError where there is none, and for one that is not a campaign's.
Campaign read_campaign(const std::filesystem::path& path);

}  // namespace lf::campaign
