#include "host_sim/app/range_verdict.hpp"

#include "host_sim/judge/range_rules.hpp"
#include "host_sim/judge/truth.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace {

// The keys of "path=value", as --set takes them.
std::vector<std::string> keys_of(const RangeRow& row) {
  std::vector<std::string> keys;
  for (const std::string& set : row.set) keys.push_back(set.substr(0, set.find('=')));
  return keys;
}

void judge(const record::RunResult& run, const RangeRow& row, RangeResult& result) {
  if (run.success) {
    result.verdict = "success";
    return;
  }
  result.reason = run.failure->phase + ": " + run.failure->reason;
  const bool forced = run.contact.peak_force_n > judge::contact_limit_n || run.contact.unintended_contacts > 0;
  const bool unsafe = run.false_success || forced || run.failure->reason.find("moves or has power") != std::string::npos;
  const bool named = judge::names_a_key(keys_of(row), run.failure->reason);
  result.verdict = unsafe ? "unsafe" : named ? "safe" : "unnamed";
  if (forced && !run.false_success) {
    result.reason += " (" + std::to_string(run.contact.unintended_contacts) + " unintended contacts, up to " +
                     std::to_string(static_cast<int>(run.contact.peak_force_n)) + " N)";
  }
}

}  // namespace

RangeResult verdict_of(const RangeRow& row, const std::function<void()>& prepare, const std::function<record::RunResult()>& fly) {
  RangeResult result{row.name, row.key, "", "", ""};
  for (const std::string& each : row.set) result.set += (result.set.empty() ? "" : " ") + each;
  try {
    prepare();
  } catch (const InputError& error) {
    result.verdict = judge::refusal_names_a_key(keys_of(row), error.what()) ? "refused" : "unnamed";
    result.reason = std::string(result.verdict == "refused" ? "" : "refused without naming the key: ") + error.what();
    return result;
  }
  try {
    judge(fly(), row, result);
  } catch (const InputError& error) {
    result.verdict = "unsafe";
    result.reason = std::string("refused only when the mission had begun: ") + error.what();
  }
  return result;
}

}  // namespace lf::app
