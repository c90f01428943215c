// Where the codecs of pictures were found, for those who need no more than that.
#pragma once

#include <string>

namespace lf::vision {

// Loads them at the first call. Throws what picture_codecs() throws.
std::string picture_codecs_file();

}  // namespace lf::vision
