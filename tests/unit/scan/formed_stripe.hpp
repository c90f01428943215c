// Pictures of a laser stripe as water, lens and sensor form them, with the stripe's true centre in each column.
//
// stripe_image.hpp multiplies a finished stripe onto a finished picture. A camera does not: it sees paint times light, and blurs the product. Here the
// order is that of nature. The water widens the laser's light on its way to the paint. What the paint sends back is scattered on the way to the camera, and blurred by the
// lens. Each pixel adds it up; speckle, the electrons' noise and rounding follow. Each part is written from the publication that is named beside it, and
// shares no code with the simulator or the detector.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace lf::test {

// Bars of light and dark paint of the same width, or one edge.
struct Bars {
  double angle_rad = 0;      // of the edges' normal to the columns; 0: each edge is a row
  double width_px = 12;      // of a bar, along the normal
  double phase_px = 0;       // of an edge, along the normal from row 0 of column 0: light before it, dark behind it
  double contrast = 10;      // light paint over dark paint; 1: plain paint
  bool single_edge = false;  // no other edge
};

struct FormedStripe {
  int width = 160, height = 96;
  double beam_sigma_px = 1.6;    // of the laser's light on the surface, before the water widens it
  double lens_sigma_px = 1.0;    // Gaussian; the pixel's aperture comes on top
  double slope = 0.1;            // rows a column
  double middle_px = 48.37;      // the stripe's row in column 0
  double peak_grey = 200;        // of the beam on light paint in clear water, before lens and pixel
  double ambient_grey = 110;     // of light paint
  double scatter_to_camera = 0;  // exp(b R) - 1: light that turns on the camera's way, over the direct light
  double scatter_to_panel = 0;   // the same on the laser's way
  double speckle = 0;            // contrast of one pixel of the laser's light
  double read_noise_grey = 1.5;
  double electrons_per_grey = 40;
  int bits = 8;
  bool noise = true;  // false: no speckle, no noise, no rounding, no clipping
  Bars bars;
  std::uint64_t seed = 1;
};

struct FormedImage {
  int width = 0, height = 0;
  std::vector<double> on, off;     // grey levels
  std::vector<double> centre_px;   // the stripe's row in each column
  std::vector<double> to_edge_px;  // rows from there to the nearest edge of the paint; 1e9 where there is none

  double at(const std::vector<double>& plane, int u, int v) const {
    return plane[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)];
  }
  // The laser's light alone: on less off.
  double stripe(int u, int v) const { return at(on, u, v) - at(off, u, v); }
};

FormedImage form(const FormedStripe& stripe);

// Standard deviation of the stripe in the picture: the beam's, the lens' and the pixel's.
double width_px(const FormedStripe& stripe);

// The bound of a centre on plain paint: speckle moves a centre of mass by contrast * sqrt(sigma / (4 sqrt(pi))), a closed form; the sensor's noise moves a
// fit by what the integral over a bell leaves, with the noise of both pictures at each row, or of the one.
double bound_px(const FormedStripe& stripe, bool with_off = true);

// Calls visit(stripe, image, columns) for pictures of the stripe with edges at every `step_deg` from 0 to 90 degrees, two of each. The columns are those whose edge
// lies within 2.5 widths of the stripe.
using VisitEdges = std::function<void(const FormedStripe&, const FormedImage&, const std::vector<int>& columns)>;
void over_edges(FormedStripe stripe, int step_deg, const VisitEdges& visit);

}  // namespace lf::test
