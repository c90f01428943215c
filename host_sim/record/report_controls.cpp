#include "host_sim/record/report_parts.hpp"

namespace lf::record {

std::string controls_html() {
  return R"html(<div class="controls live" id="controls" hidden>
<div class="row"><button type="button" id="play">Play</button>
<select id="speed" aria-label="Playing speed"><option value="0.25">¼ ×</option><option value="1" selected>1 ×</option><option value="4">4 ×</option><option value="16">16 ×</option></select>
<span id="now"></span></div>
<div class="track"><input type="range" id="time" min="0" max="1" step="0.01" value="0" aria-label="Time in the run"><div id="flags" aria-hidden="true"></div></div>
<div class="row"><span class="soft">Charts:</span><button type="button" id="closer">zoom in</button><button type="button" id="farther">zoom out</button>
<button type="button" id="whole">whole run</button><button type="button" id="wide" aria-pressed="false">wide</button></div>
<p class="facts">Time is simulated, in seconds. Drag over a chart to zoom, double click for the whole run. A name in a legend switches its line.</p></div>)html";
}

}  // namespace lf::record
