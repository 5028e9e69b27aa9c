// SPDX-License-Identifier: Apache-2.0
#include "cpu/row_source.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace geocloth::cpu {

float RowSource::scaled_compliance(uint32_t component, size_t pixel) const {
  return state.compliance[component][pixel] * cloth.params.inverse_dt2;
}

uint32_t lane_of(RowKernel kernel, uint32_t column) {
  switch (kernel) {
    case RowKernel::springs_along:
      return column / 4 * 4 + column % 4 / 2;
    case RowKernel::springs_along_two:  // as they lie
    default:
      return column;
  }
}

void add_block(RowStream& stream, uint32_t first, uint32_t constants, uint32_t lanes) {
  stream.pixel.push_back(first);
  stream.constants.resize(stream.constants.size() + size_t{constants} * lanes, 0.F);
}

void add_pull_block(RowStream& stream, uint32_t first, uint32_t lanes) {
  add_block(stream, first, 2, lanes);
  std::fill_n(stream.constants.end() - 2 * ptrdiff_t{lanes}, lanes, std::numeric_limits<float>::infinity());
}

}  // namespace geocloth::cpu
