// Whether two counts differ, or one rose, by more than chance: exact tests.
#pragma once

#include <cstddef>

namespace lf::campaign {

// Fisher's exact test of `hits_a` of `of_a` against `hits_b` of `of_b`, for runs that have nothing in common. The sum of the probabilities of all tables
// with these margins that are no more probable than this one. 1 without runs.
double fisher(std::size_t hits_a, std::size_t of_a, std::size_t hits_b, std::size_t of_b);

// McNemar's exact test, for runs in pairs: `gained` pairs went from failure to success, `lost` the other way. By chance either is as probable.
double mcnemar(std::size_t gained, std::size_t lost);

// The same one-sided: the probability that by chance as many hits or more fall to b (Fisher), or as many pairs or more are lost (McNemar).
double fisher_rise(std::size_t hits_a, std::size_t of_a, std::size_t hits_b, std::size_t of_b);
double mcnemar_rise(std::size_t gained, std::size_t lost);

}  // namespace lf::campaign
