#include "tests/unit/scan/peak_table/formed_tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

namespace lf::test {
namespace {

constexpr double other_exposure = 1.6;  // on picture's over off picture's: an automatic exposure's jump

enum class Off { same, none, other };

struct Format {
  const char* name;
  int width, height, bits;
  std::vector<Off> kinds;
};

const std::vector<Off> all_kinds{Off::same, Off::none, Off::other};

const char* name_of(Off off) {
  if (off == Off::none) return "no off picture";
  return off == Off::same ? "off picture" : "off picture, other exposure";
}

std::string words(const char* format, double a, double b) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

// The same light and noise in the grey levels of a deeper picture.
FormedStripe in_bits(FormedStripe s, int bits) {
  const double finer = std::exp2(bits - 8);
  s.peak_grey *= finer;
  s.ambient_grey *= finer;
  s.read_noise_grey *= finer;
  s.electrons_per_grey /= finer;
  s.bits = bits;
  return s;
}

FormedStripe off_of_other_exposure(FormedStripe s) {
  s.peak_grey = 0;
  s.ambient_grey /= other_exposure;
  s.seed += 1'000'000;
  return s;
}

Shot shot_of(const FormedStripe& s, const FormedImage& image, Off off) {
  Shot shot{image, off != Off::none, (1 << s.bits) - 1};
  if (off == Off::other) shot.image.off = form(off_of_other_exposure(s)).off;
  return shot;
}

// Near the picture's left and right end the blur sees beyond it.
constexpr int border = 12;

// One way to take pictures, over several of them.
class Measurement {
 public:
  Measurement(const FormedStripe& s, Off off) : off_(off), width_(width_px(s)), ours_((1 << s.bits) - 1) {}

  // `at_steps`: only columns with a step within 2.5 widths of the stripe.
  void add(const FormedStripe& s, const FormedImage& image, bool at_steps) {
    const Shot shot = shot_of(s, image, off_);
    const std::array<Rows, 4> others = rows_of_others(shot, width_, off_ == Off::other ? other_exposure : 1);
    const std::array<Rows, 5> all{ours_.rows(shot), others[0], others[1], others[2], others[3]};
    for (int u = border; u < image.width - border; ++u) {
      const auto column = static_cast<std::size_t>(u);
      if (at_steps && image.to_edge_px[column] > 2.5 * width_) continue;
      for (std::size_t i = 0; i < all.size(); ++i) scores_[i].add(all[i][column], image.centre_px[column], std::max(2.0, width_));
    }
  }

  // The fit learns from a picture that does not count.
  void show(const FormedStripe& s, const FormedImage& image) { (void)ours_.rows(shot_of(s, image, off_)); }

  const Scores& scores() const { return scores_; }

 private:
  Off off_;
  double width_;
  DetectorAndFit ours_;
  Scores scores_;
};

FormedStripe plain(const Format& format, double beam_px, double speckle, std::uint64_t seed) {
  FormedStripe s;
  s.width = format.width;
  s.height = format.height;
  s.middle_px = 0.25 * format.height + 0.37;
  s.beam_sigma_px = beam_px;
  s.speckle = speckle;
  s.bars.contrast = 1;
  s.peak_grey = 90;
  s.seed = seed;
  return in_bits(s, format.bits);
}

// Two pictures, each with the kinds of off picture. The bound of another exposure is not known: it is higher than that of the same.
std::vector<TableRow> plain_rows(const FormedStripe& stripe, const std::string& scene, const std::vector<Off>& kinds, bool bound_known) {
  std::vector<Measurement> measurements;
  measurements.reserve(kinds.size());
  for (const Off off : kinds) measurements.emplace_back(stripe, off);
  FormedStripe s = stripe;
  for (int picture = 0; picture < 2; ++picture, ++s.seed) {
    const FormedImage image = form(s);
    for (Measurement& measurement : measurements) measurement.add(s, image, false);
  }
  std::vector<TableRow> rows;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    TableRow row{scene + ", " + name_of(kinds[i]), {}, measurements[i].scores(), Asked{}};
    if (bound_known && kinds[i] != Off::other) {
      row.bound_px = bound_px(s, kinds[i] == Off::same);
      row.asked->rms_px = 1.25 * *row.bound_px;
    }
    rows.push_back(row);
  }
  return rows;
}

// The peak in the picture, of a stripe at 6 sigmas of the difference's noise.
double faint_peak(const FormedStripe& s) {
  const double read = s.read_noise_grey * s.read_noise_grey + 1.0 / 12;
  return 6 * std::sqrt(2 * read + 2 * s.ambient_grey / s.electrons_per_grey) * width_px(s) / s.beam_sigma_px;
}

struct Water {
  const char* name;
  double scatter, speckle, asked_rms_px;
};
constexpr std::array<Water, 2> waters{{{"clear", 0, 0, 0.20}, {"hazy, speckle .18", 0.35, 0.18, 0.25}}};

// Calls visit(stripe, image) for six places of the steps: from one to the next the figure varies by 5 %.
template <class Visit>
void over_places(FormedStripe s, Visit visit) {
  for (int place = 1; place <= 6; ++place, ++s.seed) {
    s.bars.phase_px = 3.3 * place;
    visit(s, form(s));
  }
}

TableRow step_row(const FormedStripe& stripe, const std::string& scene, Off off, const Asked& asked) {
  Measurement measurement(stripe, off);
  over_places(stripe, [&](const FormedStripe& s, const FormedImage& image) { measurement.add(s, image, true); });
  return {scene, {}, measurement.scores(), asked};
}

// The bias alone: pictures without noise, after ones with it have told the optics; or without those.
TableRow bias_row(FormedStripe stripe, const std::string& scene, bool noisy_first) {
  Measurement measurement(stripe, Off::same);
  if (noisy_first) over_places(stripe, [&](const FormedStripe& s, const FormedImage& image) { measurement.show(s, image); });
  stripe.noise = false;
  over_places(stripe, [&](const FormedStripe& s, const FormedImage& image) { measurement.add(s, image, true); });
  return {scene, {}, measurement.scores(), Asked{.rms_px = 0.07, .percentile_999_px = {}}};
}

FormedStripe step(double beam_px, double angle_deg, const Water& water, std::uint64_t seed) {
  FormedStripe s;
  s.width = 320;
  s.height = 192;
  s.middle_px = 80.37;
  s.beam_sigma_px = beam_px;
  s.scatter_to_camera = water.scatter;
  s.speckle = water.speckle;
  s.bars.angle_rad = angle_deg * std::numbers::pi / 180;
  s.seed = seed;
  return s;
}

}  // namespace

std::vector<Table> plain_tables(std::uint64_t seed) {
  std::vector<Table> tables;
  const std::vector<Format> formats{{"640x480, 8 bits", 640, 480, 8, all_kinds},
                                    {"640x480, 12 bits", 640, 480, 12, {Off::same, Off::none}},
                                    {"1920x1080 (320 columns), 8 bits", 320, 1080, 8, {Off::same, Off::none}},
                                    {"1920x1080 (320 columns), 12 bits", 320, 1080, 12, {Off::same, Off::none}}};
  for (const Format& format : formats) {
    Table table{std::string("Plain paint, ") + format.name, {}};
    for (const double beam : {0.8, 1.2, 1.6, 2.4, 3.5, 5.0}) {
      for (const double speckle : {0.0, 0.18}) {
        table.parts.emplace_back([=] {
          return plain_rows(plain(format, beam, speckle, seed), words("beam %.1f, speckle %.2f", beam, speckle), format.kinds, true);
        });
      }
    }
    tables.push_back(table);
  }
  return tables;
}

Table hard_table(std::uint64_t seed) {
  Table table{"Plain paint, clipped and faint, 640x480, 8 bits, speckle .18", {}};
  const Format format{"", 640, 480, 8, all_kinds};
  for (const double beam : {0.8, 1.6, 2.4, 5.0}) {
    table.parts.emplace_back([=] {
      FormedStripe s = plain(format, beam, 0.18, seed);
      s.peak_grey = 400;
      return plain_rows(s, words("beam %.1f, clipped", beam, 0), all_kinds, false);
    });
    table.parts.emplace_back([=] {
      FormedStripe s = plain(format, beam, 0.18, seed);
      s.peak_grey = faint_peak(s);
      return plain_rows(s, words("beam %.1f, faint", beam, 0), all_kinds, true);
    });
  }
  return table;
}

Table step_table(std::uint64_t seed) {
  Table table{"Steps of 10:1, PSF 1.0 px, 8 bits (bias alone: 12 bits, no noise)", {}};
  for (const Water& water : waters) {
    for (const double beam : {1.2, 1.6, 2.4}) {
      for (const double angle : {0.0, 30.0, 60.0}) {
        const std::string scene = std::string(water.name) + words(", beam %.1f, %.0f deg", beam, angle);
        table.parts.emplace_back([=] {
          return std::vector{
              step_row(step(beam, angle, water, seed), scene, Off::same, {.rms_px = water.asked_rms_px, .percentile_999_px = 1.0})};
        });
      }
    }
  }
  for (const bool noisy_first : {true, false}) {
    for (const double beam : {1.2, 1.6, 2.4}) {
      const std::string scene = std::string(noisy_first ? "bias alone, clear" : "bias alone, clear, no noisy picture before") +
                                words(", beam %.1f, %.0f deg", beam, 30);
      table.parts.emplace_back([=] { return std::vector{bias_row(in_bits(step(beam, 30, waters[0], seed), 12), scene, noisy_first)}; });
    }
  }
  for (const Off off : {Off::none, Off::other}) {
    table.parts.emplace_back([=] {
      const Asked asked = off == Off::other ? Asked{.rms_px = 0.20, .percentile_999_px = 1.0} : Asked{};
      return std::vector{step_row(step(1.6, 30, waters[0], seed), std::string("clear, beam 1.6, 30 deg, ") + name_of(off), off, asked)};
    });
  }
  return table;
}

}  // namespace lf::test
