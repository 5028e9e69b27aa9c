// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/assimp_animation.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace geocloth::import_detail {
namespace {

constexpr double kTicksWhereNoneAreSaid = 25;  ///< a second, as assimp's own viewer takes it

/// "animation 2 'Walk'"
std::string clip_title(const std::string& name, std::size_t number) {
  return "animation " + std::to_string(number) + (name.empty() ? "" : " '" + name.substr(0, kShownName) + "'");
}

class TrackReader {
 public:
  TrackReader(const std::filesystem::path& path, std::string title, const NodesByName& nodes,
              std::span<const std::size_t> targets)
      : path_(path), nodes_(nodes), targets_(targets), out_(std::move(title)) {}

  /// @param from  what plays at the same time
  NodeAnimation read(std::span<aiAnimation* const> from) {
    double duration = 0;
    for (const aiAnimation* one : from) {
      if (one->mDuration < 0) bad(path_, out_.title() + " does not say how long it is; export it again");
      ticks_ = one->mTicksPerSecond;
      if (!(ticks_ > 0 && std::isfinite(ticks_))) ticks_ = kTicksWhereNoneAreSaid;
      for (unsigned i = 0; i < one->mNumChannels; ++i) read_place(*one->mChannels[i]);
      for (unsigned i = 0; i < one->mNumMorphMeshChannels; ++i) read_morph(*one->mMorphMeshChannels[i]);
      duration = std::max(duration, one->mDuration / ticks_);
    }
    if (out_.empty()) bad(path_, out_.title() + " moves no node, skin or morph target");
    if (duration > 0 && std::isfinite(duration)) out_.set_duration(duration);
    return std::move(out_);
  }

 private:
  using Path = NodeAnimation::Path;
  using Sampler = NodeAnimation::Sampler;

  [[nodiscard]] const std::size_t* node_called(std::string_view name) const {
    const auto it = nodes_.find(name);
    return it == nodes_.end() ? nullptr : &it->second;
  }

  void read_place(const aiNodeAnim& channel) {
    const std::size_t* node = node_called(channel.mNodeName.C_Str());
    if (node == nullptr) return;
    const auto vector = [](const aiVectorKey& key, std::vector<float>& to) {
      to.insert(to.end(), {key.mValue.x, key.mValue.y, key.mValue.z});
    };
    const auto turn = [](const aiQuatKey& key, std::vector<float>& to) {
      to.insert(to.end(), {key.mValue.x, key.mValue.y, key.mValue.z, key.mValue.w});
    };
    add(*node, Path::translation, 3, std::span(channel.mPositionKeys, channel.mNumPositionKeys), vector);
    add(*node, Path::rotation, 4, std::span(channel.mRotationKeys, channel.mNumRotationKeys), turn);
    add(*node, Path::scale, 3, std::span(channel.mScalingKeys, channel.mNumScalingKeys), vector);
  }

  template <typename Key, typename Put>
  void add(std::size_t node, Path path, std::size_t width, std::span<Key> keys, Put&& put) {
    if (keys.empty()) return;
    Sampler sampler;
    for (const Key& key : keys) {
      sampler.time.push_back(seconds(key.mTime, sampler));
      put(key, sampler.value);
    }
    out_.add_channel({node, out_.add_sampler(std::move(sampler)), path, width});
  }

  /// Of a key that comes after those of a sampler.
  [[nodiscard]] float seconds(double ticks, const Sampler& sampler) const {
    const auto time = static_cast<float>(ticks / ticks_);
    if (!std::isfinite(time)) bad(path_, out_.title() + " has a key at no finite time");
    if (!sampler.time.empty() && time < sampler.time.back()) bad(path_, out_.title() + " has keys out of order");
    return time;
  }

  /// assimp calls what moves the blend shapes of a model "model*number", and a key holds some of them.
  void read_morph(const aiMeshMorphAnim& channel) {
    const std::string_view name = channel.mName.C_Str();
    const std::size_t* node = node_called(name.substr(0, name.rfind('*')));
    if (node == nullptr || targets_[*node] == 0) return;
    const std::size_t width = targets_[*node];
    std::vector<Sampler> one(width);
    std::set<float> times;
    for (const aiMeshMorphKey& key : std::span(channel.mKeys, channel.mNumKeys)) {
      for (unsigned k = 0; k < key.mNumValuesAndWeights; ++k) {
        if (key.mValues[k] >= width) continue;
        Sampler& sampler = one[key.mValues[k]];
        sampler.time.push_back(seconds(key.mTime, sampler));
        sampler.value.push_back(static_cast<float>(key.mWeights[k]));
        times.insert(sampler.time.back());
      }
    }
    if (times.empty()) return;
    if (times.size() > kMaxElements / width) fail(path_, ErrorCode::limit, out_.title() + " has too many keys");
    Sampler all;
    all.time.assign(times.begin(), times.end());
    const NodeAnimation::Channel single{*node, 0, Path::weights, 1};
    std::vector<double> weight{0};
    for (const float time : all.time) {
      for (const Sampler& sampler : one) {
        weight[0] = 0;
        if (!sampler.time.empty()) NodeAnimation::sample(sampler, single, double{time}, weight);
        all.value.push_back(static_cast<float>(weight[0]));
      }
    }
    out_.add_channel({*node, out_.add_sampler(std::move(all)), Path::weights, width});
  }

  const std::filesystem::path& path_;
  const NodesByName& nodes_;
  std::span<const std::size_t> targets_;
  NodeAnimation out_;
  double ticks_ = 1;  ///< a second, of what is being read
};

}  // namespace

std::size_t count_clips(const AssimpFile& file) {
  return file.format == Format::dae ? std::min(file.scene->mNumAnimations, 1U) : file.scene->mNumAnimations;
}

NodeAnimation read_assimp_animation(const std::filesystem::path& path, const AssimpFile& file, const std::string& clip,
                                    const NodesByName& nodes, std::span<const std::size_t> targets) {
  std::span<aiAnimation* const> clips(file.scene->mAnimations, file.scene->mNumAnimations);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count_clips(file); ++i) names.emplace_back(clips[i]->mName.C_Str());
  const std::vector<std::size_t> numbers = find_clips(path, names, clip);
  const bool all = numbers.size() > 1;
  if (file.format != Format::dae && !all) clips = clips.subspan(numbers[0], 1);
  const std::string title = all ? std::string(kAllClips) : clip_title(names[numbers[0]], numbers[0]);
  return TrackReader(path, title, nodes, targets).read(clips);
}

}  // namespace geocloth::import_detail
