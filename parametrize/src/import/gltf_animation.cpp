// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/gltf_animation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

using Json = GltfFile::Json;
using Path = NodeAnimation::Path;
using Way = NodeAnimation::Way;
using Sampler = NodeAnimation::Sampler;
using Channel = NodeAnimation::Channel;

std::vector<std::string> animation_names(const Json& animations) {
  std::vector<std::string> out;
  for (const Json& animation : animations) {
    const auto name = animation.find("name");
    out.push_back(name == animation.end() ? std::string() : name->get<std::string>());
  }
  return out;
}

/// "animations[2] 'Walk'"
std::string title_of(const std::string& name, std::size_t i) {
  return label("animations", i) + (name.empty() ? "" : " '" + name.substr(0, kShownName) + "'");
}

bool is_unit_integer(const GltfAccessor& a) {
  return a.normalized && (a.component_size == 1 || a.component_size == 2);
}

class AnimationReader {
 public:
  /// @param numbers  read so far, and those of one pose; of all that play at once
  AnimationReader(const GltfFile& gltf, const GltfData& data, std::size_t number, std::string title,
                  const std::vector<std::size_t>& targets, std::size_t& numbers)
      : gltf_(gltf),
        data_(data),
        json_(gltf.array("animations")[number]),
        targets_(targets),
        animation_(std::move(title)),
        numbers_(numbers) {}

  NodeAnimation read() {
    for (std::size_t i = 0; i < json_["channels"].size(); ++i) read_channel(i);
    return std::move(animation_);
  }

 private:
  void read_channel(std::size_t i) {
    const std::string where = animation_.title() + "." + label("channels", i);
    const Json& json = json_["channels"][i];
    const Json& target = json["target"];
    // What has no node to move is for extensions (glTF 2.0, section 3.11).
    if (!target.contains("node")) return;
    const std::optional<Path> path = read_path(target, where);
    if (!path) return;
    Channel channel{target["node"].get<std::size_t>(), 0, *path, 3};
    if (channel.path == Path::rotation) channel.width = 4;
    if (channel.path == Path::weights) {
      const auto mesh = gltf_.reference(gltf_.array("nodes")[channel.node], "mesh", "meshes", where);
      channel.width = mesh ? targets_[*mesh] : 0;
      if (channel.width == 0) gltf_.bad(where + " moves morph targets of a node that has none");
    }
    const auto number = json["sampler"].get<std::size_t>();
    const std::string from = animation_.title() + "." + label("samplers", number);
    const Json& sampler = json_["samplers"][number];
    if (!sampler_.contains(number)) sampler_.emplace(number, animation_.add_sampler(read_sampler(sampler, from)));
    channel.sampler = sampler_.at(number);
    check_values(sampler, channel, from);
    count_numbers(channel.width);
    animation_.add_channel(channel);
  }

  /// Nothing for what an extension moves.
  [[nodiscard]] std::optional<Path> read_path(const Json& target, const std::string& where) const {
    const auto path = target.find("path");
    if (path == target.end() || !path->is_string()) gltf_.bad(where + ".target.path is missing");
    constexpr std::pair<std::string_view, Path> kPaths[] = {{"translation", Path::translation},
                                                            {"rotation", Path::rotation},
                                                            {"scale", Path::scale},
                                                            {"weights", Path::weights}};
    for (const auto& [name, meaning] : kPaths) {
      if (*path == name) return meaning;
    }
    if (*path == "pointer") return std::nullopt;
    gltf_.bad(where + ".target.path is '" + path->get<std::string>().substr(0, kShownName) +
              "'; it must be translation, rotation, scale or weights");
  }

  Sampler read_sampler(const Json& sampler, const std::string& where) {
    Sampler out;
    if (const auto way = sampler.find("interpolation"); way != sampler.end()) {
      if (*way == "STEP") {
        out.way = Way::step;
      } else if (*way == "CUBICSPLINE") {
        out.way = Way::cubic;
      } else if (*way != "LINEAR") {
        gltf_.bad(where + ".interpolation is not LINEAR, STEP or CUBICSPLINE");
      }
    }
    const GltfAccessor &input = data_.attribute(sampler, "input", where),
                       &output = data_.attribute(sampler, "output", where);
    if (input.components != 1 || input.component_type != 5126) gltf_.bad(where + ".input is not of single floats");
    count_numbers(input.count + output.count * output.components);
    out.time = data_.floats(sampler["input"].get<std::size_t>());
    out.value = data_.floats(sampler["output"].get<std::size_t>());
    check_keys(out, where);
    return out;
  }

  void count_numbers(std::size_t more) {
    numbers_ += more;
    if (numbers_ > kMaxElements) {
      fail(gltf_.path, ErrorCode::limit, animation_.title() + " has more than 100 million numbers");
    }
  }

  void check_keys(const Sampler& sampler, const std::string& where) const {
    if (sampler.time.empty()) gltf_.bad(where + ".input has no times");
    for (std::size_t i = 0; i < sampler.time.size(); ++i) {
      if (!std::isfinite(sampler.time[i])) {
        gltf_.bad(where + ".input: time " + std::to_string(i) + " is not a finite number");
      }
      if (i > 0 && sampler.time[i] < sampler.time[i - 1]) {
        gltf_.bad(where + ".input: time " + std::to_string(i) + " is before the one ahead of it");
      }
    }
  }

  /// That a sampler fits what a channel moves with it.
  void check_values(const Json& sampler, const Channel& channel, const std::string& where) const {
    const GltfAccessor& output = data_.attribute(sampler, "output", where);
    const bool place = channel.path == Path::translation || channel.path == Path::scale;
    const std::size_t components = channel.path == Path::weights ? 1 : channel.width;
    if (output.components != components) {
      gltf_.bad(where + ".output has " + std::to_string(output.components) + " components; its channel needs " +
                std::to_string(components));
    }
    if (output.component_type != 5126 && (place || !is_unit_integer(output))) {
      gltf_.bad(where + ".output is not of floats" + (place ? "" : " or normalized integers"));
    }
    const Sampler& read = animation_.sampler(channel.sampler);
    const std::size_t values = read.time.size() * (read.way == Way::cubic ? 3 : 1) * channel.width;
    if (read.value.size() != values) {
      gltf_.bad(where + ".output has " + std::to_string(output.count) + " elements; its " +
                std::to_string(read.time.size()) + " times need " + std::to_string(values / components));
    }
  }

  const GltfFile& gltf_;
  const GltfData& data_;
  const Json& json_;
  const std::vector<std::size_t>& targets_;
  NodeAnimation animation_;
  std::map<std::size_t, std::size_t> sampler_;  ///< of the file that were read: their numbers in animation_
  std::size_t& numbers_;
};

}  // namespace

NodeAnimation read_gltf_animation(const GltfFile& gltf, const GltfData& data, const std::string& clip,
                                  const std::vector<std::size_t>& targets) {
  const std::vector<std::string> names = animation_names(gltf.array("animations"));
  const std::vector<std::size_t> clips = find_clips(gltf.path, names, clip);
  NodeAnimation out(clips.size() == 1 ? title_of(names[clips[0]], clips[0]) : std::string(kAllClips));
  std::size_t numbers = 0;
  for (const std::size_t i : clips) {
    out.add(AnimationReader(gltf, data, i, title_of(names[i], i), targets, numbers).read());
  }
  if (out.empty()) gltf.bad(out.title() + " moves no node, skin or morph target");
  return out;
}

}  // namespace geocloth::import_detail
