// SPDX-License-Identifier: Apache-2.0
// All structural springs of a run along a row or a column at once: line relaxation. What one spring gives up the next
// one gets, so a sweep over springs one by one carries a pull from pixel to pixel; a run is a tridiagonal system, which
// two sweeps along it solve (Thomas 1949). The constraints are those of Goldenthal, Harmon, Fattal, Bercovier, Grinspun
// 2007 ("Efficient Simulation of Inextensible Cloth", fast projection): (d . d - L^2) / 2 has the gradients -d and d
// without a root, and a spring is never taken too far. One that is shorter than L keeps its length.
//
//   d_k from point k to k + 1      o--d0--o--d1--o--d2--o     x_k += w_k (m_k d_k - m_k-1 d_k-1)
//   of the multipliers m           (w_k + w_k+1) |d_k|^2 on the diagonal, -w_k d_k-1 . d_k beside it
//
// Copies at a seam stay where they are: the charts on its sides know nothing of each other, and what each would do to
// its own copies the stitch would take back from the springs beside them.
#ifndef GEOCLOTH_LIB_LINES_H
#define GEOCLOTH_LIB_LINES_H

#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

// More on the diagonal lets a pull fade within some ten springs at 480 substeps a second, and sooner where shorter ones
// leave less to pull. Without it a run that is taut between two points that stay has no solution, and cloth at rest
// would tremble: what one spring of a heap of folds gives up moves all of its line.
const float kLineYield = 1.5e-8f;  // [s^2]

// Of the cell's word: the pixel is a copy of a point that has several.
const uint kCellCopyBit = 8u;

// What the sweep forth tells of a spring, and the sweep back needs: its multiplier is `multiplier` less that of the
// next spring times the next one's coupling.
struct LineSpring {
  float inverse;     // of the pivot; 0: no spring
  float multiplier;  // if it were the run's last
  float coupling;    // with the spring before
};

inline LineSpring no_line_spring() {
  LineSpring r;
  r.inverse = 0.0f;
  r.multiplier = 0.0f;
  r.coupling = 0.0f;
  return r;
}

// Inverse mass of a point in its line.
inline float line_weight(float mass_inverse, uint cell) {
  return (cell & kCellCopyBit) != 0u ? 0.0f : mass_inverse;
}

// Factor of the diagonal.
inline float line_diagonal(float inverse_dt2) {
  precise float r = 1.0f + kLineYield * inverse_dt2;
  return r;
}

// A pull goes on along its line; where the line bends, as it does in folds, the point is drawn aside instead, the more
// the less it helps, so that much is added there.
// @param d_before  [m] of the spring before; 0: there is none
// @param d         [m] of the spring; 0: there is none
// @param wa, wb    inverse masses of its ends [1/kg]
// @param diagonal  line_diagonal()
inline LineSpring line_spring(LineSpring before, vec3 d_before, vec3 d, float wa, float wb, float longest,
                              float diagonal) {
  precise float l2 = dot3(d, d);
  precise float along = dot3(d_before, d);
  precise float beside = -(wa * along);
  precise float coupling = beside * before.inverse;
  precise float bend = l2 - along;
  precise float aside = wa * (before.inverse > 0.0f && bend > 0.0f ? bend : 0.0f);
  precise float pivot = ((wa + wb) * l2 * diagonal + aside) - beside * coupling;
  bool exists = pivot > 0.0f;
  precise float inverse = exists ? 1.0f / (exists ? pivot : 1.0f) : 0.0f;
  precise float excess = l2 - longest * longest;
  precise float multiplier = ((excess > 0.0f ? 0.5f * excess : 0.0f) - beside * before.multiplier) * inverse;
  LineSpring r;
  r.inverse = inverse;
  r.multiplier = multiplier;
  r.coupling = coupling;
  return r;
}

// @param multiplier  if it were the run's last
inline float line_multiplier(float multiplier, float coupling_of_next, float multiplier_of_next) {
  precise float r = multiplier - coupling_of_next * multiplier_of_next;
  return r;
}

// A pull along a line that bends draws its points aside. Along the directions that springs had before, a zigzag would
// come out on the other side, and back in the next frame: settled cloth would tremble. So springs pull along
// directions between those and the ones after a backward Euler step with these pulls,
//
//   x'_k = x_k + a (x'_k-1 - x'_k) + b (x'_k+1 - x'_k),    a, b = kLineSmoothing w_k m >= 0 of the springs beside
//
// and the same step evens out the points' ways: zigzags that were straightened would still have the speed that made
// them. What all points of a line have in common, and what grows evenly along it, stays.
const float kLineSmoothing = 4.0f;
const float kLineTurn = 0.3f;  // how far towards those after the step

// What the sweep back leaves of a point: its place and way are these plus coupling times those of the point before.
struct LinePoint {
  vec3 place;
  vec3 way;
  float coupling;
};

inline LinePoint no_line_point() {
  LinePoint r;
  r.place = vec3(0.0f, 0.0f, 0.0f);
  r.way = vec3(0.0f, 0.0f, 0.0f);
  r.coupling = 0.0f;
  return r;
}

// @param m_before, m  multipliers of the springs to the point and from it on; 0: there is none
inline LinePoint line_point(LinePoint next, vec3 place, vec3 way, float w, float m_before, float m) {
  precise float s = kLineSmoothing * w;
  precise float a = s * (m_before > 0.0f ? m_before : 0.0f);
  precise float b = s * (m > 0.0f ? m : 0.0f);
  precise float share = 1.0f / ((1.0f + a) + (b - b * next.coupling));
  precise vec3 to = (place + next.place * b) * share;
  precise vec3 evened = (way + next.way * b) * share;
  precise float coupling = a * share;
  LinePoint r;
  r.place = to;
  r.way = evened;
  r.coupling = coupling;
  return r;
}

// What a spring pulls by: its multiplier times d, turned.
// @param d      [m] of the spring
// @param after  [m] the backward Euler step
inline vec3 line_step(vec3 d, vec3 after, float m) {
  precise vec3 turned = d + (after - d) * kLineTurn;
  precise float l2 = dot3(turned, turned);
  precise float along = dot3(d, turned);
  precise vec3 r = turned * (m * (l2 > 1e-20f ? along / (l2 > 1e-20f ? l2 : 1.0f) : 0.0f));
  return r;
}

// @param step, step_before  [m kg] line_step() of the spring from the point on and of the one to it
inline vec3 line_moved(vec3 p, vec3 step, vec3 step_before, float w) {
  precise vec3 way = step - step_before;
  return shifted(p, way, w);
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
