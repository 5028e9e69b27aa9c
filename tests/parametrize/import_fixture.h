// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of the importer share: files in a folder of their own, read, refused or damaged; glTF files put together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/import.h"
#include "support/temporary_folder.h"

namespace geocloth::test {

class ImportTest : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    return folder_.write(name, bytes);
  }

  TriangleMesh read(const std::string& name, const std::string& bytes, const ImportOptions& options = {}) const {
    return import_mesh(write(name, bytes), options);
  }

  /// The message and code with which a file is refused.
  Error refusal(const std::string& name, const std::string& bytes) const {
    try {
      static_cast<void>(read(name, bytes));
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), ::testing::HasSubstr(name));
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      return e;
    }
    ADD_FAILURE() << name << " was read";
    return {ErrorCode::io, ""};
  }

  /// Beginnings of the file are refused (every one of a short file, every third of a long one); a text may lose what
  /// comes after its last word.
  void expect_truncations_refused(const std::string& name, const std::string& bytes, std::size_t spare = 0) const {
    for (std::size_t n = 0; n + spare<bytes.size(); n += bytes.size()> 300 ? 3U : 1U) {
      try {
        static_cast<void>(read(name, bytes.substr(0, n)));
        ADD_FAILURE() << name << " was read from its first " << n << " of " << bytes.size() << " bytes";
        return;
      } catch (const Error&) {
      }
    }
  }

  /// Files with random damage end in a mesh or in an Error, never in a crash.
  void survive_damage(const std::string& name, const std::string& bytes, unsigned rounds) const {
    for (unsigned seed = 0; seed < rounds; ++seed) {
      std::mt19937 random(seed);
      std::string damaged = bytes;
      for (unsigned k = 0; k <= seed % 4; ++k) {
        damaged[random() % damaged.size()] = static_cast<char>(random());
      }
      try {
        const TriangleMesh mesh = read(name, damaged);
        for (const Triangle& t : mesh.triangle) {
          for (const uint32_t v : t) ASSERT_LT(v, mesh.position.size());
        }
      } catch (const Error&) {
      }
    }
  }

  const TemporaryFolder folder_;
};

/// The text with the first `what` in it replaced, which must be there.
inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

template <typename T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// A glTF file whose data lie in one binary chunk.
struct Gltf {
  nlohmann::json json;
  nlohmann::json more_buffers = nlohmann::json::array();  ///< after the binary chunk
  std::string binary;

  std::size_t add_view(const std::string& bytes) {
    while (binary.size() % 4 != 0) binary.push_back('\0');
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
    binary += bytes;
    return json["bufferViews"].size() - 1;
  }
  template <typename T>
  std::size_t add_accessor(const std::vector<T>& values, int component, const std::string& type, std::size_t per) {
    std::string bytes;
    for (const T v : values) put(bytes, v);
    json["accessors"].push_back({{"bufferView", add_view(bytes)},
                                 {"componentType", component},
                                 {"count", values.size() / per},
                                 {"type", type}});
    return json["accessors"].size() - 1;
  }
  std::string glb() const {
    nlohmann::json out = json;
    out["buffers"] = nlohmann::json::array({{{"byteLength", binary.size()}}});
    for (const nlohmann::json& buffer : more_buffers) out["buffers"].push_back(buffer);
    std::string text = out.dump(), data = binary, file = "glTF";
    while (text.size() % 4 != 0) text.push_back(' ');
    while (data.size() % 4 != 0) data.push_back('\0');
    put(file, uint32_t{2});
    put(file, static_cast<uint32_t>(12 + 8 + text.size() + 8 + data.size()));
    put(file, static_cast<uint32_t>(text.size()));
    file += "JSON" + text;
    put(file, static_cast<uint32_t>(data.size()));
    file += std::string("BIN\0", 4) + data;
    return file;
  }
};

/// A strip of two squares along +y from 0 to 2, its lower end bound to joint 0 and its upper to joint 1, the middle row
/// to both by halves. Nodes: 0 the mesh; 1 the hip at the origin and, a child of it, 2 the knee at (0, 1, 0).
inline Gltf skinned_strip() {
  Gltf g;
  g.json = nlohmann::json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
    "bufferViews": [], "accessors": [],
    "nodes": [{"mesh": 0, "skin": 0, "name": "strip"}, {"name": "hip", "children": [2]},
              {"name": "knee", "translation": [0, 1, 0]}]})");
  const auto position = g.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0}, 5126, "VEC3", 3);
  const auto normal = g.add_accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 5126, "VEC3", 3);
  const auto joint = g.add_accessor<uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
                                             5121, "VEC4", 4);
  const auto weight = g.add_accessor<float>(
      {1, 0, 0, 0, 1, 0, 0, 0, .5F, .5F, 0, 0, .5F, .5F, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5126, "VEC4", 4);
  const auto indices = g.add_accessor<uint16_t>({0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4}, 5123, "SCALAR", 1);
  g.json["meshes"] = {
      {{"primitives",
        {{{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"JOINTS_0", joint}, {"WEIGHTS_0", weight}}},
          {"indices", indices}}}}}};
  const auto bind = g.add_accessor<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,   //
                                           1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},  //
                                          5126, "MAT4", 16);
  g.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", bind}}};
  return g;
}

}  // namespace geocloth::test
