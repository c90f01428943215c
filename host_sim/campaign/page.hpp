// campaign.html: one self-contained file that shows a campaign to a person. It opens from disk, refers to nothing but the runs' own reports beside it, and
// needs no script.
#pragma once

#include <string>

#include "host_sim/campaign/comparison.hpp"

namespace lf::campaign {

inline constexpr const char* page_file = "campaign.html";

// `comparison` may be null. Deterministic: equal data, equal bytes. All text is escaped.
std::string page_html(const Campaign& campaign, const Comparison* comparison);

}  // namespace lf::campaign
