// SPDX-License-Identifier: Apache-2.0
// Verlet prediction: x + k (x - previous) + dt^2 a (Zeller 2005), with the forces of the air.
//
// Air: every piece of cloth is a thin plate in a stream (Wilson et al. 2014, "Simulating wind effects on cloth and
// hair"): with the relative velocity v, unit normal n towards the lee, c = |v . n|, per area
//   drag = rho/2 Cd c v,   lift = rho/2 Cl c |v| (n - (n . v) v / |v|^2),
// so that a plate that falls flat ends at v = sqrt(2 m g / (rho Cd A)). Gusts are a few waves that travel with the
// wind.
//
// Pressure acts along the normal on the area as it is, a third of each triangle's at each of its corners: in all
// nothing pushes closed cloth about, and the work is that on the volume within. Where springs are too few or too slow
// to hold it, the area that it acts on does not grow without end.
//
// Imperfections: a sheet in a plane whose forces lie in that plane would never leave it, however much it is squeezed,
// as a column without any imperfection never buckles. So gravity may stray a little, up and down along a wave.
#ifndef GEOCLOTH_LIB_PREDICT_H
#define GEOCLOTH_LIB_PREDICT_H

#include "../shared/layout.h"
#include "frame.h"
#include "point_state.h"
#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

// One wave's share of the air's velocity at a point [m/s].
inline vec3 gust_at(Wave wave, vec3 position) {
  precise float turns = dot3(xyz(wave.wave), position) + wave.wave.w;
  precise vec3 v = xyz(wave.gust) * sine_of_turns(turns);
  return v;
}

// Acceleration [m/s^2] of cloth with the unit normal n that moves at `velocity` in air that moves at `air`.
// No step takes more than the whole relative velocity, so that light cloth in a strong wind is stable at any step.
// Below that the force is what it is: what falls evenly or a wind holds bears the same load at any number of substeps.
inline vec3 air_acceleration(ClothParams params, vec3 air, vec3 velocity, vec3 n) {
  precise vec3 v = air - velocity;
  precise float speed = length3(v);
  precise float toward = dot3(v, n);
  precise float c = abs(toward);
  precise float drag = params.air_factor * params.drag * c;
  precise float lift = params.air_factor * params.lift * c;
  precise float inverse_speed = speed > 1e-9f ? 1.0f / speed : 0.0f;
  precise vec3 lee = toward < 0.0f ? -n : n;
  precise vec3 sideways = lee * speed - v * (c * inverse_speed);
  precise vec3 force = v * drag + sideways * lift;
  precise vec3 a = force * (1.0f / max(1.0f, (drag + lift) * params.dt));
  return a;
}

// Acceleration [m/s^2] by pressure.
// @param w  length of the normal of lib/normal.h: 6 times the area that it stands for [m^2]; of copies, which would
//   round each its own share, less than 0: that of the whole point over its mass [m^2/kg]
inline vec3 pressure_acceleration(ClothParams params, vec3 n, float w, float mass_inverse) {
  precise float area_of_mass = w < 0.0f ? -w : w * mass_inverse;
  precise vec3 a = n * (params.pressure.x * min(area_of_mass, params.pressure.y));
  return a;
}

// From -1/4 to 1/4: evenly up and down along a wave that stands in space. It is alike for sheets that differ by their
// cuts or their pixels, so that they fold alike.
inline float stray_at(ClothParams params, vec3 position) {
  precise float turns = dot3(xyz(params.stray_wave), position) + params.stray_wave.w;
  precise float off = turns - floor(turns + 0.5f);
  precise float stray = abs(off) - 0.25f;
  return stray;
}

// @param place  where the point was
inline PointState advance(ClothParams params, vec3 place, vec3 start, vec3 kept_way, vec3 acceleration) {
  precise vec3 fall = xyz(params.gravity_step);
  if (params.stray_step.w != 0.0f) fall = fall + xyz(params.stray_step) * stray_at(params, place);
  precise vec3 increment = kept_way + fall + acceleration * (params.dt * params.dt);
  precise vec3 next = start + increment;
  precise vec3 lost = increment - (next - start);
  PointState r;
  r.position = next;
  r.previous = start;
  r.carry = lost;
  return r;
}

inline PointState predict(ClothParams params, PointState point, vec3 acceleration) {
  precise vec3 kept = way_of(point) * params.keep;
  return advance(params, point.position, point.position, kept, acceleration);
}

// The same on a moving parent.
inline PointState predict_along(ClothParams params, float substep, PointState point, vec3 acceleration) {
  FramedStep framed = take_along(params, substep, point.position, way_of(point));
  return advance(params, point.position, framed.start, framed.way, acceleration);
}

// A point whose last displacement is `ratio` times as long, for a step of another length: its velocity stays.
inline PointState rescaled(PointState point, float ratio) {
  precise vec3 way = way_of(point) * ratio;
  return arrived(point.position, way);
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
