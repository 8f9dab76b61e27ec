"""The style of a report: colours and measures of the console, light and dark, for any width."""

STYLE = """
:root{color-scheme:light dark;--ground:#e9ecef;--surface:#fff;--raised:#f4f6f8;--line:#c3cad1;
--text:#14191e;--muted:#4b555f;--accent:#1f5fbf;--stop:#cf1020;--well:#3f6150;--careful:#7d4e00;
--unknown:#46596b;--bad:#8a2356;--well-soft:#dcebe2;--careful-soft:#fbe7bd;--unknown-soft:#d5dfe9;
--bad-soft:#f8d9e8;--floor:#fff;--solid:#79848f;--edge:#fff}
@media (prefers-color-scheme:dark){:root{--ground:#14181c;--surface:#1e2429;--raised:#272e35;
--line:#47525c;--text:#eef1f4;--muted:#b3bdc7;--accent:#93bbf2;--stop:#f0606e;--well:#a5c8b3;
--careful:#f0ba58;--unknown:#aabdd1;--bad:#f49cc6;--well-soft:#26392e;--careful-soft:#463109;
--unknown-soft:#2d3a47;--bad-soft:#4d1f37;--floor:#2a323a;--solid:#7d8995;--edge:#14181c}}
*{box-sizing:border-box}
body{margin:0 auto;padding:16px;max-width:1180px;background:var(--ground);color:var(--text);
font:15px/1.45 system-ui,sans-serif;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}
header,section,footer{background:var(--surface);border:1px solid var(--line);border-radius:8px;
padding:16px;margin:0 0 12px}
h1{font-size:1.75rem;line-height:1.2;margin:4px 0 12px;text-wrap:balance}
h2{font-size:1.15rem;margin:0 0 12px}h3{font-size:1.05rem;margin:0}
h4{font-size:1rem;margin:0 0 4px}p{margin:0 0 8px}
p:last-child{margin-bottom:0}
.brand{color:var(--accent);font-weight:600}.brand span{color:var(--muted);font-weight:400}
.setup,.scenario,footer{color:var(--muted)}
.verdict{display:inline-block;font-weight:600;border-radius:4px;padding:2px 10px}
.well{color:var(--well)}.careful{color:var(--careful)}.unknown{color:var(--unknown)}
.bad{color:var(--bad)}
.verdict.well,.part.well{background:var(--well-soft)}
.verdict.careful,.part.careful{background:var(--careful-soft)}
.verdict.unknown,.part.unknown{background:var(--unknown-soft)}
.verdict.bad,.part.bad{background:var(--bad-soft)}
.kind,.change{font-weight:600}.change{white-space:nowrap}
.change.worse{color:var(--bad)}.change.better{color:var(--well)}.change.other{color:var(--unknown)}
ul.required,ul.broken{list-style:none;margin:0;padding:0;font-weight:600}
ul.broken{margin:8px 0}
.outcome{margin:0 0 8px}.outcome-name{font-weight:600}
.parts{display:flex;gap:2px;margin-top:2px}
.part{padding:4px 6px;min-width:2.9em;flex-basis:0;font-weight:600;white-space:nowrap;
border:1px solid currentColor;border-radius:3px}
.scroll{overflow-x:auto}
table{border-collapse:collapse;margin-top:8px;min-width:min(100%,24rem)}
th,td{text-align:left;padding:5px 16px 5px 0;border-bottom:1px solid var(--line);
vertical-align:top;font-weight:400}
thead th{font-weight:600;color:var(--muted);vertical-align:bottom}
th,td{overflow-wrap:break-word}tbody th{min-width:6.5em}
.numbers thead th{overflow-wrap:anywhere;min-width:4.4em}
.numbers td,.numbers thead th:not(:first-child){text-align:right}.numbers td{white-space:nowrap}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,480px),1fr));gap:0 12px}
.pair section{min-width:0}
ul.legend{list-style:none;display:flex;flex-wrap:wrap;gap:4px 16px;margin:0 0 12px;padding:0}
article{border-top:1px solid var(--line);padding:16px 0}
article:last-child{padding-bottom:0}
.sides{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,330px),1fr));gap:24px;
margin-top:8px}
.side{min-width:0}
svg.symbols{position:absolute;width:0;height:0}
svg.map{display:block;width:100%;max-height:420px;background:var(--raised);
border:1px solid var(--line);border-radius:4px}
.floor{fill:var(--floor)}.solid{fill:var(--solid)}
.track,.track-edge{fill:none;stroke-linejoin:round;stroke-linecap:round;
vector-effect:non-scaling-stroke}
.track{stroke:var(--accent);stroke-width:2.5px}.track-edge{stroke:var(--edge);stroke-width:5px}
svg .end{fill:var(--accent);stroke:var(--edge);stroke-width:1.5px;vector-effect:non-scaling-stroke}
svg .start{fill:var(--edge);stroke:var(--accent);stroke-width:2px;vector-effect:non-scaling-stroke}
svg .goal circle{fill:none;stroke:var(--text);stroke-width:2px;vector-effect:non-scaling-stroke}
svg .goal .dot{fill:var(--text)}
.mark{stroke:var(--edge);stroke-width:1.5px;vector-effect:non-scaling-stroke;paint-order:stroke}
.mark.fault{fill:var(--careful)}.mark.firing{fill:var(--text)}.mark.stop{fill:var(--stop)}
.cross-edge{stroke:var(--edge);stroke-width:8px;stroke-linecap:round;
vector-effect:non-scaling-stroke}
.leader{stroke:var(--muted);stroke-width:1px;vector-effect:non-scaling-stroke}
.mark.contact{stroke:var(--bad);stroke-width:4px;stroke-linecap:round}
.point.start,.point.end{color:var(--accent)}.point.goal,.point.firing{color:var(--text)}
.point.fault{color:var(--careful)}.point.stop{color:var(--stop)}.point.contact{color:var(--bad)}
.timeline{margin:12px 0 8px}
.row{display:flex;align-items:stretch;height:22px}
.row-name{flex:0 0 4.2em;color:var(--muted);font-size:.87rem}
.lane{position:relative;flex:1;border:solid var(--line);
border-width:0 0 1px 1px;margin-right:10px}
.bar{position:absolute;top:4px;bottom:4px;min-width:2px;border-radius:2px}
.bar.goal{background:var(--accent)}
.bar.fault{background:repeating-linear-gradient(45deg,var(--careful) 0 3px,transparent 3px 6px);
border:1px solid var(--careful)}
.bar.unwell{background:var(--unknown)}
.lane .point{position:absolute;top:0;transform:translateX(-50%);line-height:21px;cursor:default}
.lane .point.fault{text-shadow:0 0 2px var(--surface),0 0 2px var(--surface)}
.axis .lane{border-bottom:0}
.axis .lane span{position:absolute;top:2px;font-size:.8rem;color:var(--muted);white-space:nowrap}
summary{cursor:pointer;padding:4px 0;color:var(--accent);font-weight:600}
summary:focus-visible{outline:2px solid var(--accent);outline-offset:2px}
details ol{margin:4px 0;padding:0;list-style:none}
details ol>li{display:grid;grid-template-columns:4.4em minmax(0,1fr);padding:2px 0}
details ol ul{grid-column:2;margin:2px 0;padding-left:1.2em}
time{color:var(--muted)}
@media (max-width:700px){body{padding:8px;font-size:16px}header,section,footer{padding:12px}
h1{font-size:1.4rem}th,td{padding-right:6px}.numbers tbody th{font-size:.95em}
summary{padding:11px 0}}
@media print{body{background:#fff}header,section,footer{break-inside:auto}
article{break-inside:avoid}}
"""
