#pragma once
/// A unit cube as glTF, built here byte by byte.

#include <cstdint>
#include <string>

namespace tactum::testing {

/// 8 corners as floats, then 36 indices of two bytes.
inline std::string cube_buffer() {
  std::string bytes;
  const auto put = [&bytes](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  for (int i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const float x = static_cast<float>(i >> axis & 1);
      put(&x, sizeof x);
    }
  }
  constexpr std::uint16_t kIndices[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                          2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  put(kIndices, sizeof kIndices);
  return bytes;
}

inline std::string cube_document(const std::string& node, const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" +
         (node.empty() ? "" : "," + node) +
         R"(}],"meshes":[{"name":"cube","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],)"
         R"("materials":[{"name":"red"}],"accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3",)"
         R"("min":[0,0,0],"max":[1,1,1]},{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],)"
         R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],)"
         R"("buffers":[{"byteLength":168)" +
         (uri.empty() ? "" : ",\"uri\":\"" + uri + "\"") + "}]}";
}

inline std::string gltf_cube(const std::string& node = "") {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string bytes = cube_buffer();  // its length is a multiple of three
  std::string code = "data:application/octet-stream;base64,";
  for (std::size_t i = 0; i + 2 < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k]));
    };
    const std::uint32_t bits = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (int shift = 18; shift >= 0; shift -= 6) code += kDigits[bits >> shift & 63];
  }
  return cube_document(node, code);
}

inline std::string glb_cube(const std::string& node = "") {
  std::string text = cube_document(node, "");
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::string bin = cube_buffer();
  std::string bytes = "glTF";
  const auto put = [&bytes](std::size_t value) {
    const std::uint32_t word = static_cast<std::uint32_t>(value);
    bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
  };
  put(2);
  put(28 + text.size() + bin.size());
  put(text.size());
  bytes += "JSON" + text;
  put(bin.size());
  bytes.append("BIN\0", 4);
  return bytes + bin;
}

}  // namespace tactum::testing
