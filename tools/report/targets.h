// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "geocloth/parametrize/convert.h"

namespace geocloth {

/// How a measure stands to its target.
enum class Verdict {
  none,    ///< it has no target, in this layout at least
  met,     ///<
  near,    ///< missed by so little that a simulation hardly shows it
  missed,  ///<
};
[[nodiscard]] const char* to_string(Verdict verdict);  ///< "no target", "met", "near", "missed"

/// A measure of a conversion for people, with what a garment that can be laid flat should reach at about 17,000 pixels.
struct Measure {
  std::string key;      ///< in the JSON report
  std::string title;    ///< a few words
  std::string meaning;  ///< a sentence for who does not know the word
  std::string value, target;
  Verdict verdict = Verdict::none;
};

struct MeasureGroup {
  std::string title;
  std::vector<Measure> measures;
};

/// Every measure of the report, grouped. Those of shape and of springs have no targets in layout square, which gives
/// shape up for a full square.
[[nodiscard]] std::vector<MeasureGroup> judge(const ConvertResult& result);

/// The worst verdict among all, and how many there are of each.
struct Judgement {
  Verdict worst = Verdict::met;
  std::size_t with_target = 0, near = 0, missed = 0;
};
[[nodiscard]] Judgement sum_up(const std::vector<MeasureGroup>& groups);

}  // namespace geocloth
