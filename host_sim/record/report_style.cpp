#include "host_sim/record/report_parts.hpp"

namespace lf::record {

std::string_view report_style() {
  return R"css(
:root{--bg:#f6f8f9;--card:#fff;--ink:#16202a;--soft:#5b6b78;--line:#dfe5e9;--good:#1d7f4f;--good-bg:#e4f4ea;--bad:#b3261e;--bad-bg:#fbe9e7;
--fair:#a86400;--accent:#0b6e8f;--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#b0559b;--c4:#a07800;--c5:#5b6b78}
@media(prefers-color-scheme:dark){:root{--bg:#0f151b;--card:#171f27;--ink:#e4eaef;--soft:#93a3b0;--line:#2a353f;--good:#5fce93;--good-bg:#12301f;
--bad:#ff8a80;--bad-bg:#3a1a18;--fair:#f0b35a;--accent:#59c1e2;--c0:#56b4e9;--c1:#ff8f4a;--c2:#2fd0a0;--c3:#e08fd0;--c4:#f0d060;--c5:#93a3b0}}
*{box-sizing:border-box}
body{margin:0;background:var(--bg);color:var(--ink);font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",sans-serif}
main{max-width:1180px;margin:0 auto;padding:24px 20px 60px}
section,header{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:20px 24px;margin:0 0 18px}
header.done{border-left:8px solid var(--good)}header.failed{border-left:8px solid var(--bad)}
h1{font-size:26px;line-height:1.25;margin:0 0 4px}h2{font-size:17px;margin:0 0 12px}
.verdict{display:inline-block;padding:1px 12px;border-radius:99px;font-size:15px;font-weight:600;vertical-align:4px;margin-right:10px}
.done .verdict{background:var(--good-bg);color:var(--good)}.failed .verdict{background:var(--bad-bg);color:var(--bad)}
.reason{margin:6px 0;font-size:17px}.soft{color:var(--soft)}
pre{background:var(--bg);border:1px solid var(--line);border-radius:6px;padding:10px 12px;margin:12px 0 0;white-space:pre-wrap;overflow-wrap:anywhere;
font:13.5px/1.45 ui-monospace,"DejaVu Sans Mono",Consolas,monospace}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(126px,1fr));gap:10px;margin-top:16px}
.tile{border:1px solid var(--line);border-radius:8px;padding:9px 13px}.tile b{display:block;font-size:21px;line-height:1.3;font-weight:600}
.tile span{color:var(--soft);font-size:13px}
.two{display:grid;grid-template-columns:repeat(auto-fit,minmax(440px,1fr));gap:18px}.two section{margin:0}.two{margin-bottom:18px}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th{font-weight:600;color:var(--soft);font-size:13px;text-align:left}td,th{padding:5px 10px 5px 0;border-bottom:1px solid var(--line);vertical-align:top}
tr:last-child td{border-bottom:0}td.n,th.n{text-align:right}td.code{font-family:ui-monospace,"DejaVu Sans Mono",Consolas,monospace;font-size:12.5px;overflow-wrap:anywhere}
.mark{font-weight:600}.mark.good{color:var(--good)}.mark.bad{color:var(--bad)}
.meter{display:inline-block;width:110px;height:8px;border-radius:4px;background:var(--line);overflow:hidden;vertical-align:1px}
.meter i{display:block;height:100%;background:var(--good)}.meter.bad i{background:var(--bad)}
.drawing{display:block;width:100%;height:auto}
.drawing text{font:12px system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",sans-serif;fill:var(--soft)}
.drawing .label{fill:var(--ink);font-size:13px}.middle{text-anchor:middle}.end{text-anchor:end}
.grid{stroke:var(--line);stroke-width:1}.zero{stroke:var(--soft);stroke-width:1;opacity:.6}.phase{stroke:var(--accent);stroke-width:1;stroke-dasharray:1 4;opacity:.7}
.bar.good{fill:var(--good)}.bar.bad{fill:var(--bad)}.bar.fair{fill:var(--fair)}
.series{fill:none;stroke-width:1.6;stroke-linejoin:round}.dashed{stroke-dasharray:5 4;opacity:.8}
.s0{stroke:var(--c0)}.s1{stroke:var(--c1)}.s2{stroke:var(--c2)}.s3{stroke:var(--c3)}.s4{stroke:var(--c4)}.s5{stroke:var(--c5)}
figure{margin:0}.chart{margin-bottom:22px}.chart:last-child{margin-bottom:0}.unit{color:var(--soft)}
.legend{display:flex;flex-wrap:wrap;gap:2px 18px;font-size:13px;color:var(--soft);margin:2px 0 4px}.legend span{display:flex;align-items:center;gap:6px}
.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(440px,1fr));gap:18px}
.pictures img,.cloud img,.cloud canvas{display:block;width:100%;height:auto;border-radius:6px;background:#0e141b}
.pictures figcaption{margin-top:6px;font-size:14px}.pictures figcaption span{color:var(--soft)}
.cloud{position:relative}.cloud [hidden]{display:none}.cloud canvas{cursor:grab;touch-action:none}.cloud canvas:active{cursor:grabbing}
.tools{position:absolute;right:10px;top:10px;display:flex;gap:6px;flex-wrap:wrap}
.tools button{background:#1d2833cc;color:#dfe7ee;border:1px solid #3b4a57;border-radius:5px;font:13px system-ui,sans-serif;padding:3px 9px;cursor:pointer}
.tools button:hover{background:#31414f}
.scale{display:flex;align-items:center;gap:8px;font-size:13px;color:var(--soft);margin-top:10px;flex-wrap:wrap}.scale i{display:block;width:150px;height:10px;border-radius:3px}
.facts,.none{color:var(--soft);font-size:14px;margin:8px 0 0}
ul{margin:8px 0 0;padding-left:20px}footer{color:var(--soft);font-size:13px}
@media(max-width:640px){main{padding:10px 8px}section,header{padding:14px}.two,.pictures{grid-template-columns:1fr}}
@media print{body{background:#fff}section,header{break-inside:avoid}.tools{display:none}}
)css";
}

// Turns the cloud. Points: base64 of little-endian int16 x, y, z; the colours are those of report_cloud.cpp.
std::string_view report_script() {
  return R"js(
(function(){
var box=document.getElementById('cloud'),data=document.getElementById('points');if(!box||!data)return;
var raw=atob(data.textContent),n=raw.length/6|0,p=new Int16Array(n*3);
for(var i=0;i<n*3;i++)p[i]=raw.charCodeAt(2*i)|raw.charCodeAt(2*i+1)<<8;
function mix(a,b,s){s=Math.max(0,Math.min(1,s));return 0xff000000|Math.round(a[2]+(b[2]-a[2])*s)<<16|Math.round(a[1]+(b[1]-a[1])*s)<<8|Math.round(a[0]+(b[0]-a[0])*s)}
var behind=[58,134,255],on=[150,160,168],before=[255,92,80],proud=[150,70,220],far=[255,224,70],colour=new Uint32Array(n);
for(i=0;i<n;i++){var d=p[3*i+2]/20;colour[i]=d>6?mix(proud,far,(d-6)/114):d<0?mix(on,behind,-d/6):mix(on,before,d/6)}
var canvas=box.querySelector('canvas'),w=canvas.width,h=canvas.height,g=canvas.getContext('2d'),image=g.createImageData(w,h);
var pixels=new Uint32Array(image.data.buffer),depth=new Float32Array(w*h),base=+box.dataset.scale,yaw=0.5,pitch=0.35,zoom=1,asked=false;
function draw(){asked=false;pixels.fill(0xff1b140e);depth.fill(-1e9);
var cy=Math.cos(yaw),sy=Math.sin(yaw),cp=Math.cos(pitch),sp=Math.sin(pitch),s=base*zoom,size=zoom>2?3:2;
for(var i=0;i<n;i++){var X=p[3*i],Y=p[3*i+1],Z=p[3*i+2],x=cy*X+sy*Z,z=cy*Z-sy*X,y=cp*Y-sp*z,near=sp*Y+cp*z,u=Math.round(w/2+s*x),v=Math.round(h/2-s*y);
for(var b=0;b<size;b++)for(var a=0;a<size;a++){var pu=u+a,pv=v+b;if(pu<0||pv<0||pu>=w||pv>=h)continue;var k=pv*w+pu;if(near<depth[k])continue;depth[k]=near;pixels[k]=colour[i]}}
g.putImageData(image,0,0)}
function ask(){if(!asked){asked=true;requestAnimationFrame(draw)}}
var from=null;
canvas.addEventListener('pointerdown',function(e){from=[e.clientX,e.clientY];canvas.setPointerCapture(e.pointerId)});
canvas.addEventListener('pointermove',function(e){if(!from)return;yaw+=(e.clientX-from[0])*0.008;pitch=Math.max(-1.57,Math.min(1.57,pitch+(e.clientY-from[1])*0.008));from=[e.clientX,e.clientY];ask()});
canvas.addEventListener('pointerup',function(){from=null});
canvas.addEventListener('wheel',function(e){if(!e.ctrlKey)return;e.preventDefault();zoom=Math.max(0.3,Math.min(12,zoom*Math.exp(-e.deltaY*0.002)));ask()},{passive:false});
box.querySelectorAll('button').forEach(function(b){b.addEventListener('click',function(){
if(b.dataset.view){var v=b.dataset.view.split(',');yaw=+v[0];pitch=+v[1];zoom=1}else zoom=Math.max(0.3,Math.min(12,zoom*b.dataset.zoom));ask()})});
box.querySelector('img').hidden=true;canvas.hidden=false;box.querySelector('.tools').hidden=false;
document.querySelectorAll('.live').forEach(function(e){e.hidden=false});draw();
})();
)js";
}

}  // namespace lf::record
