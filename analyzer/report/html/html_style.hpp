#pragma once

namespace lab::report::html {

inline constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; --ink: #1d2125; --soft: #5b646d; --line: #d9dde1; --paper: #fdfdfc;
  --card: #f4f5f6; --good: #00684a; --bad: #a63b00; --open: #5b646d; --part: #7d6300; --warn: #fdeee3; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e6e8; --soft: #a2abb3; --line: #3a4148; --paper: #16191c; --card: #1f2428;
    --good: #4cc79b; --bad: #f0955a; --open: #a2abb3; --part: #d8bb3c; --warn: #3a261a; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2.5rem 1.5rem 5rem; max-width: 70rem; background: var(--paper);
  color: var(--ink); font: 1.0625rem/1.55 Charter, "Bitstream Charter", "Sitka Text", Cambria,
  Georgia, serif; }
h1 { font-size: 2.1rem; line-height: 1.15; margin: 0 0 .3rem; font-weight: 600; }
h2 { font-size: 1.35rem; margin: 2.2rem 0 .8rem; font-weight: 600; }
h3 { font-size: 1.1rem; margin: 0 0 .2rem; font-weight: 600; }
p { margin: .4rem 0 .8rem; max-width: 44rem; }
.soft, figcaption, th { color: var(--soft); }
.lead { font-size: 1.05rem; color: var(--soft); margin-bottom: 1.5rem; }
.warn { background: var(--warn); border-left: .3rem solid var(--bad); padding: .8rem 1.1rem;
  margin: 1.2rem 0; border-radius: .2rem; }
.warn p { margin: .2rem 0; }
.card { background: var(--card); border-radius: .4rem; padding: 1.1rem 1.3rem; margin: 0 0 1.2rem; }
.verdict { font-weight: 600; font-size: 1.15rem; margin: .1rem 0 .3rem; }
.agrees { color: var(--good); } .deviates { color: var(--bad); } .undecided { color: var(--open); }
.partly { color: var(--part); }
.card ul { margin: .3rem 0 .8rem; padding-left: 1.2rem; max-width: 44rem; font-size: .95rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums;
  margin: .5rem 0; }
th { text-align: left; font-weight: 600; vertical-align: bottom; }
th, td { padding: .28rem 1.1rem .28rem 0; border-bottom: 1px solid var(--line); }
td { vertical-align: top; } .r { text-align: right; } td.r { white-space: nowrap; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(27rem, 1fr)); gap: 1.6rem; }
.opening { display: grid; grid-template-columns: 3fr 2fr; gap: 1.4rem 1.6rem; margin: 1.5rem 0; }
.opening figure:nth-child(n+3) { grid-column: 1 / -1; }
figure { margin: 0; min-width: 0; }
figure svg { width: 100%; height: auto; display: block; background: #fff; border-radius: .4rem;
  border: 1px solid var(--line); }
figcaption { font-size: .88rem; line-height: 1.45; margin-top: .45rem; }
figcaption b { color: var(--ink); }
code, pre { font: .86rem/1.5 ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; }
pre { background: var(--card); padding: 1rem; border-radius: .4rem; overflow-x: auto; }
.dot { display: inline-block; width: .7em; height: .7em; border-radius: 50%; margin-right: .5em; }
details.part { border-top: 1px solid var(--line); margin: 0; padding: .55rem 0; }
details.part > summary h2 { display: inline; font-size: 1.15rem; color: var(--ink); }
details.part[open] { padding-bottom: 1.6rem; }
details.part:last-child { border-bottom: 1px solid var(--line); }
details { margin: 1rem 0; } summary { cursor: pointer; color: var(--soft); }
@media (max-width: 32rem) { .figures { grid-template-columns: 1fr; } }
@media (max-width: 48rem) { .opening { grid-template-columns: 1fr; } }
@media print { body { max-width: none; } .card, figure { break-inside: avoid; } }
)css";

}  // namespace lab::report::html
