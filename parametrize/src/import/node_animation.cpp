// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/node_animation.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numeric>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

constexpr std::size_t kListedNames = 40;

std::string list_names(std::span<const std::string> names) {
  std::string out;
  for (std::size_t i = 0; i < std::min(names.size(), kListedNames); ++i) {
    const std::string name = names[i].substr(0, kShownName);
    out += (i > 0 ? ", " : "") + std::to_string(i) + (name.empty() ? "" : " '" + name + "'");
  }
  const std::size_t more = names.size() - std::min(names.size(), kListedNames);
  return more > 0 ? out + " and " + std::to_string(more) + " more" : out;
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

}  // namespace

Eigen::Matrix4d NodePlace::matrix() const {
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  out.translate(translation);
  out.rotate(rotation.normalized());
  out.scale(scale);
  return out.matrix();
}

NodePlace node_place(const Eigen::Matrix4d& matrix) {
  NodePlace out;
  Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>();
  out.translation = matrix.topRightCorner<3, 1>();
  out.scale = turn.colwise().norm();
  if (turn.determinant() < 0) out.scale[0] = -out.scale[0];
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (out.scale[k] != 0) turn.col(k) /= out.scale[k];
  }
  out.rotation = Eigen::Quaterniond(turn).normalized();
  return out;
}

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

std::vector<std::size_t> find_clips(const std::filesystem::path& file, std::span<const std::string> names,
                                    const std::string& clip) {
  if (names.empty()) bad(file, "has no animation; export it with one, or use it as a mesh that stands still");
  const auto place_of = [&](auto found) { return static_cast<std::size_t>(found - names.begin()); };
  if (clip.empty()) return {0};
  const auto named = std::find(names.begin(), names.end(), clip);
  if (named != names.end()) return {place_of(named)};
  if (clip == "*") {
    std::vector<std::size_t> all(names.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }
  const auto is_action = [&](const std::string& name) { return name.ends_with("|" + clip); };
  const auto action = std::find_if(names.begin(), names.end(), is_action);
  if (action != names.end()) return {place_of(action)};
  std::size_t number = 0;
  const char* const end = clip.data() + clip.size();
  const auto [at, error] = std::from_chars(clip.data(), end, number);
  if (error == std::errc() && at == end && number < names.size()) return {number};
  bad(file, "has no animation '" + clip.substr(0, kShownName) + "'; it has " + list_names(names));
}

std::size_t NodeAnimation::add_sampler(Sampler sampler) {
  duration_ = std::max(duration_, double{sampler.time.back()});
  sampler_.push_back(std::move(sampler));
  return sampler_.size() - 1;
}

void NodeAnimation::add_channel(const Channel& channel) {
  if (channel.path != Path::weights) moved_.insert(channel.node);
  channel_.push_back(channel);
}

void NodeAnimation::add(NodeAnimation other) {
  const std::size_t first = sampler_.size();
  std::ranges::move(other.sampler_, std::back_inserter(sampler_));
  for (Channel channel : other.channel_) {
    channel.sampler += first;
    add_channel(channel);
  }
  duration_ = std::max(duration_, other.duration_);
}

void NodeAnimation::apply(double time, std::vector<NodePose>& pose) const {
  std::vector<double> value;
  for (const Channel& channel : channel_) {
    NodePose& node = pose[channel.node];
    if (channel.path == Path::weights && node.weight.size() != channel.width) continue;  // is not shown
    sample(sampler_[channel.sampler], channel, time, value);
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

void NodeAnimation::sample(const Sampler& sampler, const Channel& channel, double time, std::vector<double>& out) {
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
