// The field's estimators of a stripe's centre in one column, for comparison: they are told the stripe's true width.
#pragma once

#include "tests/unit/scan/formed_stripe.hpp"

namespace lf::test {

// Of on less off, over `half` rows to either side of `middle`.
double centre_of_mass(const FormedImage& image, int u, int middle, int half);

// The row where the Laplacian of Gaussian responds most, to a whole row, in the whole column.
int log_row(const FormedImage& image, int u, double sigma_px);

// The same from a start, within 1.5 sigmas of it and between rows: the response's own maximum, by a parabola.
double log_centre(const FormedImage& image, int u, double start, double sigma_px);

// Least squares of height * off * bell, weighted by the noise of both pictures, within two sigmas of the start: the paint times the light, as if no lens blurred them.
double product_centre(const FormedImage& image, int u, double start, double sigma_px);

}  // namespace lf::test
