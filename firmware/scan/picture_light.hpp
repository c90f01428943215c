// How a picture as a whole is lit: dark, white, or without contrast. What a look that failed is told by.
#pragma once

#include "shared/messages/image.hpp"
#include "shared/messages/scan_messages.hpp"

namespace lf::scan {

// All zero for a picture that is not valid or has fewer than two squares of 8 pixels. O(width * height), no allocation: 0.1 ms for 640x480 on a desktop.
PictureLight picture_light(ImageView image);

}  // namespace lf::scan
