// How results came about, as each JSON file of results says it under "provenance".
#pragma once

#include <nlohmann/json.hpp>

#include "host_sim/record/result.hpp"

namespace lf::record {

nlohmann::ordered_json provenance_json(const ProvenanceRecord& provenance);

}  // namespace lf::record
