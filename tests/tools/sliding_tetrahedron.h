// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace geocloth::test {

/// A glTF file of a tetrahedron with the corners (0, 0, 0), (1, 0, 0), (0, 1, 0) and (0, 0, 1), which its animation
/// "slide" takes to z = 0.5 m in a second.
inline constexpr const char* kSlidingTetrahedron =
    R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"name":"tetrahedron","primitives":[{"attributes":{"POSITION":0},"indices":3}]}],"accessors":[
      {"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
      {"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},
      {"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"},
      {"bufferView":3,"componentType":5121,"count":12,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":8},
      {"buffer":0,"byteOffset":56,"byteLength":24},{"buffer":0,"byteOffset":80,"byteLength":12}],
    "animations":[{"name":"slide","samplers":[{"input":1,"output":2}],
      "channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]}],
    "buffers":[{"byteLength":92,"uri":"data:application/octet-stream;base64,)"
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAgD8AAAAAAAAAAAAAAAAA"
    R"(AAAAAAAAAAAAAD8AAgEAAQMAAwIBAgM="}]})";

}  // namespace geocloth::test
