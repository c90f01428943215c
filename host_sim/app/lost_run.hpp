// Why a run of a campaign left no result that counts.
#pragma once

#include <string>

namespace lf::app {

// `status` is waitpid()'s, `words` the last that the run said on stderr. `difference`: how the experiment in its folder differs from the campaign's, "" when
// there is none or it does not. A run that ended well flew something else, then: the program was built anew, or a file edited, since the campaign began.
std::string lost_reason(int status, const std::string& words, const std::string& difference);

}  // namespace lf::app
