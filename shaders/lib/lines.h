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
const float kLineYield = 2.2e-8f;  // [s^2]

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

// @param step, step_before  [m kg] multiplier times direction of the spring from the point on and of the one to it
inline vec3 line_point(vec3 p, vec3 step, vec3 step_before, float w) {
  precise vec3 way = step - step_before;
  return shifted(p, way, w);
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
