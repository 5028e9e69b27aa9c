// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace geocloth {

/// Style of the report: one column on a telephone, two pictures side by side where there is room, ink-saving on paper.
/// Text has a contrast of at least 4.5 to 1 on every background.
inline constexpr std::string_view kPageStyle = R"(:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem 1.25rem 3rem; max-width: 76rem; background: #fff; color: #1d2126;
  font: 1rem/1.5 system-ui, "Segoe UI", Roboto, "Noto Sans", "DejaVu Sans", sans-serif; }
h1 { margin: 0.5rem 0; font-size: 1.9rem; line-height: 1.2; overflow-wrap: anywhere; }
h2 { margin: 2.2rem 0 0.6rem; padding-bottom: 0.2rem; border-bottom: 2px solid #d5dae0; font-size: 1.3rem; }
p, ul { margin: 0.5rem 0; max-width: 60rem; }
.verdict { padding: 0.6rem 0.9rem; border-left: 0.4rem solid; border-radius: 0.2rem; font-size: 1.1rem; }
.verdict.met { background: #e6f4ea; border-color: #1e7b34; }
.verdict.near { background: #fdf3d7; border-color: #a86b00; }
.verdict.missed { background: #fce8e6; border-color: #b3261e; }
.facts { display: flex; flex-wrap: wrap; gap: 0.4rem 2rem; margin: 1rem 0 0; }
.facts dt { color: #545d68; font-size: 0.85rem; }
.facts dd { margin: 0; }
.file { overflow-wrap: anywhere; }
.warnings li, .note { overflow-wrap: anywhere; }
.warnings { padding-left: 1.3rem; }
.warnings li { margin: 0.3rem 0; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); gap: 1.5rem; }
figure { margin: 0; display: flex; flex-direction: column; }
figure.wide { grid-column: 1 / -1; }
figcaption { margin-bottom: 0.4rem; color: #3a424b; font-size: 0.95rem; }
img { width: 100%; height: auto; border: 1px solid #d5dae0; background: #202125; }
.scroll { overflow-x: auto; margin: 1rem 0; }
table { width: 100%; border-collapse: collapse; font-size: 0.95rem; }
caption { padding: 0.3rem 0; text-align: left; font-weight: 600; }
th, td { padding: 0.35rem 0.7rem 0.35rem 0; border-bottom: 1px solid #e3e7eb; text-align: left; vertical-align: top; }
thead th { color: #545d68; font-size: 0.85rem; font-weight: 600; }
tbody th { font-weight: 500; overflow-wrap: anywhere; }
th small { display: block; color: #545d68; font-size: 0.85rem; font-weight: 400; }
.measures { table-layout: fixed; min-width: 24rem; }
.measures th:first-child { width: 46%; }
.surface tbody th { min-width: 7rem; }
.number { white-space: nowrap; font-variant-numeric: tabular-nums; }
.badge { display: inline-block; padding: 0.05rem 0.5rem; border-radius: 0.8rem; white-space: nowrap;
  font-size: 0.9rem; font-weight: 600; }
.badge.met { background: #e6f4ea; color: #14592a; }
.badge.near { background: #fdf3d7; color: #6f4700; }
.badge.missed { background: #fce8e6; color: #8c1d18; }
.badge.none { color: #545d68; }
@media (max-width: 36rem) {
  body { padding: 0.5rem 0.75rem 2rem; }
  th small { display: none; }
  .measures th:first-child { width: 38%; }
}
@media print {
  body { max-width: none; padding: 0; font-size: 10pt; }
  figure, tr, .verdict { break-inside: avoid; }
  h2, caption { break-after: avoid; }
  .pictures { grid-template-columns: 1fr 1fr; gap: 4mm; }
  .scroll { overflow: visible; }
  .verdict, .badge { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)";

}  // namespace geocloth
