// SPDX-License-Identifier: Apache-2.0
// Passes over seams, with their divisions by masses done once and their constants side by side: as the shared text has
// them they took a tenth of a small garment's time. One entry after the other: pixels of a seam lie anywhere, and to
// gather and scatter vectors of them takes longer.

#include "cpu/seam_stream.h"

#include <cmath>
#include <limits>
#include <span>

#include "lib/bend.h"
#include "lib/span.h"
#include "lib/vector.h"

namespace geocloth::cpu {
namespace {

using shader::vec3;

void add_copies(const ClothState& state, std::span<const uint32_t> pixels, SeamStream& stream) {
  if (state.inverse_mass[pixels.front()] == 0) return;  // pinned, and all its copies with it
  float all = 0;
  const auto first = static_cast<uint32_t>(stream.copies.size());
  for (const uint32_t i : pixels) {
    const float mass = 1.F / state.inverse_mass[i];
    all = all + mass;
    stream.copies.push_back({i, mass});
  }
  if (pixels.size() != 2) {
    stream.rows.push_back({first, static_cast<uint32_t>(stream.copies.size()), 1.F / all});
    return;
  }
  stream.pairs.push_back({pixels[0], pixels[1], stream.copies.back().mass, 1.F / all});
  stream.copies.resize(first);
}

/// Up to this square of its length nothing is pulled, see all_slack() in constraints_inl.h. @param w  of both ends
float slack_of(float longest, float w) {
  return w > 0 ? longest * longest : std::numeric_limits<float>::infinity();
}

SeamSpan span_of(const ClothState& state, const shader::SeamSpring& s, float stretch_limit) {
  const float w = state.inverse_mass[s.a] + state.inverse_mass[s.b], longest = s.rest * stretch_limit;
  return {s.a, s.b, slack_of(longest, w), longest, w > 0 ? 1.F / w : 0.F};
}

WholeTie whole_tie_of(const ClothState& state, const shader::SeamSpring& s, float stretch_limit) {
  const float wa = shader::whole_tie_weight(state.inverse_mass[s.a]);
  const float wb = shader::whole_tie_weight(state.inverse_mass[s.b]);
  const float w = wa + wb, longest = s.rest * stretch_limit;
  return {s.a, s.b, s.row_a, s.row_b, slack_of(longest, w), longest, w > 0 ? 1.F / w : 0.F, wa, wb};
}

/// The weight as lib/bend.h has it.
SeamBend bend_of(const ClothState& state, const shader::SeamSpring& s, float inverse_dt2) {
  const auto weight = [&](uint32_t i) { return state.inverse_mass[i]; };
  const float wa = weight(s.a), wm = weight(s.middle), wb = weight(s.b), wc = weight(s.beside);
  const float back = 1.F - s.chord, kept = 1.F - s.turn;
  const float compliance = s.compliance * inverse_dt2 * shader::clamped_share(wa, wm, wb, s.chord);
  const float w = wa * back * back + wm * s.middle_share * kept * kept + wb * s.chord * s.chord + wc * s.turn * s.turn;
  return {s.a,       s.middle,  s.b,          s.beside,
          s.rest,    s.chord,   s.turn,       compliance > 0 ? 1.F / (w + compliance) : 0.F,
          wa * back, wm * kept, wb * s.chord, wc * s.turn};
}

/// Coordinates in memory, as values: see PointBase of constraints_inl.h.
struct Positions {
  float *x, *y, *z;
  explicit Positions(ClothState& state)
      : x(state.position.x.data()), y(state.position.y.data()), z(state.position.z.data()) {}
  [[nodiscard]] vec3 at(size_t i) const { return {x[i], y[i], z[i]}; }
  void set(size_t i, const vec3& p) const {
    x[i] = p.x;
    y[i] = p.y;
    z[i] = p.z;
  }
  void move(size_t i, const vec3& step, float weight) const { set(i, shader::shifted(at(i), step, weight)); }
};

/// stitch_add() and stitch_mean() of lib/stitch.h for two: the first one adds nothing.
void stitch_pair(const CopyPair& pair, const Positions& positions) {
  const vec3 first = positions.at(pair.first);
  const vec3 moment = vec3(0, 0, 0) + (positions.at(pair.second) - first) * pair.mass;
  const vec3 mean = first + moment * pair.share;
  positions.set(pair.first, mean);
  positions.set(pair.second, mean);
}

void stitch_row(std::span<const CopyMass> copies, float share, const Positions& positions) {
  const vec3 first = positions.at(copies.front().pixel);
  vec3 moment(0, 0, 0);
  for (const CopyMass& copy : copies) moment = moment + (positions.at(copy.pixel) - first) * copy.mass;
  const vec3 mean = first + moment * share;
  for (const CopyMass& copy : copies) positions.set(copy.pixel, mean);
}

/// span_move() of lib/span.h.
void pull_span(const SeamSpan& span, const Positions& positions, const ClothState& state) {
  const vec3 d = positions.at(span.b) - positions.at(span.a);
  const float squared = shader::dot3(d, d);
  if (!(squared > span.slack)) return;
  const float l = std::sqrt(squared);
  if (!(l > span.longest)) return;
  const vec3 step = d * ((l - span.longest) * span.inverse * (1.F / l));
  const shader::Weights moves = shader::yielding(state.inverse_mass[span.a], state.yield_at(span.a),
                                                 state.inverse_mass[span.b], state.yield_at(span.b));
  positions.move(span.a, step, moves.a);
  positions.move(span.b, -step, moves.b);
}

void place_copies(const ClothData& data, uint32_t pixel, uint32_t row, const vec3& place, const Positions& positions) {
  if (row == shader::kNoRow) return positions.set(pixel, place);
  for (uint32_t k = data.split_offset[row]; k < data.split_offset[row + 1]; ++k)
    positions.set(data.split_pixel[k], place);
}

/// The same for whole points.
void pull_whole(const WholeTie& tie, float share, const ClothData& data, const Positions& positions) {
  const vec3 a = positions.at(tie.a), b = positions.at(tie.b), d = b - a;
  const float squared = shader::dot3(d, d);
  if (!(squared > tie.slack)) return;
  const float l = std::sqrt(squared);
  if (!(l > tie.longest)) return;
  const vec3 step = d * ((l - tie.longest) * (share * tie.inverse) * (1.F / l));
  place_copies(data, tie.a, tie.row_a, shader::shifted(a, step, tie.weight_a), positions);
  place_copies(data, tie.b, tie.row_b, shader::shifted(b, -step, tie.weight_b), positions);
}

/// turned_bend_move() of lib/bend.h.
void project_bend(const SeamBend& bend, const Positions& positions, const ClothState& state) {
  const vec3 middle = positions.at(bend.middle);
  vec3 e = (positions.at(bend.a) - middle) * (1.F - bend.chord) + (positions.at(bend.b) - middle) * bend.chord;
  if (bend.turn != 0) e = e - (positions.at(bend.beside) - middle) * bend.turn;  // few have one to take up
  const float l = shader::length3(e);
  const bool bent = l > 1e-12F;
  const float change = bent ? (l - bend.rest) * bend.inverse : 0.F;
  const vec3 step = e * (change * (1.F / (bent ? l : 1.F)));
  positions.move(bend.a, -step, bend.weight_a * state.yield_at(bend.a));
  positions.move(bend.middle, step, bend.weight_middle * state.yield_at(bend.middle));
  positions.move(bend.b, -step, bend.weight_b * state.yield_at(bend.b));
  if (bend.turn != 0) positions.move(bend.beside, step, bend.weight_beside * state.yield_at(bend.beside));
}

/// Entries share no pixel.
template <class Entry, class Body>
void for_entries(const Threads& threads, const std::vector<Entry>& entries, const Body& body) {
  threads.for_range(static_cast<uint32_t>(entries.size()), kRowGrain, [&](uint32_t first, uint32_t last) {
    for (uint32_t k = first; k < last; ++k) body(entries[k]);
  });
}

}  // namespace

size_t SeamStream::memory_bytes() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof(values.front()); };
  size_t sum = bytes(pairs) + bytes(rows) + bytes(copies);
  for (const auto& color : spans) sum += bytes(color);
  for (const auto& color : bends) sum += bytes(color);
  for (const auto& color : whole_ties) sum += bytes(color);
  return sum;
}

SeamStream seam_stream(const ClothState& state, const ClothFrame& cloth, const std::vector<PassStep>& steps,
                       uint32_t relaxation_steps) {
  SeamStream stream;
  const ClothData& data = state.data;
  stream.spans.resize(data.seam_color_offset.size());
  stream.bends.resize(data.seam_color_offset.size());
  stream.whole_ties.resize(data.seam_color_offset.size());
  const auto springs_of = [&](uint32_t color) {
    const uint32_t first = data.seam_color_offset[color], last = data.seam_color_offset[color + 1];
    return std::span(data.seam_springs).subspan(first, last - first);
  };
  bool stitched = false;
  for (const PassStep& step : steps) {
    stitched = stitched || step.pass == Pass::stitch;
    if (step.pass == Pass::seam_spans && stream.spans[step.group].empty()) {
      for (const shader::SeamSpring& s : springs_of(step.group))
        stream.spans[step.group].push_back(span_of(state, s, cloth.params.stretch_limit));
    }
    if (step.pass == Pass::whole_ties && stream.whole_ties[step.group].empty()) {
      for (const shader::SeamSpring& s : springs_of(step.group))
        stream.whole_ties[step.group].push_back(whole_tie_of(state, s, cloth.params.stretch_limit));
    }
    if (step.pass == Pass::seam_curvature && relaxation_steps == 1 && stream.bends[step.group].empty()) {
      for (const shader::SeamSpring& s : springs_of(step.group))
        stream.bends[step.group].push_back(bend_of(state, s, cloth.params.inverse_dt2));
    }
  }
  for (uint32_t r = 0; stitched && r < data.split_rows(); ++r) {
    const uint32_t first = data.split_offset[r], last = data.split_offset[r + 1];
    add_copies(state, std::span(data.split_pixel).subspan(first, last - first), stream);
  }
  return stream;
}

bool run_seams(const SeamStream& stream, const PassStep& step, const PassContext& context, ClothState& state) {
  const Positions positions(state);
  if (step.pass == Pass::stitch) {
    for_entries(context.threads, stream.pairs, [=](const CopyPair& pair) { stitch_pair(pair, positions); });
    for_entries(context.threads, stream.rows, [&](const CopyRow& row) {
      stitch_row(std::span(stream.copies).subspan(row.first, row.last - row.first), row.share, positions);
    });
    return true;
  }
  if (step.pass == Pass::seam_spans) {
    for_entries(context.threads, stream.spans[step.group],
                [&](const SeamSpan& span) { pull_span(span, positions, state); });
    return true;
  }
  if (step.pass == Pass::whole_ties) {
    const float share = step.relaxation > 0 ? shader::kTieShare : 1;
    for_entries(context.threads, stream.whole_ties[step.group],
                [&, share](const WholeTie& tie) { pull_whole(tie, share, state.data, positions); });
    return true;
  }
  if (step.pass != Pass::seam_curvature || stream.bends[step.group].empty()) return false;
  for_entries(context.threads, stream.bends[step.group],
              [&](const SeamBend& bend) { project_bend(bend, positions, state); });
  return true;
}

}  // namespace geocloth::cpu
