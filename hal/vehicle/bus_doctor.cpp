#include "hal/vehicle/bus_doctor.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "firmware/canopen/cob_id.hpp"

namespace lf::hal {

namespace {

constexpr Duration answer_time = Duration::from_ms(30);  // an idle server answers within a few milliseconds

struct Place {
  std::uint16_t index;
  std::uint8_t sub;
};

// In the order of the boot. The first one says whether anybody is there.
constexpr std::array<Place, 62> places{{
    {0x1000, 0}, {0x1008, 0}, {0x1018, 1}, {0x1018, 2}, {0x1018, 3}, {0x1005, 0}, {0x1006, 0}, {0x1014, 0}, {0x100C, 0},
    {0x100D, 0}, {0x1016, 1}, {0x1017, 0}, {0x1029, 1}, {0x6007, 0}, {0x603F, 0}, {0x6041, 0}, {0x605A, 0}, {0x605B, 0},
    {0x605C, 0}, {0x605D, 0}, {0x605E, 0}, {0x6060, 0}, {0x6061, 0}, {0x6064, 0}, {0x6065, 0}, {0x6066, 0}, {0x6072, 0},
    {0x6075, 0}, {0x6076, 0}, {0x6077, 0}, {0x607A, 0}, {0x607C, 0}, {0x607D, 1}, {0x607D, 2}, {0x607E, 0}, {0x607F, 0},
    {0x6080, 0}, {0x6085, 0}, {0x608F, 1}, {0x608F, 2}, {0x6091, 1}, {0x6091, 2}, {0x6092, 1}, {0x6092, 2}, {0x6093, 1},
    {0x6093, 2}, {0x6096, 1}, {0x6096, 2}, {0x6098, 0}, {0x6099, 1}, {0x6099, 2}, {0x609A, 0}, {0x60A8, 0}, {0x60A9, 0},
    {0x60AA, 0}, {0x60B2, 0}, {0x60C2, 1}, {0x60C2, 2}, {0x60FD, 0}, {0x6502, 0}, {0x1600, 0}, {0x1A00, 0},
}};

std::uint32_t key(std::uint16_t index, std::uint8_t sub) { return (std::uint32_t{index} << 8) | sub; }

std::string hex(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08X", value);
  return text;
}

std::string named(std::uint16_t index, std::uint8_t sub) {
  const std::string name = config::object_name(index);
  return config::object_text(index, sub) + (name.empty() ? "" : " " + name);
}

// Rows of the boot that a profile may name a substitute for.
constexpr std::array<Place, 13> replaceable{{{0x6076, 0},
                                             {0x1016, 1},
                                             {0x6007, 0},
                                             {0x605A, 0},
                                             {0x6066, 0},
                                             {0x607D, 1},
                                             {0x6072, 0},
                                             {0x607F, 0},
                                             {0x6085, 0},
                                             {0x6098, 0},
                                             {0x609A, 0},
                                             {0x607C, 0},
                                             {0x60B2, 0}}};

const char* likely_substitute(std::uint16_t index) {
  switch (index) {
    case 0x6076: return "configured_rating";
    case 0x1016: return "node_guarding";
    case 0x6066: return "master_times_following";
    case 0x607D: return "master_limits_position";
    case 0x6072: return "vendor_limit";
    case 0x607F: return "master_limits_speed";
    case 0x60B2: return "no_feed_forward";
    case 0x607C: return "other_object, use: STATE";
    default: return "fixed_by_maker";
  }
}

std::string number_text(const FoundNode& node, std::uint16_t index, std::uint8_t sub) {
  const ReadObject* object = node.find(index, sub);
  return object != nullptr && object->there() ? std::to_string(object->number()) : "?";
}

// Encoder resolution, gear ratio, feed, position and velocity unit: with these the drive says in which units it counts.
constexpr std::array<Place, 8> unit_places{
    {{0x608F, 1}, {0x608F, 2}, {0x6091, 1}, {0x6091, 2}, {0x6092, 1}, {0x6092, 2}, {0x60A8, 0}, {0x60A9, 0}}};

bool units_confirmed(const config::DriveKind& kind) {
  return std::any_of(kind.objects.begin(), kind.objects.end(), [](const config::ProfileObject& object) {
    return std::any_of(unit_places.begin(), unit_places.end(), [&](const Place& place) { return place.index == object.index; });
  });
}

const char* type_of(std::size_t bytes) { return bytes == 1 ? "u8" : bytes == 2 ? "u16" : "u32"; }

}  // namespace

std::uint32_t ReadObject::number() const {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(4, bytes.size()); ++i) value |= std::uint32_t{bytes[i]} << (8 * i);
  return value;
}

const ReadObject* FoundNode::find(std::uint16_t index, std::uint8_t sub) const {
  const auto found = objects.find(key(index, sub));
  return found == objects.end() ? nullptr : &found->second;
}

bool FoundNode::drive() const {
  const ReadObject* type = find(0x1000, 0);
  return type != nullptr && type->there() && (type->number() & 0xFFFFu) == 0x0192;
}

std::string FoundNode::name() const {
  const ReadObject* name = find(0x1008, 0);
  if (name == nullptr || !name->there()) return "";
  std::string text(name->bytes.begin(), name->bytes.end());
  text.resize(std::min(text.size(), text.find('\0')));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < 0x20 || c > 0x7E; }, '?');
  return text;
}

BusDoctor::BusDoctor(std::uint8_t first, std::uint8_t last, const std::vector<config::DriveKind>& kinds)
    : node_(first), last_(last), sdo_(first, answer_time) {
  for (const Place& place : places) wanted_.push_back(key(place.index, place.sub));
  for (const config::DriveKind& kind : kinds) {
    for (const config::ProfileObject& object : kind.objects) {
      const std::uint32_t place = key(object.index, object.sub);
      if (!object.writes && std::find(wanted_.begin(), wanted_.end(), place) == wanted_.end()) wanted_.push_back(place);
    }
  }
  reading_.node = first;
}

void BusDoctor::on_frame(const CanFrame& frame, Time now) {
  if (!done() && frame.id == canopen::cob_id::sdo_answer + node_ && frame.length == 8) (void)sdo_.on_frame(frame, now);
}

void BusDoctor::next_node() {
  if (!reading_.objects.empty()) nodes_.push_back(reading_);
  reading_ = {};
  ++node_;
  reading_.node = node_;
  object_ = 0;
  sdo_ = canopen::SdoClient(node_, answer_time);
}

void BusDoctor::take() {
  const bool silent = sdo_.state() == canopen::SdoClient::State::failed && !sdo_.aborted_by_server();
  if (silent && object_ == 0) return next_node();
  ReadObject read;
  if (sdo_.state() == canopen::SdoClient::State::done) {
    const auto value = sdo_.value();
    read.bytes.assign(value.begin(), value.end());
  } else {
    read.abort_code = sdo_.abort_code();
  }
  reading_.objects[wanted_[object_]] = read;
  if (++object_ == wanted_.size()) next_node();
}

void BusDoctor::step(Time now, std::vector<CanFrame>& out) {
  CanFrame frame;
  while (!done() && sdo_.poll(now, frame)) out.push_back(frame);
  if (done() || sdo_.busy()) return;
  if (sdo_.state() != canopen::SdoClient::State::idle) take();
  if (done()) return;
  sdo_.upload(static_cast<std::uint16_t>(wanted_[object_] >> 8), static_cast<std::uint8_t>(wanted_[object_]));
  while (sdo_.poll(now, frame)) out.push_back(frame);
}

std::vector<const config::DriveKind*> kinds_of(const FoundNode& node, const std::vector<config::DriveKind>& kinds) {
  const ReadObject* vendor = node.find(0x1018, 1);
  const ReadObject* product = node.find(0x1018, 2);
  std::vector<const config::DriveKind*> fit;
  if (vendor == nullptr || !vendor->there()) return fit;
  for (const config::DriveKind& kind : kinds) {
    if (kind.identity.vendor == 0 && kind.identity.product == 0) continue;
    if (kind.identity.vendor != 0 && kind.identity.vendor != vendor->number()) continue;
    const bool same = product != nullptr && product->there() && kind.identity.product == product->number();
    if (kind.identity.product == 0 || same) fit.push_back(&kind);
  }
  std::stable_partition(fit.begin(), fit.end(), [](const config::DriveKind* kind) { return kind->identity.product != 0; });
  return fit;
}

namespace {

// 1018, which the boot holds against the profile before anything else.
void compare_identity(const FoundNode& node, const config::DriveKind& kind, std::vector<std::string>& all) {
  const std::array<std::pair<std::uint8_t, std::uint32_t>, 2> wanted{{{1, kind.identity.vendor}, {2, kind.identity.product}}};
  for (const auto& [sub, number] : wanted) {
    const ReadObject* read = node.find(0x1018, sub);
    if (number == 0 || (read != nullptr && read->there() && read->number() == number)) continue;
    const std::string holds = read != nullptr && read->there() ? "holds " + hex(read->number()) : "is not there";
    all.push_back(named(0x1018, sub) + " " + holds + ", the profile says " + hex(number) + ": another make");
  }
}

}  // namespace

std::vector<std::string> differences(const FoundNode& node, const config::DriveKind& kind) {
  std::vector<std::string> all;
  compare_identity(node, kind, all);
  for (const config::ProfileObject& object : kind.objects) {
    const ReadObject* read = node.find(object.index, object.sub);
    if (object.writes || read == nullptr) continue;
    const std::string why = object.why.empty() ? "" : " (" + object.why + ")";
    if (!read->there() && !object.optional) all.push_back(named(object.index, object.sub) + " is not there" + why);
    if (!read->there()) continue;
    std::int64_t value = 0;
    if (!config::whole_number(object.value, value)) continue;  // a figure of the machine's motor
    const std::uint32_t mask = read->bytes.size() >= 4 ? UINT32_MAX : (1u << (8 * read->bytes.size())) - 1;
    const std::uint32_t wanted = static_cast<std::uint32_t>(value) & mask;
    if (read->number() != wanted)
      all.push_back(named(object.index, object.sub) + " holds " + hex(read->number()) + ", the profile says " + hex(wanted) + why);
  }
  for (const Place& place : replaceable) {
    const ReadObject* read = node.find(place.index, place.sub);
    const bool listed = kind.absence(place.index) != nullptr;
    if (read == nullptr || read->there() != listed) continue;
    if (listed && kind.absence(place.index)->by != canopen::Substitute::configured_rating)
      all.push_back(named(place.index, place.sub) + " is there, the profile says it is not: a newer firmware?");
    if (!listed) all.push_back(named(place.index, place.sub) + " is not there, and the profile names no substitute");
  }
  const ReadObject* rating = node.find(0x6076, 0);
  if (kind.rating == "object" && rating != nullptr && rating->there() && rating->number() == 0)
    all.emplace_back("6076:00 rated torque is 0: commission the motor's data, or state 'rated_torque_nm'");
  return all;
}

namespace {

// As it stands under `check`.
std::string check_row(const Place& place, const ReadObject& read) {
  return "- {object: \"" + config::object_text(place.index, place.sub) + "\", type: " + type_of(read.bytes.size()) +
         ", value: " + hex(read.number()) + "}";
}

}  // namespace

std::string draft_profile(const FoundNode& node) {
  const auto identity = [&](std::uint8_t sub) {
    const ReadObject* read = node.find(0x1018, sub);
    return read != nullptr && read->there() ? hex(read->number()) : std::string("0");
  };
  std::string text = "title: " + (node.name().empty() ? "a drive without a name" : "\"" + node.name() + "\"") + "\n";
  text += "identity: {vendor: \"" + identity(1) + "\", product: \"" + identity(2) + "\"}\n";
  text += "# State one scale for each, from the maker's manual: units_per_count or units_per_rev (speed: _s, acceleration: _s2).\n";
  text += "position: {units_per_count: STATE}\nspeed: {units_per_rev_s: STATE}\nacceleration: {units_per_rev_s2: STATE}\n";
  const ReadObject* rating = node.find(0x6076, 0);
  const bool rated = rating != nullptr && rating->there() && rating->number() > 0;
  text += std::string("torque: {basis: STATE, rating: ") +
          (rated ? "object, rating_unit_unm: STATE}  # 6076 holds " + number_text(node, 0x6076, 0) : "configured}") + "\n";
  text += "options: {quick_stop: 2, quick_stop_fallback: 6, abort: 3}  # 605A holds " + number_text(node, 0x605A, 0) + ", 6007 " +
          number_text(node, 0x6007, 0) + "\n";
  text += "sync_loss: unknown\n";
  std::string checks, absences;
  for (const Place& place : places) {
    const bool factor = (place.index >= 0x608F && place.index <= 0x6097) || (place.index >= 0x60A8 && place.index <= 0x60AA);
    const ReadObject* read = node.find(place.index, place.sub);
    if (factor && read != nullptr && read->there()) checks += "  " + check_row(place, *read) + "\n";
  }
  for (const Place& place : replaceable) {
    const ReadObject* read = node.find(place.index, place.sub);
    if (read == nullptr || read->there()) continue;
    absences += "  - {object: \"" + config::object_text(place.index, place.sub) + "\", by: " + likely_substitute(place.index) +
                "}  # make sure of it\n";
  }
  if (!checks.empty()) text += "check:\n" + checks;
  if (!absences.empty()) text += "absent:\n" + absences;
  return text;
}

namespace {

// Vendors give one number to several makes of drive.
std::string others_text(const config::DriveKind& taken, const std::vector<const config::DriveKind*>& fit, bool configured) {
  std::string names;
  for (const config::DriveKind* kind : fit) {
    if (kind->name != taken.name) names += (names.empty() ? "" : ", ") + kind->name;
  }
  if (names.empty()) return "";
  return "  by its vendor and product it may " + std::string(configured ? "" : "as well ") + "be: " + names + "\n";
}

// What of the drive nobody reads out of its objects, and who stands beside the arm has to know.
std::string habits_text(const config::DriveKind& kind) {
  std::string text =
      "  when SYNC is lost: " + (kind.sync_loss == "unknown" ? "no document says it, try it on the bench" : kind.sync_loss) + "\n";
  if (kind.brake_opens_ms <= 0 && kind.brake_closes_ms <= 0) return text + "  its brake: the profile states no times\n";
  char line[96];
  std::snprintf(line, sizeof line, "  its brake: opens within %.0f ms, closes within %.0f ms\n", kind.brake_opens_ms, kind.brake_closes_ms);
  return text + line;
}

std::vector<std::string> unit_rows(const FoundNode& node) {
  std::vector<std::string> rows;
  for (const Place& place : unit_places) {
    const ReadObject* read = node.find(place.index, place.sub);
    if (read != nullptr && read->there()) rows.push_back(check_row(place, *read));
  }
  return rows;
}

// A profile with a wrong scale boots, and the joint then moves too far or not far enough.
std::string units_text(const FoundNode& node, const config::DriveKind& kind) {
  if (units_confirmed(kind)) return "";
  const std::vector<std::string> rows = unit_rows(node);
  const std::string head = "  note: its units are confirmed by no object: ";
  if (rows.empty()) return head + "it has none of 608F, 6091, 6092, 60A8, 60A9. Measure a short jog before it carries the arm\n";
  std::string text = head + "the profile checks none of these. Where they are right, state them under 'check'\n";
  for (const std::string& row : rows) text += "    " + row + "\n";
  return text;
}

}  // namespace

nlohmann::ordered_json doctor_json(const std::vector<FoundNode>& nodes, const std::vector<config::DriveKind>& kinds,
                                   const ConfiguredDrives& configured) {
  using Json = nlohmann::ordered_json;
  Json all = Json::array(), missing = Json::array();
  bool agrees = !nodes.empty();
  for (const FoundNode& node : nodes) {
    Json one{{"node", node.node}, {"name", node.name()}, {"drive", node.drive()}};
    for (const auto& [key, sub] : {std::pair{"vendor", std::uint8_t{1}}, std::pair{"product", std::uint8_t{2}}}) {
      const ReadObject* read = node.find(0x1018, sub);
      one[key] = read != nullptr && read->there() ? Json(read->number()) : Json(nullptr);
    }
    const auto told = configured.find(node.node);
    const auto fit = kinds_of(node, kinds);
    const config::DriveKind* kind = told != configured.end() ? &told->second.kind : fit.empty() ? nullptr : fit.front();
    if (told != configured.end()) one["joint"] = told->second.joint;
    one["profile"] = kind != nullptr ? Json(kind->name) : Json(nullptr);
    if (node.drive() && kind != nullptr) {
      one["differences"] = differences(node, *kind);
      one["unconfirmed"] = kind->unconfirmed;
      one["units_confirmed"] = units_confirmed(*kind);
      if (!units_confirmed(*kind)) one["unit_objects"] = unit_rows(node);
    }
    if (node.drive() && kind == nullptr) one["draft"] = draft_profile(node);
    const bool as_told = one.contains("differences") && one["differences"].empty();
    if (told != configured.end() && !as_told) agrees = false;
    all.push_back(one);
  }
  for (const auto& [number, drive] : configured) {
    const std::uint8_t node = number;
    if (std::any_of(nodes.begin(), nodes.end(), [node](const FoundNode& found) { return found.node == node; })) continue;
    missing.push_back({{"node", node}, {"joint", drive.joint}});
    agrees = false;
  }
  return {{"agrees", agrees}, {"nodes", all}, {"missing", missing}};
}

std::string doctor_text(const std::vector<FoundNode>& nodes, const std::vector<config::DriveKind>& kinds,
                        const ConfiguredDrives& configured) {
  if (nodes.empty()) return "nobody answers: look at the bus' power, bit rate and termination\n";
  std::string text;
  for (const FoundNode& node : nodes) {
    const std::string name = node.name().empty() ? "without a name" : "'" + node.name() + "'";
    text += "node " + std::to_string(node.node) + ": " + name;
    if (!node.drive()) {
      const ReadObject* type = node.find(0x1000, 0);
      text += ", no servo drive (1000 is " + (type != nullptr && type->there() ? hex(type->number()) : "?") + ")\n";
      continue;
    }
    const auto told = configured.find(node.node);
    const auto fit = kinds_of(node, kinds);
    const config::DriveKind* kind = told != configured.end() ? &told->second.kind : fit.empty() ? nullptr : fit.front();
    if (kind == nullptr) {
      text += ", not known. A draft of its profile:\n\n" + draft_profile(node) + "\n";
      continue;
    }
    const std::vector<std::string> all = differences(node, *kind);
    const std::string whose = told != configured.end() ? ", " + told->second.joint + ", configured as " : ", profile ";
    text += whose + kind->name + " (" + kind->title + ")" + (all.empty() ? ": agrees with its profile\n" : ":\n");
    for (const std::string& one : all) text += "  " + one + "\n";
    text += units_text(node, *kind);
    text += others_text(*kind, fit, told != configured.end());
    text += habits_text(*kind);
    const ReadObject* error = node.find(0x603F, 0);
    if (error != nullptr && error->there() && error->number() != 0)
      text += "  its last error (603F) is " + hex(error->number()).substr(6) + ": " +
              kind->error_text(static_cast<std::uint16_t>(error->number())) + "\n";
    for (const std::string& open : kind->unconfirmed) text += "  unconfirmed, try it on the bench: " + open + "\n";
  }
  for (const auto& [number, drive] : configured) {
    const std::uint8_t node = number;
    const bool answers = std::any_of(nodes.begin(), nodes.end(), [node](const FoundNode& found) { return found.node == node; });
    if (!answers) text += "node " + std::to_string(node) + ": nobody answers, and the " + drive.joint + " is configured there\n";
  }
  return text;
}

}  // namespace lf::hal
