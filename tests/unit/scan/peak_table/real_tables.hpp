// The tables of real pictures.
#pragma once

namespace lf::test {

void print_real_pairs();  // laser_on_off_pairs: columns right, wrong and elsewhere, by their reference
void print_real_weld();   // weld_stripe_speckle: scatter about its straight pieces

}  // namespace lf::test
