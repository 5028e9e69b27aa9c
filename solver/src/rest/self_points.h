// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "backend.h"
#include "lib/self_words.h"

namespace geocloth {

inline constexpr float kSelfDistance = 1.2F;  ///< of the spacing, that points of different layers keep
inline constexpr float kSelfMargin = 0.5F;    ///< of that distance, by which the lists of neighbours reach farther

inline constexpr size_t kMostSelfWords = size_t{1} << 30U;  ///< that can be counted

/// Fills what self-collision needs of a cloth: points, words and numbers of ClothData.
/// @throws Error(limit) for more points than their words can be counted
void add_self_points(const ClothDesc& cloth, ClothData& data);

/// Inverse mass [1/kg] of all copies of each point together, for the first copy; 0 elsewhere.
/// @param first  the first copy of each pixel
[[nodiscard]] std::vector<float> whole_inverse_masses(std::span<const float> inverse_mass,
                                                      std::span<const uint32_t> first);

/// Words before the first substep, up to the sections behind those of the points: nobody has been seen anywhere.
[[nodiscard]] std::vector<uint32_t> first_self_words(const shader::SelfRoom& room);

/// The header of the words between two frames.
[[nodiscard]] std::array<uint32_t, shader::kSelfHeader> first_header(uint32_t age);

/// Words that last from one look-up of neighbours to the next, one piece: where each point was seen, how many
/// neighbours it has, and which.
struct FoundWords {
  size_t first = 0, count = 0;
};
/// Of each point.
inline constexpr size_t kFoundWordsOfPoint = 4 + shader::kSelfMostNeighbors;
/// @param pixels  of the image; 0: the points are of several cloths
[[nodiscard]] FoundWords found_words(const SelfNumbers& numbers, size_t pixels);

void set_self_numbers(const SelfNumbers& numbers, shader::ClothParams& params);

}  // namespace geocloth
