// SPDX-License-Identifier: Apache-2.0
// The vector types of GLSL for C++, so that the files in shared/ and lib/ are valid in both languages and both backends
// compile the very same text.
//
// The common subset: vec3 for computing, vec2/vec4/uvec2/uvec4 in memory; component access by .x .y .z .w only; no
// swizzles, no inout (functions return structs); float literals with the suffix f; unsigned literals with u; + - * and
// sqrt, floor, abs, min, max, floatBitsToUint, uintBitsToFloat; the only division is 1.0f / x (drivers may turn a / b
// into a * (1 / b)). Every floating-point result is `precise`, which forbids contraction in GLSL; C++ is compiled with
// -ffp-contract=off.
#ifndef GEOCLOTH_SHARED_TYPES_H
#define GEOCLOTH_SHARED_TYPES_H

#ifdef __cplusplus
#include <bit>
#include <cmath>
#include <cstdint>

#define precise

namespace geocloth::shader {

using uint = std::uint32_t;

struct alignas(8) vec2 {
  float x, y;
};
struct vec3 {
  float x, y, z;
  vec3() = default;
  constexpr vec3(float x_, float y_, float z_) : x(x_), y(y_), z(z_) {}
};
struct alignas(16) vec4 {
  float x, y, z, w;
  vec4() = default;
  constexpr vec4(float x_, float y_, float z_, float w_) : x(x_), y(y_), z(z_), w(w_) {}
  constexpr vec4(const vec3& v, float w_) : x(v.x), y(v.y), z(v.z), w(w_) {}
};
struct alignas(8) uvec2 {
  uint x, y;
  uvec2() = default;
  constexpr uvec2(uint x_, uint y_) : x(x_), y(y_) {}
};
struct alignas(16) uvec4 {
  uint x, y, z, w;
};

inline vec3 operator+(const vec3& a, const vec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline vec3 operator-(const vec3& a, const vec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline vec3 operator-(const vec3& a) {
  return {-a.x, -a.y, -a.z};
}
inline vec3 operator*(const vec3& a, const vec3& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline vec3 operator*(const vec3& a, float s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline float min(float a, float b) {
  return b < a ? b : a;
}
inline float max(float a, float b) {
  return a < b ? b : a;
}
inline float abs(float a) {
  return std::fabs(a);
}
inline float sqrt(float a) {
  return std::sqrt(a);
}
inline float floor(float a) {
  return std::floor(a);
}
inline uint floatBitsToUint(float a) {  // NOLINT(readability-identifier-naming): GLSL's name
  return std::bit_cast<uint>(a);
}
inline float uintBitsToFloat(uint a) {  // NOLINT(readability-identifier-naming)
  return std::bit_cast<float>(a);
}

}  // namespace geocloth::shader
#else
#define inline
#endif

#endif
