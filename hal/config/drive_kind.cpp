#include "hal/config/drive_kind.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <set>
#include <system_error>

#include "firmware/canopen/emcy.hpp"
#include "hal/config/nearest.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "hal/config/yaml_reader.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

namespace {

using canopen::Substitute;

constexpr std::array<std::pair<const char*, Substitute>, 9> substitute_words{{
    {"other_object", Substitute::other_object},
    {"vendor_limit", Substitute::vendor_limit},
    {"master_limits_speed", Substitute::master_limits_speed},
    {"master_limits_position", Substitute::master_limits_position},
    {"master_times_following", Substitute::master_times_following},
    {"no_feed_forward", Substitute::no_feed_forward},
    {"configured_rating", Substitute::configured_rating},
    {"node_guarding", Substitute::node_guarding},
    {"fixed_by_maker", Substitute::fixed_by_maker},
}};

std::vector<std::string> words_of_substitutes() {
  std::vector<std::string> words;
  words.reserve(substitute_words.size());
  for (const auto& [word, substitute] : substitute_words) words.emplace_back(word);
  return words;
}

const std::vector<std::string> types{"u8", "u16", "u32", "i8", "i16", "i32"};
const std::vector<std::string> figures{"rated_current_ma", "rated_torque_mnm", "rated_torque_unm", "counts_per_rev"};

bool fits(std::int64_t value, const std::string& type) {
  const int bits = std::stoi(type.substr(1));
  const std::int64_t span = std::int64_t{1} << bits;
  return type.front() == 'i' ? value >= -span / 2 && value < span / 2 : value >= 0 && value < span;
}

// What the boot and the axis write themselves. A profile that wrote the controlword would give a drive power before the emergency-stop chain was heard.
bool is_the_masters(std::uint16_t index) {
  constexpr std::array<std::uint16_t, 12> single{0x6007, 0x6040, 0x605A, 0x605B, 0x605C, 0x605D,
                                                 0x605E, 0x6060, 0x6071, 0x607A, 0x60B2, 0x60FF};
  const bool communication = index >= 0x1005 && index <= 0x1029, process_data = index >= 0x1400 && index <= 0x1BFF;
  return communication || process_data || std::find(single.begin(), single.end(), index) != single.end();
}

// "607D:01", or "607D" for its sub-index 0.
bool object_number(const std::string& text, std::uint16_t& index, std::uint8_t& sub) {
  const std::size_t colon = text.find(':');
  const std::string head = text.substr(0, colon), tail = colon == std::string::npos ? "00" : text.substr(colon + 1);
  const auto read = [](const std::string& digits, std::size_t count, auto& value) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    return digits.size() == count && error == std::errc() && end == digits.data() + digits.size();
  };
  return read(head, 4, index) && read(tail, 2, sub);
}

Keys scalar_keys(DriveKind& k, std::string& like, std::string& vendor, std::string& product) {
  constexpr double most = 1e9;
  const auto scale = [&](Keys& all, const std::string& name, const std::string& per, UnitScale& unit) {
    all.push_back(key(name + ".units_per_count" + per, "", 1e-6, most, &unit.per_count, ""));
    all.push_back(key(name + ".units_per_rev" + per, "", 1e-6, most, &unit.per_rev, ""));
  };
  Keys all;
  all.push_back(key("title", "", 0, 0, &k.title, ""));
  all.push_back(key("like", "", 0, 0, &like, ""));
  all.push_back(key("identity.vendor", "", 0, 0, &vendor, ""));
  all.push_back(key("identity.product", "", 0, 0, &product, ""));
  scale(all, "position", "", k.position);
  scale(all, "speed", "_s", k.speed);
  scale(all, "acceleration", "_s2", k.acceleration);
  all.push_back(key("torque.basis", "", 0, 0, &k.torque_basis, "", {"torque", "current", "raw"}));
  all.push_back(key("torque.rating", "", 0, 0, &k.rating, "", {"object", "configured"}));
  all.push_back(key("torque.rating_unit_unm", "", 1, 1e9, &k.rating_unit_unm, ""));
  all.push_back(key("torque.units_per_a", "", 1e-3, 1e6, &k.units_per_a, ""));
  all.push_back(key("options.quick_stop", "", 1, 8, &k.quick_stop, ""));
  all.push_back(key("options.quick_stop_fallback", "", 1, 8, &k.quick_stop_fallback, ""));
  all.push_back(key("options.abort", "", 1, 3, &k.abort, ""));
  all.push_back(key("options.abort_fallback", "", 1, 3, &k.abort_fallback, ""));
  all.push_back(key("options.shutdown", "", 0, 1, &k.shutdown, ""));
  all.push_back(key("options.disable", "", 0, 1, &k.disable, ""));
  all.push_back(key("options.fault", "", 0, 4, &k.fault, ""));
  all.push_back(key("options.following_timeout_ms", "ms", 0, 60000, &k.following_timeout_ms, ""));
  all.push_back(key("waits_to_follow", "", 0, 0, &k.waits_to_follow, ""));
  all.push_back(key("brake.opens_ms", "ms", 0, 10000, &k.brake_opens_ms, ""));
  all.push_back(key("brake.closes_ms", "ms", 0, 10000, &k.brake_closes_ms, ""));
  all.push_back(key("sync_loss", "", 0, 0, &k.sync_loss, ""));
  all.push_back(key("mapping.most_objects", "", 1, 64, &k.most_mapped, ""));
  all.push_back(key("homing.methods", "", -128, 127, &k.homing_methods, ""));
  all.push_back(key("position_lost", "", 0, 0, &k.position_lost, ""));
  all.push_back(key("unconfirmed", "", 0, 0, &k.unconfirmed, ""));
  return all;
}

// One reading of a file: goes on after each problem.
class Reader {
 public:
  Reader(const std::filesystem::path& file, std::vector<std::string>& problems)
      : source_(Source::of_file(file.string(), problems)), problems_(problems) {}

  // Over what `kind` has already, from the file that this one is like.
  void read(const YAML::Node& root, DriveKind& kind) {
    YAML::Node scalars(YAML::NodeType::Map);
    for (const auto& entry : root) {
      const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "";
      if (name == "check" || name == "write")
        each(entry.second, name, [&](const YAML::Node& item) { read_object(item, name == "write", kind); });
      else if (name == "absent")
        each(entry.second, name, [&](const YAML::Node& item) { read_absence(item, kind); });
      else if (name == "errors")
        attempt([&] { read_errors(entry.second, kind); });
      else
        scalars.force_insert(entry.first, entry.second);
    }
    // One scale a quantity: a file's own takes the place of the one that it was like.
    const auto own_scale = [&](const char* name, UnitScale& unit) {
      const YAML::Node own = root[name];
      if (own && own.IsMap() &&
          std::any_of(own.begin(), own.end(), [](const auto& e) { return e.first.Scalar().starts_with("units_per_"); }))
        unit = {};
    };
    own_scale("position", kind.position);
    own_scale("speed", kind.speed);
    own_scale("acceleration", kind.acceleration);
    std::string like, vendor, product;
    read_map(scalars, "", "", scalar_keys(kind, like, vendor, product), source_);
    attempt([&] { read_identity(vendor, scalars, "vendor", kind.identity.vendor); });
    attempt([&] { read_identity(product, scalars, "product", kind.identity.product); });
    const YAML::Node homing = root["homing"];
    if (homing && homing.IsMap() && homing["methods"]) kind.any_homing = false;
  }

  void check_whole(const YAML::Node& root, const DriveKind& kind) {
    const auto scale = [&](const char* name, const UnitScale& unit) {
      attempt([&] {
        if ((unit.per_count > 0) != (unit.per_rev > 0)) return;
        source_.refuse(root[name] ? root[name].Mark() : root.Mark(),
                       std::string("'") + name +
                           "' takes one scale above 0, in one of the arm's counts or in one revolution of the motor: nothing is assumed");
      });
    };
    scale("position", kind.position);
    scale("speed", kind.speed);
    scale("acceleration", kind.acceleration);
    attempt([&] {
      if (kind.torque_basis.empty()) source_.refuse(root.Mark(), "'torque.basis' is missing: what 6077 is a part of is not assumed");
    });
    attempt([&] {
      if (kind.torque_basis == "raw" && kind.units_per_a <= 0)
        source_.refuse(root.Mark(), "'torque.basis' is raw, and 'torque.units_per_a' is missing");
    });
    attempt([&] {
      if (kind.title.empty()) source_.refuse(root.Mark(), "'title' is missing");
    });
    attempt([&] {
      const ProfileAbsence* rating = kind.absence(0x6076);
      if (kind.rating == "object" && rating != nullptr && rating->by == Substitute::configured_rating)
        source_.refuse(root.Mark(), "'absent' has 6076:00 by configured_rating, and 'torque.rating' is object: make it configured");
    });
    // Those of `options` are written, too: 605B, 605C and 605E.
    attempt([&] {
      if (kind.objects.size() + 3 > canopen::DriveProfile::max_objects)
        source_.refuse(root.Mark(), "'check' and 'write' have more objects than the core holds, " +
                                        std::to_string(canopen::DriveProfile::max_objects - 3));
    });
    const YAML::Node codes = root["position_lost"];  // unless they are those of the file that this one is like
    for (std::size_t i = 0; i < kind.position_lost.size(); ++i) {
      attempt([&] {
        const std::string& text = kind.position_lost[i];
        std::uint16_t code = 0;
        std::uint8_t none = 0;
        const bool own = codes && codes.IsSequence() && i < codes.size();
        if (text.size() != 4 || !object_number(text, code, none) || code == 0)
          source_.refuse(own ? codes[i].Mark() : root.Mark(),
                         "'position_lost' takes EMCY codes of 4 hex digits in quotes, not '" + text + "'");
      });
    }
    attempt([&] {
      if (kind.position_lost.size() > canopen::DriveProfile::max_position_lost)
        source_.refuse(root.Mark(),
                       "'position_lost' has more codes than the core holds, " + std::to_string(canopen::DriveProfile::max_position_lost));
    });
    attempt([&] {
      if (kind.absences.size() > canopen::DriveProfile::max_absences)
        source_.refuse(root.Mark(),
                       "'absent' has more objects than the core holds, " + std::to_string(canopen::DriveProfile::max_absences));
    });
  }

  const Source& source() const { return source_; }

 private:
  template <class Step>
  void attempt(Step step) {
    try {
      step();
    } catch (const InputError& problem) {
      problems_.emplace_back(problem.what());
    }
  }
  template <class Step>
  void each(const YAML::Node& list, const std::string& name, Step step) {
    attempt([&] {
      if (!list.IsSequence()) source_.refuse(list.Mark(), "'" + name + "' takes a list of objects");
    });
    if (!list.IsSequence()) return;
    for (const YAML::Node& item : list) attempt([&] { step(item); });
  }

  void read_identity(const std::string& text, const YAML::Node& root, const char* name, std::uint32_t& id) const {
    if (text.empty()) return;
    std::int64_t value = 0;
    const YAML::Node node = root["identity"][name];
    if (!whole_number(text, value) || value < 0)
      source_.refuse(node.Mark(), std::string("'identity.") + name + "' takes a number from 0 to 0xFFFFFFFF, not '" + text + "'");
    id = static_cast<std::uint32_t>(value);
  }

  void number_of(const YAML::Node& item, const std::string& text, std::uint16_t& index, std::uint8_t& sub) const {
    if (!object_number(text, index, sub))
      source_.refuse(item.Mark(), "an object is 4 hex digits, a colon and 2: \"60A8:00\", not '" + text + "'");
  }

  void read_object(const YAML::Node& item, bool writes, DriveKind& kind) const {
    if (!item.IsMap()) source_.refuse(item.Mark(), "takes {object: , type: , value: }");
    ProfileObject object;
    object.writes = writes;
    std::string number;
    const Source strict = Source::of_file(source_.name());
    read_map(
        item, "", "",
        {key("object", "", 0, 0, &number, ""), key("type", "", 0, 0, &object.type, "", types), key("value", "", 0, 0, &object.value, ""),
         key("optional", "", 0, 0, &object.optional, ""), key("why", "", 0, 0, &object.why, "")},
        strict);
    number_of(item, number, object.index, object.sub);
    if (writes && is_the_masters(object.index))
      source_.refuse(item.Mark(),
                     "object " + number + " is the master's to write: it powers the drive, stops it, or carries its process data");
    if (object.type.empty()) source_.refuse(item.Mark(), "object " + number + " has no type");
    std::int64_t value = 0;
    const bool number_given = whole_number(object.value, value);
    if (number_given && !fits(value, object.type))
      source_.refuse(item.Mark(), "object " + number + ": " + object.value + " does not fit " + object.type);
    if (!number_given && std::find(figures.begin(), figures.end(), object.value) == figures.end()) {
      const std::string nearest = suggestion(object.value, figures);
      source_.refuse(item.Mark(),
                     "object " + number + " takes a whole number or a figure of the motor, not '" + object.value + "'" +
                         (nearest.empty() ? "; there are rated_current_ma, rated_torque_mnm, rated_torque_unm, counts_per_rev" : nearest));
    }
    kind.objects.push_back(object);
  }

  void read_absence(const YAML::Node& item, DriveKind& kind) const {
    if (!item.IsMap()) source_.refuse(item.Mark(), "takes {object: , by: }");
    ProfileAbsence absence;
    std::string number, by;
    const Source strict = Source::of_file(source_.name());
    read_map(item, "", "",
             {key("object", "", 0, 0, &number, ""), key("by", "", 0, 0, &by, "", words_of_substitutes()),
              key("use", "", 0, 0, &absence.use, ""), key("why", "", 0, 0, &absence.why, "")},
             strict);
    number_of(item, number, absence.index, absence.sub);
    for (const auto& [word, substitute] : substitute_words) {
      if (by == word) absence.by = substitute;
    }
    if (absence.by == Substitute::none) source_.refuse(item.Mark(), "object " + number + ": 'by' names no substitute");
    check_substitute(item, number, absence);
    std::uint16_t index = 0;
    std::uint8_t sub = 0;
    const bool redirects = absence.by == Substitute::other_object;
    if (redirects && !object_number(absence.use, index, sub))
      source_.refuse(item.Mark(), "object " + number + ": 'use' names the other object, as \"30B0:00\"");
    if (!redirects && !absence.use.empty()) source_.refuse(item.Mark(), "object " + number + ": 'use' goes with other_object only");
    kind.absences.push_back(absence);
  }

  // "1016" is short for 1016:00, and the boot writes 1016:01.
  static std::string nearest_sub(const ProfileAbsence& absence) {
    for (const std::uint8_t sub : {std::uint8_t{0}, std::uint8_t{1}}) {
      if (substitutes_of(absence.index, sub).front() != Substitute::none)
        return "; did you mean \"" + object_text(absence.index, sub) + "\"?";
    }
    return "";
  }

  // A word that does nothing in this object's place would leave its work undone: a drive without 1016 and without guarding runs on when its master dies.
  void check_substitute(const YAML::Node& item, const std::string& number, const ProfileAbsence& absence) const {
    const Substitutes allowed = substitutes_of(absence.index, absence.sub);
    if (allowed.front() == Substitute::none)
      source_.refuse(item.Mark(), "'absent' names " + object_text(absence.index, absence.sub) +
                                      ", which the boot does not write and cannot do without" + nearest_sub(absence));
    if (std::find(allowed.begin(), allowed.end(), absence.by) != allowed.end()) return;
    std::string list;
    for (const auto& [word, substitute] : substitute_words) {
      const bool fits = std::find(allowed.begin(), allowed.end(), substitute) != allowed.end();
      if (fits) list += (list.empty() ? "" : " or ") + std::string(word);
    }
    source_.refuse(item.Mark(), "object " + number + ": 'by' takes " + list);
  }

  void read_errors(const YAML::Node& map, DriveKind& kind) const {
    if (!map.IsMap()) source_.refuse(map.Mark(), "'errors' takes codes and their texts");
    for (const auto& entry : map) {
      const std::string text = entry.first.Scalar();
      std::uint16_t code = 0;
      std::uint8_t none = 0;
      if (text.size() != 4 || !object_number(text, code, none))
        source_.refuse(entry.first.Mark(), "an error code is 4 hex digits, not '" + text + "'");
      if (!entry.second.IsScalar()) source_.refuse(entry.second.Mark(), "an error has a text");
      kind.errors[code] = entry.second.Scalar();
    }
  }

  Source source_;
  std::vector<std::string>& problems_;
};

std::string like_forms(const std::filesystem::path& file) {
  std::string list;
  for (const std::string& name : shipped_drive_kinds()) list += (list.empty() ? "" : ", ") + name;
  return "It takes the name of a shipped profile (" + list + "), or the name without .yaml of a file in " +
         std::filesystem::absolute(file).parent_path().string();
}

// `depth`: how many files stand over this one. A chain of more than 4 is a circle.
DriveKind read_with_base(const std::filesystem::path& file, std::vector<std::string>& problems, int depth) {
  Reader reader(file, problems);
  const YAML::Node root = parse_yaml(read_text_file(file.string()), reader.source());
  if (!root.IsMap()) reader.source().refuse(root.Mark(), "a drive's profile is a group of keys");
  DriveKind kind;
  const YAML::Node like = root["like"];
  if (like && !like.IsScalar()) reader.source().refuse(like.Mark(), "'like' takes one name. " + like_forms(file));
  if (like) {
    if (depth >= 4) reader.source().refuse(like.Mark(), "'like' leads in a circle");
    const std::filesystem::path beside = file.parent_path() / (like.Scalar() + ".yaml");
    const std::filesystem::path shipped = share_folder() / "drives" / (like.Scalar() + ".yaml");
    std::error_code ignored;  // a name that is no file's, too long for instance, is not there
    const std::filesystem::path& base = std::filesystem::exists(beside, ignored) ? beside : shipped;
    if (!std::filesystem::exists(base, ignored)) {
      const std::string nearest = suggestion(like.Scalar(), shipped_drive_kinds());
      reader.source().refuse(like.Mark(),
                             "no profile '" + like.Scalar() + "' for 'like'" + (nearest.empty() ? ". " : nearest + " ") + like_forms(file));
    }
    kind = read_with_base(base, problems, depth + 1);
    kind.like.insert(kind.like.begin(), kind.file);
  }
  kind.name = file.stem().string();
  kind.file = file.string();
  reader.read(root, kind);
  if (depth == 0) reader.check_whole(root, kind);
  return kind;
}

}  // namespace

bool whole_number(const std::string& text, std::int64_t& value) {
  const bool negative = text.starts_with('-');
  std::string_view digits(text);
  if (negative) digits.remove_prefix(1);
  const bool hex = digits.starts_with("0x") || digits.starts_with("0X");
  if (hex) digits.remove_prefix(2);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, hex ? 16 : 10);
  if (negative) value = -value;
  return error == std::errc() && end == digits.data() + digits.size() && value >= INT32_MIN && value <= UINT32_MAX;
}

const ProfileAbsence* DriveKind::absence(std::uint16_t index) const {
  const auto found = std::find_if(absences.begin(), absences.end(), [index](const ProfileAbsence& a) { return a.index == index; });
  return found == absences.end() ? nullptr : &*found;
}

std::string DriveKind::error_text(std::uint16_t code) const {
  const auto found = errors.find(code);
  return found == errors.end() ? canopen::emcy_name(code) : found->second;
}

DriveKind read_drive_kind(const std::filesystem::path& file) {
  std::vector<std::string> problems;
  DriveKind kind = read_with_base(file, problems, 0);
  if (problems.empty()) return kind;
  std::string all;
  for (const std::string& problem : problems) all += (all.empty() ? "" : "\n") + problem;
  throw InputError(all);
}

std::vector<std::string> shipped_drive_kinds() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(share_folder() / "drives")) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

DriveKind find_drive_kind(const std::string& name_or_file, const std::filesystem::path& folder) {
  const bool is_file = name_or_file.find('/') != std::string::npos || name_or_file.ends_with(".yaml");
  if (is_file) return read_drive_kind(find_file(name_or_file, folder));
  const std::vector<std::string> names = shipped_drive_kinds();
  if (std::find(names.begin(), names.end(), name_or_file) != names.end())
    return read_drive_kind(share_folder() / "drives" / (name_or_file + ".yaml"));
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  const std::string nearest = suggestion(name_or_file, names);
  throw InputError("no drive profile '" + name_or_file + "'" + (nearest.empty() ? "; there are " + list + ", or give a file" : nearest));
}

}  // namespace lf::config
