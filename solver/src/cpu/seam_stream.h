// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "cpu/passes.h"

namespace geocloth::cpu {

/// Two copies of a point.
struct CopyPair {
  uint32_t first, second;
  float mass;   ///< [kg] of the second one
  float share;  ///< [1/kg] 1 / mass of both

  friend bool operator==(const CopyPair&, const CopyPair&) = default;
};

/// More copies of a point than two.
struct CopyRow {
  uint32_t first, last;  ///< entries of SeamStream::copies
  float share;           ///< [1/kg] 1 / mass of all

  friend bool operator==(const CopyRow&, const CopyRow&) = default;
};
struct CopyMass {
  uint32_t pixel;
  float mass;  ///< [kg]

  friend bool operator==(const CopyMass&, const CopyMass&) = default;
};

/// A span over a seam, or a tie on one; see lib/span.h.
struct SeamSpan {
  uint32_t a, b;
  float slack;    ///< [m^2] up to this square of its length it pulls nothing
  float longest;  ///< [m]
  float inverse;  ///< [kg] 1 / (wa + wb)

  friend bool operator==(const SeamSpan&, const SeamSpan&) = default;
};

/// A tie between whole points; see lib/span.h.
struct WholeTie {
  uint32_t a, b;
  uint32_t row_a, row_b;  ///< of their copies
  float slack, longest;   ///< as in SeamSpan
  float inverse;          ///< 1 / (weight_a + weight_b)
  float weight_a, weight_b;

  friend bool operator==(const WholeTie&, const WholeTie&) = default;
};

/// A bend over a seam; see turned_bend_move() of lib/bend.h.
struct SeamBend {
  uint32_t a, middle, b, beside;
  float rest, chord, turn;
  float inverse;                                           ///< 1 / (w + compliance)
  float weight_a, weight_middle, weight_b, weight_beside;  ///< [1/kg] inverse mass times the point's part in it

  friend bool operator==(const SeamBend&, const SeamBend&) = default;
};

/// What passes over seams go through, with all that stays the same while the cloth moves.
struct SeamStream {
  std::vector<CopyPair> pairs;
  std::vector<CopyRow> rows;
  std::vector<CopyMass> copies;
  std::vector<std::vector<SeamSpan>> spans;  ///< of each colour of ClothData::seam_springs
  std::vector<std::vector<SeamBend>> bends;
  std::vector<std::vector<WholeTie>> whole_ties;

  [[nodiscard]] size_t memory_bytes() const;

  friend bool operator==(const SeamStream&, const SeamStream&) = default;
};

/// @param steps  that it is for
[[nodiscard]] SeamStream seam_stream(const ClothState& state, const ClothFrame& cloth,
                                     const std::vector<PassStep>& steps, uint32_t relaxation_steps);

/// Runs a pass over seams.
/// @return false, with nothing done, when it is not one that the stream is for
bool run_seams(const SeamStream& stream, const PassStep& step, const PassContext& context, ClothState& state);

}  // namespace geocloth::cpu
