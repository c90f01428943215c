#include "host_sim/campaign/page_parts.hpp"

namespace lf::campaign {

// What the page has beyond a run's report.
std::string_view page_style() {
  return R"css(
a{color:var(--accent)}td a,li a{white-space:nowrap}
.wide{overflow-x:auto}.wide td.n,.wide td.whole{white-space:nowrap}
.share{display:block;width:160px;height:14px}.share .all{fill:var(--line)}.share .hits{fill:var(--good);opacity:.55}.share.few .hits{fill:var(--bad)}
.share .interval{stroke:var(--ink);stroke-width:1.5}
.curves{display:grid;grid-template-columns:repeat(auto-fit,minmax(440px,1fr));gap:20px 26px}
.curves figure{min-width:0}.curves figcaption{font-size:14px}
.curve{fill:none;stroke-width:1.6;stroke-linejoin:round}.point{stroke:none}a .point:hover{stroke:var(--ink);stroke-width:2}
.p0{fill:var(--c0)}.p1{fill:var(--c1)}.p2{fill:var(--c2)}.p3{fill:var(--c3)}.p4{fill:var(--c4)}.p5{fill:var(--c5)}.point.failed{fill:var(--bad)}
.histogram{fill:var(--line)}.rank{stroke:var(--soft);stroke-width:1;stroke-dasharray:4 3}
summary{cursor:pointer;color:var(--accent)}details[open] summary{margin-bottom:8px}
.doubt{color:var(--fair);font-weight:600}
@media(max-width:640px){.curves{grid-template-columns:1fr}}
)css";
}

}  // namespace lf::campaign
