// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/gltf_animation.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

using Json = GltfFile::Json;

constexpr std::size_t kListedNames = 40, kNameLength = 60;

std::string name_of(const Json& animation) {
  const auto name = animation.find("name");
  return name == animation.end() ? std::string() : name->get<std::string>();
}

std::string title_of(const Json& animations, std::size_t i) {
  const std::string name = name_of(animations[i]).substr(0, kNameLength);
  return label("animations", i) + (name.empty() ? "" : " '" + name + "'");
}

std::string list_names(const Json& animations) {
  std::string out;
  for (std::size_t i = 0; i < std::min(animations.size(), kListedNames); ++i) {
    const std::string name = name_of(animations[i]).substr(0, kNameLength);
    out += (i > 0 ? ", " : "") + std::to_string(i) + (name.empty() ? "" : " '" + name + "'");
  }
  const std::size_t more = animations.size() - std::min(animations.size(), kListedNames);
  return more > 0 ? out + " and " + std::to_string(more) + " more" : out;
}

/// A name goes before a number: some exporters name animations by numbers.
std::size_t find_clip(const GltfFile& gltf, const std::string& clip) {
  const Json& animations = gltf.array("animations");
  if (animations.empty()) gltf.bad("has no animation; export it with one, or use it as a mesh that stands still");
  if (clip.empty()) return 0;
  for (std::size_t i = 0; i < animations.size(); ++i) {
    if (name_of(animations[i]) == clip) return i;
  }
  std::size_t number = 0;
  const char* const end = clip.data() + clip.size();
  const auto [at, error] = std::from_chars(clip.data(), end, number);
  if (error == std::errc() && at == end && number < animations.size()) return number;
  gltf.bad("has no animation '" + clip.substr(0, kNameLength) + "'; it has " + list_names(animations));
}

/// Where a time lies between keys.
struct Between {
  std::size_t left, right;
  double share;   ///< 0..1 of the way from left to right
  double length;  ///< [s] from left to right
};

Between find_keys(const std::vector<float>& keys, double time) {
  const auto after =
      std::upper_bound(keys.begin(), keys.end(), time, [](double t, float key) { return t < double{key}; });
  const auto right = static_cast<std::size_t>(after - keys.begin());
  if (right == 0) return {0, 0, 0, 0};
  if (right == keys.size()) return {right - 1, right - 1, 0, 0};
  // At a key itself, the next one does not count, whatever it holds.
  if (time == double{keys[right - 1]}) return {right - 1, right - 1, 0, 0};
  const double start = double{keys[right - 1]}, length = double{keys[right]} - start;
  return {right - 1, right, (time - start) / length, length};
}

Eigen::Quaterniond turn_of(const float* v) {
  return Eigen::Quaterniond(double{v[3]}, double{v[0]}, double{v[1]}, double{v[2]}).normalized();
}

Eigen::Vector3d first_three(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

bool is_unit_integer(const GltfAccessor& a) {
  return a.normalized && (a.component_size == 1 || a.component_size == 2);
}

}  // namespace

NodePose blend_pose(const NodePose& from, const NodePose& to, double share) {
  NodePose out = to;
  out.place.translation = (1 - share) * from.place.translation + share * to.place.translation;
  out.place.scale = (1 - share) * from.place.scale + share * to.place.scale;
  out.place.rotation = from.place.rotation.normalized().slerp(share, to.place.rotation.normalized());
  for (std::size_t i = 0; i < out.weight.size(); ++i) {
    out.weight[i] = (1 - share) * from.weight[i] + share * to.weight[i];
  }
  return out;
}

GltfAnimation::GltfAnimation(const GltfFile& gltf, const GltfData& data, const std::string& clip,
                             const std::vector<std::size_t>& targets) {
  const Json& animations = gltf.array("animations");
  const std::size_t number = find_clip(gltf, clip);
  title_ = title_of(animations, number);
  const Json& animation = animations[number];
  for (std::size_t i = 0; i < animation["channels"].size(); ++i) read_channel(gltf, data, animation, i, targets);
  if (channel_.empty()) gltf.bad(title_ + " moves no node, skin or morph target");
}

void GltfAnimation::read_channel(const GltfFile& gltf, const GltfData& data, const Json& animation, std::size_t i,
                                 const std::vector<std::size_t>& targets) {
  const std::string where = title_ + "." + label("channels", i);
  const Json& json = animation["channels"][i];
  const Json& target = json["target"];
  // What has no node to move is for extensions (glTF 2.0, section 3.11).
  if (!target.contains("node")) return;
  const auto path = target.find("path");
  if (path == target.end() || !path->is_string()) gltf.bad(where + ".target.path is missing");
  constexpr std::pair<std::string_view, Path> kPaths[] = {{"translation", Path::translation},
                                                          {"rotation", Path::rotation},
                                                          {"scale", Path::scale},
                                                          {"weights", Path::weights}};
  const auto known =
      std::find_if(std::begin(kPaths), std::end(kPaths), [&](const auto& p) { return *path == p.first; });
  if (known == std::end(kPaths)) {
    if (*path == "pointer") return;
    gltf.bad(where + ".target.path is '" + path->get<std::string>().substr(0, kNameLength) +
             "'; it must be translation, rotation, scale or weights");
  }
  Channel channel{target["node"].get<std::size_t>(), json["sampler"].get<std::size_t>(), known->second, 3};
  if (channel.path == Path::rotation) channel.width = 4;
  if (channel.path == Path::weights) {
    const auto mesh = gltf.reference(gltf.array("nodes")[channel.node], "mesh", "meshes", where);
    channel.width = mesh ? targets[*mesh] : 0;
    if (channel.width == 0) gltf.bad(where + " moves morph targets of a node that has none");
  }
  const std::string from = title_ + "." + label("samplers", channel.sampler);
  const Json& sampler = animation["samplers"][channel.sampler];
  if (!sampler_.contains(channel.sampler)) {
    sampler_.emplace(channel.sampler, read_sampler(gltf, data, sampler, from));
  }
  check_values(gltf, data, sampler, channel, from);
  count_numbers(gltf, channel.width);
  if (channel.path != Path::weights) moved_.insert(channel.node);
  channel_.push_back(channel);
}

GltfAnimation::Sampler GltfAnimation::read_sampler(const GltfFile& gltf, const GltfData& data, const Json& sampler,
                                                   const std::string& where) {
  Sampler out;
  if (const auto way = sampler.find("interpolation"); way != sampler.end()) {
    if (*way == "STEP") {
      out.way = Way::step;
    } else if (*way == "CUBICSPLINE") {
      out.way = Way::cubic;
    } else if (*way != "LINEAR") {
      gltf.bad(where + ".interpolation is not LINEAR, STEP or CUBICSPLINE");
    }
  }
  const GltfAccessor &input = data.attribute(sampler, "input", where),
                     &output = data.attribute(sampler, "output", where);
  if (input.components != 1 || input.component_type != 5126) gltf.bad(where + ".input is not of single floats");
  count_numbers(gltf, input.count + output.count * output.components);
  out.time = data.floats(sampler["input"].get<std::size_t>());
  out.value = data.floats(sampler["output"].get<std::size_t>());
  check_keys(gltf, out, where);
  duration_ = std::max(duration_, double{out.time.back()});
  return out;
}

void GltfAnimation::count_numbers(const GltfFile& gltf, std::size_t more) {
  numbers_ += more;
  if (numbers_ > kMaxElements) fail(gltf.path, ErrorCode::limit, title_ + " has more than 100 million numbers");
}

void GltfAnimation::check_keys(const GltfFile& gltf, const Sampler& sampler, const std::string& where) const {
  if (sampler.time.empty()) gltf.bad(where + ".input has no times");
  for (std::size_t i = 0; i < sampler.time.size(); ++i) {
    if (!std::isfinite(sampler.time[i])) {
      gltf.bad(where + ".input: time " + std::to_string(i) + " is not a finite number");
    }
    if (i > 0 && sampler.time[i] < sampler.time[i - 1]) {
      gltf.bad(where + ".input: time " + std::to_string(i) + " is before the one ahead of it");
    }
  }
}

/// That a sampler fits what a channel moves with it.
void GltfAnimation::check_values(const GltfFile& gltf, const GltfData& data, const Json& sampler,
                                 const Channel& channel, const std::string& where) const {
  const GltfAccessor& output = data.attribute(sampler, "output", where);
  const bool place = channel.path == Path::translation || channel.path == Path::scale;
  const std::size_t components = channel.path == Path::weights ? 1 : channel.width;
  if (output.components != components) {
    gltf.bad(where + ".output has " + std::to_string(output.components) + " components; its channel needs " +
             std::to_string(components));
  }
  if (output.component_type != 5126 && (place || !is_unit_integer(output))) {
    gltf.bad(where + ".output is not of floats" + (place ? "" : " or normalized integers"));
  }
  const Sampler& read = sampler_.at(channel.sampler);
  const std::size_t values = read.time.size() * (read.way == Way::cubic ? 3 : 1) * channel.width;
  if (read.value.size() != values) {
    gltf.bad(where + ".output has " + std::to_string(output.count) + " elements; its " +
             std::to_string(read.time.size()) + " times need " + std::to_string(values / components));
  }
}

void GltfAnimation::apply(double time, std::vector<NodePose>& pose) const {
  std::vector<double> value;
  for (const Channel& channel : channel_) {
    NodePose& node = pose[channel.node];
    if (channel.path == Path::weights && node.weight.size() != channel.width) continue;  // is not shown
    sample(sampler_.at(channel.sampler), channel, time, value);
    switch (channel.path) {
      case Path::translation:
        node.place.translation = first_three(value);
        break;
      case Path::rotation:
        node.place.rotation = Eigen::Quaterniond(value[3], value[0], value[1], value[2]).normalized();
        break;
      case Path::scale:
        node.place.scale = first_three(value);
        break;
      case Path::weights:
        node.weight = value;
        break;
    }
  }
}

void GltfAnimation::sample(const Sampler& sampler, const Channel& channel, double time, std::vector<double>& out) {
  const std::size_t width = channel.width;
  const Between at = find_keys(sampler.time, time);
  const double t = at.share;
  out.resize(width);
  if (sampler.way == Way::cubic) {
    // Of a key: the slope towards it, its value, the slope away from it.
    const float *left = sampler.value.data() + 3 * width * at.left,
                *right = sampler.value.data() + 3 * width * at.right;
    const double end = t * t * (3 - 2 * t), away = at.length * t * (1 - t) * (1 - t), to = at.length * t * t * (t - 1);
    for (std::size_t k = 0; k < width; ++k) {
      out[k] = (1 - end) * double{left[width + k]} + end * double{right[width + k]};
      if (at.left != at.right) out[k] += away * double{left[2 * width + k]} + to * double{right[k]};
    }
    return;
  }
  const float *left = sampler.value.data() + width * at.left, *right = sampler.value.data() + width * at.right;
  if (sampler.way == Way::linear && channel.path == Path::rotation) {
    const Eigen::Quaterniond turn = turn_of(left).slerp(t, turn_of(right));
    out = {turn.x(), turn.y(), turn.z(), turn.w()};
    return;
  }
  const double share = sampler.way == Way::step ? 0 : t;
  for (std::size_t k = 0; k < width; ++k) out[k] = (1 - share) * double{left[k]} + share * double{right[k]};
}

}  // namespace geocloth::import_detail
