// Steger's detector of bright lines: C. Steger, An Unbiased Detector of Curvilinear Structures, IEEE PAMI 20(2), 1998.
//
// The picture is convolved with a Gaussian's derivatives. The Hessian's eigenvector of the largest eigenvalue (in size) is the line's normal; along it the picture's Taylor
// series has its maximum at a sub-pixel place. Where that lies inside the pixel, the pixel is on a line. Written from the paper.
#pragma once

#include <vector>

#include "tests/unit/scan/formed_stripe.hpp"

namespace lf::test {

// The Gaussian's sigma for a stripe of this width: the paper asks for at least w / sqrt(3), w half of a bar's width. The bar with a Gaussian's variance has w = sqrt(3) sigma.
double ridge_sigma_px(double stripe_sigma_px);

// Row of the strongest line's point in each column of on less off, brought to the column's middle along the line. NaN: no pixel of the column is on a bright line.
std::vector<double> ridge_rows(const FormedImage& image, double sigma_px);

}  // namespace lf::test
